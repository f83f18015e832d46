// First picture and frames a second, of the pocket and of a contour of ten metres with 100,000 samples.
// A machine that is busy with something else may miss the figures once: then they are measured again, and it is said.
import assert from "node:assert/strict";
import { test } from "node:test";
import { dataOf, open, report, write } from "./browser.mjs";

/** Milliseconds to the first picture; frames a second at least while playing. */
const FIRST = 1000;
const FRAMES = 30;
/** Milliseconds from a key to its picture, of the long contour. */
const REDRAW = 150;

/** Frames in which the cutter stood elsewhere than in the one before, a second. */
async function frames(page, seconds) {
  return page.evaluate((duration) => new Promise((done) => {
    const canvas = document.querySelectorAll(".stage canvas")[1];
    const context = canvas.getContext("2d");
    let drawn = 0;
    const clear = context.clearRect;
    context.clearRect = function cleared(...box) { drawn++; clear.apply(context, box); };
    const from = performance.now();
    setTimeout(() => {
      context.clearRect = clear;
      done(drawn / ((performance.now() - from) / 1000));
    }, duration * 1000);
  }), seconds);
}

/** How long the slowest key takes from press to picture, zooming in and out step by step. */
async function slowestRedraw(page) {
  return page.evaluate(async () => {
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
}

async function measured(file, redraws) {
  const { page, complaints, close } = await open(file);
  const first = Number(await page.getAttribute("html", "data-first-picture"));
  await page.click("#play");
  const rate = await frames(page, 1.5);
  await page.click("#play");
  const slowest = redraws ? await slowestRedraw(page) : 0;
  assert.deepEqual(complaints, []);
  await close();
  return { first, rate, slowest };
}

async function fast(t, name, file, redraws = false) {
  for (const again of [true, false]) {
    const { first, rate, slowest } = await measured(file, redraws);
    const said = `${name}: first picture ${first} ms, ${rate.toFixed(0)} frames a second${redraws ? `, slowest redraw ${slowest.toFixed(0)} ms` : ""}`;
    t.diagnostic(said);
    if (first < FIRST && rate >= FRAMES && slowest < REDRAW) return;
    assert.ok(again, said);
    t.diagnostic("missed once: measured again");
  }
}

test("the pocket is there within a second and plays with 30 frames a second or more", async (t) => {
  await fast(t, "pocket", await report("demo/pocket"));
});

test("a simulated contour of ten metres, 100,000 samples, plays, zooms and moves smoothly", async (t) => {
  await fast(t, "ten metres", await report("long"), true);
});

test("the same contour before and after a correction does, too", async (t) => {
  const long = await dataOf("long");
  // Made up for the test: the program corrects such a contour in half a minute, simulates it in two seconds.
  const { contour } = long;
  const { before } = contour;
  const both = { ...contour, correction_x_mm: before.dx_mm, correction_y_mm: before.dy_mm, after: { ...before, sigma_mm: before.error_mm } };
  await fast(t, "ten metres, two passes", await write("long-both", { ...long, kind: "correct", contour: both }), true);
});
