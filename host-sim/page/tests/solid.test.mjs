// The wall in 3D, drawn by a real WebGL: colours, relief, touches and cutter are where arc length, height and the view put them;
// turned by hand and keys; a map where there is no WebGL.
import assert from "node:assert/strict";
import { test } from "node:test";
import { launch, open, PHONE, pictures, plate, report, show, write } from "./browser.mjs";
import { faults, settled, violations } from "./checks.mjs";
import { leaning } from "./leaning.mjs";

/** What the reader of a test's pixels and the copying of a picture without a graphics processor let the browser say. */
const unasked = (text) => !/willReadFrequently|GPU stall due to ReadPixels/.test(text);
const inSpace = async (page) => {
  await page.click('label[for="wall-3D"]');
  await settled(page);
};

/** From where it is seen, degrees; pixels per millimetre; where the middle of the wall is, pixels. */
async function view(page) {
  const [azimuth, elevation, scale, x, y] = (await page.getAttribute(".unrolled", "data-view")).split(" ").map(Number);
  return { azimuth, elevation, scale, x, y };
}

/** The pixel of a place of the leaning wall: along X from its middle, Y from the wall towards the cutter, Z from half of its height. */
async function pixel(page, [px, py, pz]) {
  const { azimuth, elevation, scale, x, y } = await view(page);
  const [a, h] = [azimuth, elevation].map((degrees) => (degrees * Math.PI) / 180);
  const right = -Math.sin(a) * px + Math.cos(a) * py;
  const up = -Math.sin(h) * (Math.cos(a) * px + Math.sin(a) * py) + Math.cos(h) * pz;
  return [x + scale * right, y - scale * up];
}

/** The colour there. */
async function colour(page, place) {
  const at = await pixel(page, place);
  return page.locator(".unrolled canvas").evaluate((canvas, [x, y]) => [...canvas.getContext("2d").getImageData(Math.floor(x), Math.floor(y), 1, 1).data].slice(0, 3), at);
}

/** Whether a colour is that of the legend in light or shade: a seventh darker at most, in all channels alike. */
function shaded(found, legend) {
  const sum = (of) => of.reduce((a, b) => a + b);
  const share = sum(found) / sum(legend);
  return share > 0.84 && share < 1.02 && near(found, legend.map((v) => v * share), 6);
}
const near = (a, b, slack = 6) => a.every((v, k) => Math.abs(v - b[k]) <= slack);
const WHITE = [255, 255, 255];

test("errors have the colours of the legend where arc length and height put them, as far from the wall as they are enlarged", async () => {
  const { page, complaints, close } = await open(await write("leaning", leaning()));
  await page.uncheck("#layer-cutter");
  await inSpace(page);
  assert.equal(await page.textContent("#unrolled h2"), "The wall in 3D");
  assert.equal(await page.inputValue("#wall-magnify"), await page.inputValue("#magnify"));
  await page.selectOption("#wall-magnify", "20");
  assert.equal(await page.inputValue("#magnify"), "20", "one factor for all pictures");
  await settled(page);
  // The cutter was on the side of +Y: from there it is seen.
  const { azimuth, elevation } = await view(page);
  assert.deepEqual([azimuth, elevation], [125, 38]);
  // The wall is drawn higher, as it is low: 10 mm of 100.
  const rise = 2;
  assert.match(await page.textContent(".unrolled-words"), /errors 20\s×, height 2\s×/);
  const onWall = (s, z) => [s - 50, 20 * (-0.04 + 0.01 * z), rise * (z - 5)];
  for (const s of [3, 30, 97]) {
    for (const [z, legend] of [[0.3, [141, 182, 223]], [4, WHITE], [9.7, [232, 144, 71]], [2, [196, 217, 239]], [7, [250, 200, 152]]]) {
      const found = await colour(page, onWall(s, z));
      assert.ok(shaded(found, legend), `s ${s}, z ${z}: ${found}, expected ${legend} or a little darker`);
    }
  }
  // Beyond the end of the wall there is none.
  assert.ok(near(await colour(page, onWall(104, 5)), WHITE, 0));
  // From above: the part begins where the enlarged error at the top ends, 1.2 mm before the wall as it should be.
  await page.focus(".unrolled");
  for (let k = 0; k < 3; k++) await page.keyboard.press("Shift+ArrowUp");
  for (let k = 0; k < 7; k++) await page.keyboard.press("ArrowLeft");
  await settled(page);
  assert.deepEqual([(await view(page)).azimuth, (await view(page)).elevation], [160, 90]);
  const part = await page.evaluate(() => { const c = document.createElement("canvas").getContext("2d"); c.fillStyle = getComputedStyle(document.documentElement).getPropertyValue("--part"); c.fillRect(0, 0, 1, 1); return [...c.getImageData(0, 0, 1, 1).data].slice(0, 3); });
  assert.ok(near(await colour(page, [10, 0.7, 10]), part, 1), "part within the error");
  assert.ok(!near(await colour(page, [10, 1.8, 10]), part, 8), "and none beyond it");
  await page.selectOption("#wall-magnify", "50");
  await settled(page);
  assert.ok(near(await colour(page, [10, 1.8, 10]), part, 1), "enlarged more it is there");
  assert.deepEqual(complaints.filter(unasked), []);
  await close();
});

test("a line stands at the tolerance, the slider goes from one pass to the other, and what is beyond the colours has their end", async () => {
  const { page, close } = await open(await write("leaning", leaning({ tolerance_mm: 0.02 })));
  await page.uncheck("#layer-cutter");
  await page.selectOption("#magnify", "1");
  await inSpace(page);
  const onWall = (s, z) => [s - 50, 0, 2 * (z - 5)];
  /** The darkest within a few pixels of a height. */
  const darkest = async (z) => Math.min(...(await Promise.all([-0.2, -0.1, 0, 0.1, 0.2].map((d) => colour(page, onWall(30, z + d))))).map(([r, g, b]) => r + g + b));
  assert.ok(await darkest(6) < 350, `${await darkest(6)} at the tolerance`);
  assert.ok(await darkest(5) > 500, "not beside it");
  await page.fill("#wipe", "50");
  await settled(page);
  assert.ok(shaded(await colour(page, onWall(30, 9)), [253, 237, 221]), "after on the first half");
  assert.ok(shaded(await colour(page, onWall(70, 9)), [235, 152, 80]), `before on the second: ${await colour(page, onWall(70, 9))}`);
  await page.fill("#wipe", "0");
  await page.selectOption("#colour-scale", "0.02");
  await settled(page);
  assert.ok(shaded(await colour(page, onWall(50, 8)), [166, 54, 3]), `${await colour(page, onWall(50, 8))}`);
  await close();
});

test("touches are on the wall in the colour of what was measured, and the cutter is at its place", async () => {
  const points = [{ line: 1, status: "used", s_mm: 40, x_mm: 40, y_mm: -3, z_mm: 5, nx: 0, ny: -1, error_mm: -0.1 }, { line: 2, status: "aside", reason: "far", s_mm: 60, x_mm: 60, y_mm: -3, z_mm: 5 }];
  const { page, close } = await open(await write("leaning", leaning({ points })));
  await page.selectOption("#magnify", "10");
  await inSpace(page);
  // Drawn by ten times its error behind the wall as it should be; a mark lies before the wall that would hide it.
  assert.ok(near(await colour(page, [-10, -1.0 - 0.1, 0]), [8, 69, 148], 8), `${await colour(page, [-10, -1.1, 0])}`);
  await page.uncheck("#layer-points");
  await settled(page);
  assert.ok(!near(await colour(page, [-10, -1.1, 0]), [8, 69, 148], 60), "hidden with its layer");
  await page.locator("#scrub").fill("110");
  await settled(page);
  const pixels = (name) => page.locator(".unrolled canvas").evaluate((canvas, as) => { globalThis[as] = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height); }, name);
  await pixels("drawn");
  await page.uncheck("#layer-cutter");
  await settled(page);
  await pixels("without");
  const box = await page.evaluate(() => {
    const { drawn, without } = globalThis;
    const found = [Infinity, -Infinity, Infinity, -Infinity];
    for (let k = 0; k < drawn.data.length; k += 4) {
      if (drawn.data[k] === without.data[k]) continue;
      const [x, y] = [(k / 4) % drawn.width, Math.floor(k / 4 / drawn.width)];
      [found[0], found[1], found[2], found[3]] = [Math.min(found[0], x), Math.max(found[1], x), Math.min(found[2], y), Math.max(found[3], y)];
    }
    return found;
  });
  // Sample 110 stands at 20 mm; the cutter has 6 mm and its middle 3 mm before the wall.
  const { scale } = await view(page);
  const [middle, tip] = await pixel(page, [-30, 3, -10]);
  assert.ok(Math.abs((box[0] + box[1]) / 2 - middle) < 2, `${box} about ${middle}`);
  assert.ok(Math.abs(box[1] - box[0] - 6 * scale) < 4, `${box[1] - box[0]} wide, expected ${6 * scale}`);
  const below = 3 * Math.sin((38 * Math.PI) / 180) * scale;
  assert.ok(Math.abs(box[3] - (tip + below)) < 3, `down to ${box[3]}, expected ${tip + below}`);
  await close();
});

test("mouse, wheel, keys and buttons turn it; a place is read and leads to the cutter; it rests when nobody turns it", async () => {
  const { page, complaints, close } = await open(await write("leaning", leaning({ tolerance_mm: 0.02 })));
  await page.selectOption("#magnify", "1");
  await inSpace(page);
  await page.locator(".unrolled").scrollIntoViewIfNeeded();
  const picture = () => page.locator(".unrolled canvas").evaluate((canvas) => canvas.toDataURL());
  const [first, drawn] = [await view(page), await picture()];
  const box = await page.locator(".unrolled").boundingBox();
  const told = () => page.textContent(".unrolled-told");
  const at = async (place) => { const [x, y] = await pixel(page, place); return [box.x + x, box.y + y]; };
  await page.mouse.move(...await at([20, 0, 6]));
  assert.match(await told(), /^s (69\.9|70\.0|70\.1) mm, (7\.9|8\.0|8\.1) mm above the tip: before \+0\.0(39|40|41) mm$/);
  await page.mouse.click(...await at([20, 0, 6]));
  assert.ok(Math.abs(Number(await page.inputValue("#scrub")) - 160) <= 1, "a click puts the cutter there");
  await page.fill("#scrub", "0");
  await page.mouse.move(box.x + 300, box.y + 100);
  await page.mouse.down();
  await page.mouse.move(box.x + 350, box.y + 80, { steps: 4 });
  await page.mouse.up();
  await settled(page);
  const dragged = await view(page);
  assert.deepEqual([dragged.azimuth, dragged.elevation].map(Math.round), [105, 30]);
  assert.equal(await page.inputValue("#scrub"), "0", "what is dragged is no click");
  // A wheel that passes by scrolls the page; with Ctrl it zooms to the pointer.
  await page.evaluate(() => document.activeElement.blur());
  const scrolled = () => page.evaluate(() => scrollY);
  const from = await scrolled();
  await page.mouse.wheel(0, -120);
  await page.waitForFunction((y) => scrollY < y, from);
  assert.equal((await view(page)).scale, dragged.scale);
  const here = await page.locator(".unrolled").boundingBox();
  await page.mouse.move(here.x + 300, here.y + 100);
  await page.keyboard.down("Control");
  await page.mouse.wheel(0, -200);
  await page.keyboard.up("Control");
  await settled(page);
  assert.ok((await view(page)).scale > 1.2 * dragged.scale);
  // Keys.
  await page.focus(".unrolled");
  await page.keyboard.press("0");
  await page.keyboard.press("ArrowLeft");
  await page.keyboard.press("Shift+ArrowDown");
  const turned = await view(page);
  assert.deepEqual([turned.azimuth, turned.elevation].map(Math.round), [110, 0]);
  assert.match(await page.getAttribute(".unrolled", "aria-label"), /^The wall in 3D, 100\.0 mm long, 10\.0 mm high\. before: .*Seen from \+Y, 0° above the floor; errors 1\s×, height 2\s×\.$/);
  for (const [key, to] of [["ArrowRight", 105], ["Shift+ArrowRight", 75], ["Shift+ArrowLeft", 105]]) {
    await page.keyboard.press(key);
    assert.equal(Math.round((await view(page)).azimuth), to, key);
  }
  await page.keyboard.press("+");
  assert.ok((await view(page)).scale > turned.scale);
  await page.keyboard.press(".");
  assert.equal(await page.inputValue("#scrub"), "1");
  for (let k = 0; k < 20; k++) await page.keyboard.press("PageDown");
  await page.keyboard.press("PageUp");
  assert.equal(await told(), "s 0.1 mm, 0.5 mm above the tip: before −0.035 mm");
  // The buttons, for who neither drags nor has keys; the same view is the same picture.
  await page.fill("#scrub", "160");
  await page.click(".unrolled-turns >> text=cutter");
  await settled(page);
  const [x, y] = await pixel(page, [20, 0, 2 * (0.5 - 5)]);
  assert.ok(Math.abs(x - box.width / 2) < 3 && Math.abs(y - box.height / 2) < 3, `${x}, ${y} is in the middle`);
  await page.fill("#scrub", "0");
  await page.click(".unrolled-turns >> text=whole");
  for (const [name, times] of [["Look from higher up", 4], ["Turn the wall to the left", 1]]) for (let k = 0; k < times; k++) await page.click(`[aria-label="${name}"]`);
  const back = await view(page);
  assert.deepEqual([back.azimuth, back.elevation].map(Math.round), [125, 40]);
  for (const key of ["ArrowUp", "ArrowDown"]) await page.keyboard.press(key);
  await page.evaluate(() => { globalThis.calls = 0; const { prototype } = WebGL2RenderingContext; const { clear } = prototype; prototype.clear = function counted(...all) { globalThis.calls++; clear.apply(this, all); }; });
  await page.waitForTimeout(300);
  assert.equal(await page.evaluate(() => globalThis.calls), 0, "nothing is drawn while nothing changes");
  await page.reload();
  await page.waitForFunction(() => document.documentElement.dataset.firstPicture !== undefined);
  await page.selectOption("#magnify", "1");
  await inSpace(page);
  assert.deepEqual(await view(page), first);
  assert.equal(await picture(), drawn, "the same to the last pixel");
  assert.deepEqual(await violations(page), []);
  assert.deepEqual(complaints.filter(unasked), []);
  await close();
});

test("without WebGL the map stays and says why; when it is taken away the map comes back", async () => {
  const file = await write("leaning", leaning());
  const other = await launch({ webgl: false });
  try {
    const page = await other.newPage();
    await show(page, file);
    const map = () => page.locator(".unrolled canvas").evaluate((canvas) => canvas.toDataURL());
    const before = await map();
    await page.click('label[for="wall-3D"]');
    assert.equal(await page.textContent(".unrolled-problem"), "This browser cannot draw in 3D (it has no WebGL); the map shows the same errors.");
    assert.ok(await page.isChecked("#wall-map"));
    assert.equal(await map(), before);
    assert.ok(await page.locator(".unrolled-turns").isHidden());
    assert.deepEqual(await violations(page), []);
  } finally {
    await other.close();
  }
  const { page, close } = await open(file);
  await page.evaluate(() => {
    const { getContext } = HTMLCanvasElement.prototype;
    HTMLCanvasElement.prototype.getContext = function kept(kind, ...rest) {
      const context = getContext.call(this, kind, ...rest);
      if (kind === "webgl2") globalThis.space = context;
      return context;
    };
  });
  await inSpace(page);
  await page.evaluate(() => globalThis.space.getExtension("WEBGL_lose_context").loseContext());
  await page.waitForFunction(() => document.querySelector("#wall-map").checked);
  assert.equal(await page.textContent(".unrolled-problem"), "The 3D view was taken away by the graphics of this computer; the map shows the same errors.");
  assert.equal(await page.textContent("#unrolled h2"), "The wall unrolled");
  await inSpace(page);
  assert.ok(await page.isChecked("#wall-3D"), "chosen again it is tried again");
  assert.equal(await page.textContent(".unrolled-problem"), "");
  await close();
});

test("on phone and paper, in light and dark, it is whole; the choice holds for the next contour", async () => {
  for (const options of [PHONE, { colorScheme: "dark" }]) {
    const { page, close } = await open(await report("demo/pocket"), options);
    await page.fill("#scrub", "560");
    await inSpace(page);
    assert.deepEqual(await faults(page), []);
    assert.deepEqual(await violations(page), []);
    await page.locator("#unrolled").screenshot({ path: `${pictures}pocket-3d-${options === PHONE ? "phone" : "dark"}.png` });
    if (options === PHONE) { await close(); continue; }
    const ground = (x, y) => page.locator(".unrolled canvas").evaluate((canvas, at) => [...canvas.getContext("2d").getImageData(...at, 1, 1).data].slice(0, 3), [x, y]);
    assert.ok(Math.max(...await ground(4, 4)) < 60, "dark ground");
    await page.evaluate(() => window.dispatchEvent(new Event("beforeprint")));
    const paper = await page.locator(".unrolled canvas").evaluate((canvas) => {
      const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      let orange = 0;
      for (let k = 0; k < data.length; k += 4) if (data[k] > data[k + 2] + 60) orange++;
      return { sharp: canvas.width / canvas.clientWidth, orange: orange / (data.length / 4), right: canvas.getBoundingClientRect().right - document.body.getBoundingClientRect().right };
    });
    assert.ok(paper.sharp > 2.5 && paper.orange > 0.03 && paper.right <= 1, JSON.stringify(paper));
    assert.deepEqual(await ground(4, 4), WHITE, "light on paper");
    await page.evaluate(() => window.dispatchEvent(new Event("afterprint")));
    assert.ok(Math.max(...await ground(4, 4)) < 60, "and dark again");
    await close();
  }
  const { page, close } = await open(await write("several-correct", await plate("correct")));
  await inSpace(page);
  const [, second] = await page.locator(".list tbody a").all();
  await second.click();
  await settled(page);
  assert.equal(await page.textContent("#unrolled h2"), "The wall in 3D");
  await close();
});
