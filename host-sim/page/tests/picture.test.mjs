// The pictures look as they did: compared with tests/reference. TRUEPATH_BLESS=1 renews them and those of the README.
//
// The page brings its font along, and the browser draws it the same whatever the system has (browser.mjs); another version of
// the browser may still draw letters a little differently, so that no pixel is compared with the references. Both pictures are made small, to cells
// of some 15 × 14 pixels, each the mean of what lay there. Another rendering of the same letters changes a cell of text by
// some hundredths and a line by less; a layer missing, another colour, a control or a curve elsewhere changes many cells by a tenth
// and more. So cells are counted that differ by more than APART, and may be a few. The last test holds both ends: what has to be
// noticed is, what has not is not. References are kept at half the size.
import assert from "node:assert/strict";
import { mkdir, readFile, writeFile } from "node:fs/promises";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { browser, launch, open, PHONE, pictures, plate, report, show, write } from "./browser.mjs";

const reference = fileURLToPath(new URL("reference/", import.meta.url));
const readme = fileURLToPath(new URL("../../../docs/pictures/", import.meta.url));
/** Difference of a channel, 0…1, from which on a cell has changed. */
const APART = 0.09;
/**
 * The share of cells that may, of those of the drawn scenes and of all others: in the middle, by factors, between what another
 * rendering of letters changes and what a missing layer does; the last test holds the distance to both.
 */
const CELLS = { drawn: 0.003, other: 0.005 };
/** What is to be noticed changes so many times as many cells at least, what is not so much less. */
const NOTICED = 1.5;
const RENDERED = 1.4;
const GRID = [96, 64];
/** A picture in the README loads on a phone: bytes at most. */
const README = 200_000;
const SIZE = { viewport: { width: 1440, height: 900 } };
/** Page, name, browser, pass shown, place of the cutter, whether the README shows it. */
const VIEWS = [
  ["demo/corner", "light", SIZE, "before", 480, true], ["demo/corner", "side-by-side", SIZE, "both", 430],
  ["demo/pocket", "light", SIZE, "before", 560], ["demo/pocket", "both", SIZE, "both", 560, true], ["demo/pocket", "dark", { ...SIZE, colorScheme: "dark" }, "both", 560],
  ["demo/pocket", "phone", PHONE, "after", 560], ["island", "light", SIZE, null, 1500], ["inspect", "light", SIZE, null, null],
  ["several", "light", SIZE, null, null, true],
];

/** A page of the program, or those of the plate in one. */
const fileOf = async (name) => (name === "several" ? write("several", await plate("correct")) : report(name));

let made;

/** A blank page that reads and makes pictures. */
function easel() {
  made ??= newEasel();
  return made;
}

async function newEasel() {
  const page = await (await browser()).newPage();
  await page.goto("about:blank");
  await page.evaluate(() => {
    globalThis.read = async (source) => createImageBitmap(await (await fetch(`data:image/png;base64,${source}`)).blob());
    // Halved again and again: every pixel counts.
    globalThis.small = (image, wide, high) => {
      let from = image;
      for (let { width, height } = image; width > wide || height > high;) {
        [width, height] = [Math.max(wide, Math.ceil(width / 2)), Math.max(high, Math.ceil(height / 2))];
        const next = new OffscreenCanvas(width, height);
        next.getContext("2d").drawImage(from, 0, 0, width, height);
        from = next;
      }
      return from;
    };
  });
  return page;
}

/** The shares of cells that differ, 0…1, within the scenes and without; 1 where the pictures have other proportions. */
async function changed(page, one, other) {
  return page.evaluate(async ([sources, boxes, [wide, high], apart]) => {
    const images = await Promise.all(sources.map(globalThis.read));
    const ratios = images.map((image) => image.width / image.height);
    if (Math.abs(ratios[0] / ratios[1] - 1) > 0.01) return { drawn: 1, other: 1 };
    const [a, b] = images.map((image) => globalThis.small(image, wide, high).getContext("2d").getImageData(0, 0, wide, high).data);
    const of = { drawn: [0, 0], other: [0, 0] };
    for (let cell = 0; cell < wide * high; cell++) {
      const [x, y] = [(cell % wide + 0.5) / wide, (Math.floor(cell / wide) + 0.5) / high];
      const counts = boxes.some(([x0, y0, x1, y1]) => x > x0 && x < x1 && y > y0 && y < y1) ? of.drawn : of.other;
      counts[1]++;
      if ([0, 1, 2].some((k) => Math.abs(a[4 * cell + k] - b[4 * cell + k]) / 255 > apart)) counts[0]++;
    }
    return Object.fromEntries(Object.entries(of).map(([name, [found, all]]) => [name, all ? found / all : 0]));
  }, [[one.picture, other].map((picture) => picture.toString("base64")), one.scenes, GRID, APART]);
}

const percent = ({ drawn, other }) => `${(100 * drawn).toFixed(2)} % of the cells of the scenes, ${(100 * other).toFixed(2)} % of the others`;

/** The same picture at half the size. */
async function halved(page, picture) {
  const text = await page.evaluate(async (source) => {
    const image = await globalThis.read(source);
    const canvas = globalThis.small(image, Math.ceil(image.width / 2), Math.ceil(image.height / 2));
    const bytes = new Uint8Array(await (await canvas.convertToBlob({ type: "image/png" })).arrayBuffer());
    return btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join(""));
  }, picture.toString("base64"));
  return Buffer.from(text, "base64");
}

/** The page as a picture, and where its scenes lie in it, 0…1. */
async function shot(page, [, , , shown, place]) {
  if (shown) await page.click(`label[for="shown-${shown}"]`);
  if (place !== null) await page.fill("#scrub", String(place));
  await page.evaluate(() => { document.activeElement.blur(); window.scrollTo(0, 0); });
  await page.mouse.move(0, 0);
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  const scenes = await page.locator(".stage:visible").evaluateAll((all) => all.map((stage) => {
    const { left, top, right, bottom } = stage.getBoundingClientRect();
    return [left / innerWidth, top / innerHeight, right / innerWidth, bottom / innerHeight];
  }));
  return { picture: await settled(page), scenes };
}

/** The page as a picture once it no longer changes: a loaded machine may show a picture whose last tiles are still coarse. */
async function settled(page) {
  let before = await page.screenshot();
  for (let tries = 0; tries < 20; tries++) {
    const now = await page.screenshot();
    if (now.equals(before)) return now;
    before = now;
  }
  assert.fail("the page never stands still");
}

/** Compares a picture with its reference, or renews that and the one of the README. */
async function compared(t, now, file, shownInReadme) {
  await writeFile(pictures + file, now.picture);
  const desk = await easel();
  if (process.env.TRUEPATH_BLESS) {
    await mkdir(reference, { recursive: true });
    await writeFile(reference + file, await halved(desk, now.picture));
    if (shownInReadme) {
      await mkdir(readme, { recursive: true });
      await writeFile(readme + file, now.picture);
    }
  }
  const share = await changed(desk, now, await readFile(reference + file));
  t.diagnostic(`${percent(share)} differ`);
  assert.ok(share.drawn <= CELLS.drawn && share.other <= CELLS.other, `${percent(share)} of ${pictures}${file} are not as in ${reference}${file}: look at both; cargo xtask page --write renews them`);
  if (shownInReadme) assert.ok((await readFile(readme + file)).length < README, `${file} of the README is too large`);
}

for (const view of VIEWS) {
  const [name, kind, options, , , shownInReadme] = view;
  test(`${name} looks as before: ${kind}`, async (t) => {
    const { page, close } = await open(await fileOf(name), options);
    const now = await shot(page, view);
    await close();
    await compared(t, now, `${name.replaceAll("/", "-")}-${kind}.png`, shownInReadme);
  });
}

test("the first sheet of paper looks as before", async (t) => {
  // A4 at 96 px an inch, between its margins.
  const { page, close } = await open(await report("demo/pocket"), { viewport: { width: 718, height: 1047 } });
  await page.emulateMedia({ media: "print" });
  await page.evaluate(() => window.dispatchEvent(new Event("beforeprint")));
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  const picture = await settled(page);
  await page.emulateMedia({ media: null });
  await close();
  await compared(t, { picture, scenes: [] }, "demo-pocket-print.png");
});

test("the wall in 3D looks as before", async (t) => {
  const { page, close } = await open(await report("demo/pocket"), SIZE);
  await page.fill("#scrub", "560");
  await page.click('label[for="wall-3D"]');
  await page.mouse.move(0, 0);
  const picture = await page.locator("#unrolled").screenshot();
  await close();
  await compared(t, { picture, scenes: [[0, 0.12, 1, 0.9]] }, "demo-pocket-3d.png", true);
});

test("the pictures are the same to the last pixel whatever fonts the system has", async () => {
  const view = VIEWS.find(([name, kind]) => name === "demo/pocket" && kind === "both");
  const [name, , options] = view;
  const other = await launch({ system: true });
  try {
    const file = await report(name);
    const { page, close } = await open(file, options);
    let here = await shot(page, view);
    const tab = await other.newPage({ ...options, colorScheme: "light" });
    await show(tab, file);
    // A loaded machine may show a tile late, in either: the same picture has to come within a few tries, of another font it never does.
    let there = await shot(tab, view);
    for (let tries = 0; tries < 5 && !here.picture.equals(there.picture); tries++) {
      for (const each of [page, tab]) await show(each, file);
      here = await shot(page, view);
      there = await shot(tab, view);
    }
    await close();
    if (here.picture.equals(there.picture)) return;
    await writeFile(`${pictures}fonts-here.png`, here.picture);
    await writeFile(`${pictures}fonts-there.png`, there.picture);
    const share = await changed(await easel(), here, there.picture);
    assert.fail(`${name} is drawn with fonts of the system: ${percent(share)} differ, see ${pictures}fonts-here.png and fonts-there.png`);
  } finally {
    await other.close();
  }
});

test("the comparison notices a layer, a place and a block, and not another rendering of letters", async (t) => {
  const { page, close } = await open(await report("demo/pocket"), SIZE);
  const desk = await easel();
  const still = [null, null, null, null, null];
  const one = await shot(page, VIEWS.find(([name, kind]) => name === "demo/pocket" && kind === "light"));
  const share = async (what, change, back) => {
    await change();
    const found = await changed(desk, one, (await shot(page, still)).picture);
    await back();
    t.diagnostic(`${what}: ${percent(found)}`);
    return Math.max(found.drawn / CELLS.drawn, found.other / CELLS.other);
  };
  const style = (text) => page.evaluate((rule) => {
    document.querySelector("#tried")?.remove();
    document.head.insertAdjacentHTML("beforeend", `<style id="tried">${rule}</style>`);
  }, text);
  const styled = (rule) => [() => style(rule), () => style("")];
  const layer = (id) => [() => page.uncheck(`#layer-${id}`), () => page.check(`#layer-${id}`)];
  // Letters of the canvases a little aside, drawn anew by a layer that is taken away and put back.
  const lettered = async (by) => {
    await page.evaluate((aside) => {
      const { prototype } = CanvasRenderingContext2D;
      globalThis.letters ??= prototype.fillText;
      prototype.fillText = function moved(text, x, y) { globalThis.letters.call(this, text, x + aside, y + aside); };
    }, by);
    await page.uncheck("#layer-nominal");
    await page.check("#layer-nominal");
  };
  for (const [what, ...ways] of [
    ["no band", ...layer("band")], ["no cutter", ...layer("cutter")], ["no actual path", ...layer("actual")], ["no points", ...layer("points")],
    ["the cutter elsewhere", () => page.fill("#scrub", "1400"), () => page.fill("#scrub", "560")],
    ["no traces", ...styled(".traces { visibility: hidden }")], ["no results", ...styled(".results { visibility: hidden }")],
    ["another place of the picture", ...styled(".stage canvas { transform: translateX(8px) }")],
  ]) assert.ok(await share(what, ...ways) > NOTICED, what);
  for (const [what, ...ways] of [
    ["nothing", async () => undefined, async () => undefined],
    ["heavier letters", ...styled("* { -webkit-text-stroke: 0.15px }")], ["letters wider by 1 %", ...styled("* { letter-spacing: 0.06px }")],
    ["letters lower by half a pixel", ...styled(":is(span, p, h1, h2, dt, dd, td, th, b) { position: relative; top: 0.5px }")],
    ["letters of the scenes aside by half a pixel", () => lettered(0.5), () => lettered(0)],
  ]) assert.ok(await share(what, ...ways) < 1 / RENDERED, what);
  await close();
});
