// First picture and frames a second, of the pocket and of a contour of 100,000 samples.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { column } from "../samples/convert.mjs";
import { launch, open, sample, write } from "./browser.mjs";

let browser;
before(async () => { browser = await launch(); });
after(() => browser.close());

/** Frames in which the cutter stood elsewhere than in the one before, a second. */
async function frames(page, seconds) {
  return page.evaluate((duration) => new Promise((done) => {
    const canvas = document.querySelectorAll(".stage canvas")[1];
    const context = canvas.getContext("2d");
    let drawn = 0;
    const clear = context.clearRect;
    context.clearRect = function cleared(...box) { drawn++; clear.apply(context, box); };
    const from = performance.now();
    setTimeout(() => done(drawn / ((performance.now() - from) / 1000)), duration * 1000);
  }), seconds);
}

test("the pocket is there within a second and plays with 30 frames a second or more", async (t) => {
  const { page, close } = await open(browser, await write("pocket", await sample("pocket")));
  const first = Number(await page.getAttribute("html", "data-first-picture"));
  await page.click("#play");
  const rate = await frames(page, 2);
  t.diagnostic(`first picture ${first} ms, ${rate.toFixed(0)} frames a second`);
  assert.ok(first < 1000, `${first} ms`);
  assert.ok(rate >= 30, `${rate} frames a second`);
  await close();
});

test("a contour of 100,000 samples plays, zooms and moves smoothly", async (t) => {
  const count = 100_000;
  const each = (f) => column(Array.from({ length: count }, (_, i) => f(i).toFixed(5)));
  const turn = (i) => (2 * Math.PI * i) / count;
  const radius = (i) => 400 + 40 * Math.sin(12 * turn(i));
  const pass = (k) => ({
    error_mm: each((i) => k * (0.1 + 0.05 * Math.sin(300 * turn(i)))), arc_deg: each((i) => 40 + 5 * Math.sin(90 * turn(i))),
    force_n: each((i) => 200 + 20 * Math.sin(90 * turn(i))), fx_n: each((i) => 200 * Math.cos(turn(i))), fy_n: each((i) => 200 * Math.sin(turn(i))),
    dx_mm: each((i) => -0.1 * Math.cos(turn(i))), dy_mm: each((i) => -0.1 * Math.sin(turn(i))), chip_area_mm2: each(() => 0.1),
  });
  const file = await write("long", {
    version: 1, kind: "correct", title: "A long contour", tolerance_mm: 0.02,
    job: { wall: "right", tool: { diameter_mm: 20 }, cut: { feed_mm_per_min: 6000 }, stock: { allowance_mm: 1 } },
    contour: {
      s_mm: each((i) => i * 0.026), x_mm: each((i) => radius(i) * Math.cos(turn(i))), y_mm: each((i) => radius(i) * Math.sin(turn(i))),
      correction_x_mm: each((i) => 0.1 * Math.cos(turn(i))), correction_y_mm: each((i) => 0.1 * Math.sin(turn(i))), before: pass(1), after: pass(0.1),
    },
  });
  const { page, complaints, close } = await open(browser, file);
  const first = Number(await page.getAttribute("html", "data-first-picture"));
  await page.click("#play");
  const rate = await frames(page, 2);
  await page.click("#play");
  // Zooming in step by step: how long a key takes from press to picture.
  const slowest = await page.evaluate(async () => {
    const stage = document.querySelector(".stage");
    let most = 0;
    for (const key of [..."+++++++++++++++", "ArrowRight", "ArrowUp", ..."---------------"]) {
      const from = performance.now();
      stage.dispatchEvent(new KeyboardEvent("keydown", { key }));
      await new Promise((done) => requestAnimationFrame(() => done()));
      most = Math.max(most, performance.now() - from);
    }
    return most;
  });
  t.diagnostic(`first picture ${first} ms, ${rate.toFixed(0)} frames a second, slowest redraw ${slowest.toFixed(0)} ms`);
  assert.ok(rate >= 30, `${rate} frames a second`);
  assert.ok(slowest < 150, `${slowest} ms`);
  assert.deepEqual(complaints, []);
  await close();
});
