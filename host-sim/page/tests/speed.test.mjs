// First picture and frames a second, of the pocket and of a contour of ten metres with 100,000 samples.
// A machine that is slow or busy with something else may miss the figures: then they are measured again, and if they are missed a second
// time the page's own processor time decides, against what the machine takes for other work. What happened is said.
import assert from "node:assert/strict";
import { test } from "node:test";
import { dataOf, open, report, show, write } from "./browser.mjs";
import { busy, processor, slowness } from "./pace.mjs";

/** Milliseconds to the first picture, of the long contour; frames a second at least while playing. */
const FIRST = 1000;
const FIRST_LONG = 2000;
const FRAMES = 30;
/** Milliseconds from a key to its picture, of the long contour. */
const REDRAW = 150;

/** Frames in which the cutter stood elsewhere than in the one before: a second, and in all. */
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
      done([drawn / ((performance.now() - from) / 1000), drawn]);
    }, duration * 1000);
  }), seconds);
}

/** How long the slowest key takes from press to picture, zooming in and out step by step; and how many there were. */
async function slowestRedraw(page) {
  return page.evaluate(async () => {
    const stage = document.querySelector(".stage");
    const keys = [..."+++++++++++++++", "ArrowRight", "ArrowUp", ..."---------------"];
    let most = 0;
    for (const key of keys) {
      const from = performance.now();
      stage.dispatchEvent(new KeyboardEvent("keydown", { key }));
      await new Promise((done) => requestAnimationFrame(() => done()));
      most = Math.max(most, performance.now() - from);
    }
    return [most, keys.length];
  });
}

async function measured(file, redraws) {
  const { context, page, complaints, close } = await open("about:blank");
  const cost = await processor(context, page);
  await show(page, file);
  const first = Number(await page.getAttribute("html", "data-first-picture"));
  const firstCpu = await cost.read();
  await page.click("#play");
  const from = await cost.read();
  const [rate, drawn] = await frames(page, 1.5);
  const frameCpu = ((await cost.read()) - from) / Math.max(1, drawn);
  await page.click("#play");
  const before = await cost.read();
  const [slowest, keys] = redraws ? await slowestRedraw(page) : [0, 1];
  const redrawCpu = ((await cost.read()) - before) / keys;
  assert.deepEqual(complaints, []);
  await cost.close();
  await close();
  const slow = await slowness(context, page);
  return { first, firstCpu, rate, frameCpu, slowest, redrawCpu, slow };
}

async function fast(t, name, file, most, redraws = false) {
  for (const again of [true, false]) {
    const { first, firstCpu, rate, frameCpu, slowest, redrawCpu, slow } = await measured(file, redraws);
    const said = `${name}: first picture ${first} ms (${firstCpu.toFixed(0)} ms of processor), ${rate.toFixed(0)} frames a second (${frameCpu.toFixed(1)} ms each)`
      + (redraws ? `, slowest redraw ${slowest.toFixed(0)} ms (${redrawCpu.toFixed(0)} ms each)` : "");
    t.diagnostic(said);
    if (first < most && rate >= FRAMES && slowest < REDRAW) return;
    t.diagnostic(`other work takes ${slow.toFixed(1)} times as long as it might${again ? ": measured again" : ""}`);
    if (again) continue;
    const fair = busy() || slow > 1;
    assert.ok(fair && firstCpu < most * slow && frameCpu < (1000 / FRAMES) * slow && redrawCpu < REDRAW * slow, said);
    t.diagnostic("the machine is busy or slow: judged by processor time");
  }
}

test("the pocket is there within a second and plays with 30 frames a second or more", async (t) => {
  await fast(t, "pocket", await report("demo/pocket"), FIRST);
});

test("a simulated contour of ten metres, 100,000 samples, plays, zooms and moves smoothly", async (t) => {
  await fast(t, "ten metres", await report("long"), FIRST_LONG, true);
});

test("the same contour before and after a correction does, too", async (t) => {
  const long = await dataOf("long");
  // Made up for the test: the program corrects such a contour in half a minute, simulates it in two seconds.
  const { contour } = long;
  const { before } = contour;
  const both = { ...contour, correction_x_mm: before.dx_mm, correction_y_mm: before.dy_mm, after: { ...before, sigma_mm: before.error_mm } };
  await fast(t, "ten metres, two passes", await write("long-both", { ...long, kind: "correct", contour: both }), FIRST_LONG, true);
});
