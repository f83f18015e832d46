// The wall unrolled: colours, isolines and touches are where arc length and height put them, for eyes, keys and readers of the screen.
import assert from "node:assert/strict";
import { test } from "node:test";
import { open, PHONE, pictures, report, write } from "./browser.mjs";
import { leaning } from "./leaning.mjs";
import { faults, listen, settled, violations } from "./checks.mjs";

/** Edges of the drawing about the wall, pixels. */
const EDGE = { left: 46, right: 12, top: 10, bottom: 24 };
const HIGH = 190;

/** The colour at an arc length and a height. */
async function colour(page, s, z) {
  return page.locator(".unrolled canvas").evaluate((canvas, [at, up, edge, high]) => {
    const wide = canvas.clientWidth - edge.left - edge.right;
    const [x, y] = [edge.left + (at / 100) * wide, edge.top + (1 - up / 10) * (high - edge.top - edge.bottom)];
    return [...canvas.getContext("2d").getImageData(Math.floor(x), Math.floor(y), 1, 1).data].slice(0, 3);
  }, [s, z, EDGE, HIGH]);
}
const near = (a, b, slack = 6) => a.every((v, k) => Math.abs(v - b[k]) <= slack);

/** Dark rows of a column of the drawing, as heights. */
async function lines(page, s) {
  return page.locator(".unrolled canvas").evaluate((canvas, [at, edge, high]) => {
    const wide = canvas.clientWidth - edge.left - edge.right;
    const x = Math.floor(edge.left + (at / 100) * wide);
    const tall = high - edge.top - edge.bottom;
    const { data } = canvas.getContext("2d").getImageData(x, edge.top + 2, 1, tall - 4);
    const dark = [];
    for (let y = 0; y < tall - 4; y++) if (data[4 * y] + data[4 * y + 1] + data[4 * y + 2] < 260) dark.push((1 - (y + 2.5) / tall) * 10);
    return dark;
  }, [s, EDGE, HIGH]);
}

test("errors have the colour of the legend where arc length and height put them, however unevenly they are sampled", async () => {
  const { page, complaints, close } = await open(await write("leaning", leaning()));
  assert.equal(await page.inputValue("#colour-scale"), "0.1");
  for (const s of [3, 9, 30, 97]) {
    // −0.04, 0 and 0.06 mm of 0.1 mm: 80 % of the way to half of blue, white, 20 % beyond half of orange.
    assert.ok(near(await colour(page, s, 4), [255, 255, 255]), `${s}: ${await colour(page, s, 4)}`);
    assert.ok(near(await colour(page, s, 0.05), [137, 179, 222]), `${s}: ${await colour(page, s, 0.05)}`);
    assert.ok(near(await colour(page, s, 9.95), [231, 142, 68], 8), `${s}: ${await colour(page, s, 9.95)}`);
    // Between the uneven heights it is linear.
    const [low, high] = [await colour(page, s, 1), await colour(page, s, 7)];
    assert.ok(near(low, [166, 198, 230]), `${low}`);
    assert.ok(near(high, [250, 200, 152]), `${high}`);
  }
  await page.selectOption("#colour-scale", "0.02");
  assert.ok(near(await colour(page, 50, 9.5), [166, 54, 3]), "beyond the scale the colour of its end");
  assert.match(await page.locator(".unrolled-key").textContent(), /too deep −0\.020 and more.*\+0\.020 mm and more, left/);
  // What the test itself reads is slow to read.
  assert.deepEqual(complaints.filter((text) => !text.includes("willReadFrequently")), []);
  await close();
});

test("lines stand at the tolerance, of each pass its own, and a slider goes from one pass to the other", async () => {
  const { page, close } = await open(await write("leaning", leaning({ tolerance_mm: 0.02 })));
  assert.match(await page.locator(".unrolled-key").textContent(), /lines: tolerance, \+0\.020 mm full, −0\.020 mm dashed/);
  // Before: −0.02 at 2 mm, dashed, and 0.02 at 6 mm.
  const found = (await Promise.all([20, 21, 22, 23].map((s) => lines(page, s)))).flat();
  assert.ok(found.some((z) => Math.abs(z - 6) < 0.15) && found.some((z) => Math.abs(z - 2) < 0.15), `${found}`);
  assert.ok(found.every((z) => Math.abs(z - 6) < 0.3 || Math.abs(z - 2) < 0.3), `${found}`);
  await page.fill("#wipe", "50");
  assert.ok(near(await colour(page, 30, 9), [253, 237, 221]), "after on the first half");
  assert.ok(near(await colour(page, 70, 9.95), [231, 142, 68], 8), "before on the second");
  assert.deepEqual(await lines(page, 20), [], "within the tolerance no line");
  assert.match(await page.getAttribute("#wipe", "aria-valuetext"), /^after on the first 50 % of the contour, before on the rest$/);
  await page.fill("#wipe", "100");
  const [part] = [await page.evaluate(() => { const c = document.createElement("canvas").getContext("2d"); c.fillStyle = getComputedStyle(document.documentElement).getPropertyValue("--part"); c.fillRect(0, 0, 1, 1); return [...c.getImageData(0, 0, 1, 1).data].slice(0, 3); })];
  assert.ok(near(await colour(page, 95, 5), part, 0), "no colour where no wall stands");
  assert.match(await page.getAttribute("#wipe", "aria-valuetext"), /^after$/);
  await close();
});

test("touches stand at their arc length and height, in the colour of what was measured, beside the pass they are of", async () => {
  const points = [{ line: 1, status: "used", s_mm: 40, x_mm: 40, y_mm: -3, z_mm: 5, nx: 0, ny: -1, error_mm: -0.1 }, { line: 2, status: "aside", reason: "far", s_mm: 60, x_mm: 60, y_mm: -3, z_mm: 5 }];
  const { page, close } = await open(await write("leaning", leaning({ points })));
  assert.ok(near(await colour(page, 40, 5), [8, 69, 148]), `${await colour(page, 40, 5)}`);
  assert.ok(!near(await colour(page, 60, 5), [8, 69, 148], 60));
  await page.fill("#wipe", "100");
  assert.ok(near(await colour(page, 40, 5), [253, 237, 221]), "not on the wall that was not touched");
  await close();
});

test("the wall is worked with the keyboard, said in words, and leads to the cutter", async () => {
  const { page, complaints, close } = await open(await write("leaning", leaning({ tolerance_mm: 0.02 })));
  // 40 % of the height lie between 2 and 6 mm; of the other pass all that stands.
  assert.match(await page.getAttribute(".unrolled", "aria-label"), /^The wall unrolled, 100\.0 mm long, 10\.0 mm high\. before: largest error at 3 heights 0\.060 mm, \d+ % of it within tolerance; after: largest error at 3 heights 0\.010 mm, 100 % of it within tolerance\.$/);
  await page.focus(".unrolled");
  const told = () => page.locator(".unrolled-told").textContent();
  assert.equal(await told(), "s 0.0 mm, 5.0 mm above the tip: before +0.010 mm");
  for (const key of ["PageUp", "End"]) await page.keyboard.press(key);
  assert.equal(await told(), "s 100.0 mm, 10.0 mm above the tip: before +0.060 mm");
  await page.keyboard.press("PageDown");
  await page.keyboard.press("Shift+ArrowLeft");
  assert.equal(await told(), "s 97.5 mm, 0.0 mm above the tip: before −0.040 mm");
  await page.keyboard.press("ArrowUp");
  assert.equal(await told(), "s 97.5 mm, 0.5 mm above the tip: before −0.035 mm");
  await page.keyboard.press("Enter");
  assert.ok(["187", "188"].includes(await page.inputValue("#scrub")), await page.inputValue("#scrub"));
  // The cutter put elsewhere is where the cross is.
  await page.fill("#scrub", "50");
  assert.match(await told(), /^s 5\.0 mm/);
  const box = await page.locator(".unrolled").boundingBox();
  await page.mouse.click(box.x + EDGE.left + 0.5 * (box.width - EDGE.left - EDGE.right), box.y + 60);
  assert.ok(Math.abs(Number(await page.inputValue("#scrub")) - 140) <= 1, "a click leads there, too");
  assert.deepEqual(await violations(page), []);
  assert.deepEqual(complaints, []);
  await close();
});

test("on a phone and on paper the wall is whole, and it is missing where nothing is known over the height", async () => {
  for (const options of [PHONE, { colorScheme: "dark" }]) {
    const { page, close } = await open(await report("demo/pocket"), options);
    await listen(page);
    await page.selectOption("#colour-scale", { index: 1 });
    await settled(page);
    assert.deepEqual(await faults(page), []);
    assert.deepEqual(await violations(page), []);
    if (options !== PHONE) {
      await page.locator("#unrolled").screenshot({ path: `${pictures}pocket-unrolled.png` });
      await page.evaluate(() => window.dispatchEvent(new Event("beforeprint")));
      const inside = await page.locator(".unrolled canvas").evaluate((canvas) => [canvas.width / canvas.clientWidth, canvas.getBoundingClientRect().right <= document.body.getBoundingClientRect().right + 1]);
      assert.ok(inside[0] > 2.5 && inside[1], `${inside}`);
      await page.evaluate(() => window.dispatchEvent(new Event("afterprint")));
    }
    await close();
  }
  const { page, close } = await open(await write("flat", { ...leaning(), heights: undefined }));
  assert.equal(await page.locator("#unrolled").count(), 0);
  await close();
});
