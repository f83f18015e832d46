// Zoomed in as far as it goes, a metre from the origin: everything is where it belongs, to the pixel, and can be read.
import assert from "node:assert/strict";
import { test } from "node:test";
import { column } from "./columns.mjs";
import { onPage, open, write } from "./browser.mjs";

const FAR = 1000;
const RADIUS = 5;
const SPACING = 0.1;

/** A straight pass along Y = −1000 towards X 1000, wall on its right, error of a tenth of a millimetre, no deflection. */
async function straight() {
  const each = (f) => column(Array.from({ length: 101 }, (_, i) => f(i)));
  return write("deep", {
    version: 1, kind: "simulate", title: "Straight", job: { wall: "right", tool: { diameter_mm: 2 * RADIUS }, cut: { feed_mm_per_min: 600 } },
    contour: { s_mm: each((i) => i * SPACING), x_mm: each((i) => FAR + i * SPACING), y_mm: each(() => -FAR),
      before: { error_mm: each(() => 0.1), arc_deg: each(() => 30), dx_mm: each(() => 0), dy_mm: each(() => 0) } },
  });
}

/** Turns the wheel over a place of the part until the picture grows no more. */
async function deepest(page, x, y) {
  await page.locator(".stage").focus();
  let last = 0;
  for (let scale = 1; scale !== last;) {
    const at = await onPage(page, x, y);
    await page.mouse.move(at.x, at.y);
    last = scale;
    for (let k = 0; k < 4; k++) await page.mouse.wheel(0, -250);
    await page.waitForFunction((before) => Number(document.querySelector(".stage").dataset.view.split(" ")[2]) > before || before === 1e5, last);
    scale = Number((await page.getAttribute(".stage", "data-view")).split(" ")[2]);
  }
  await page.mouse.move(0, 0);
  return last;
}

/** Pixel of a layer of the picture at a place of the part, moved by some pixels: red, green, blue, opacity. */
async function pixel(page, layer, x, y, [dx, dy] = [0, 0]) {
  const at = await onPage(page, x, y);
  return page.evaluate(([number, left, top]) => {
    const canvas = document.querySelectorAll(".stage canvas")[number];
    const box = canvas.getBoundingClientRect();
    return [...canvas.getContext("2d").getImageData(Math.floor(left - box.left), Math.floor(top - box.top), 1, 1).data];
  }, [layer, at.x + dx, at.y + dy]);
}

test("the wall and the rim of the cutter stay where they are at the deepest zoom", async () => {
  const { page, close } = await open(await straight());
  await page.selectOption("#magnify", "1");
  const wall = [FAR + 3 + SPACING / 3, -FAR - RADIUS];
  assert.equal(await deepest(page, ...wall), 1e5);
  assert.ok((await pixel(page, 0, ...wall))[0] < 90, "the line of the wall");
  assert.ok((await pixel(page, 0, ...wall, [0, 6]))[0] > 150 && (await pixel(page, 0, ...wall, [0, -6]))[0] > 150, "and nothing beside it");
  await page.locator(".stage").focus();
  await page.keyboard.press("0");
  // Away from the wall and from the engaged arc.
  const rim = [FAR + RADIUS * Math.cos(0.2), -FAR + RADIUS * Math.sin(0.2)];
  assert.equal(await deepest(page, ...rim), 1e5);
  const inward = [-8 * Math.cos(0.2), 8 * Math.sin(0.2)];
  assert.ok((await pixel(page, 1, ...rim))[3] > 120, "the rim of the cutter");
  const [, , , inside] = await pixel(page, 1, ...rim, inward);
  const [, , , outside] = await pixel(page, 1, ...rim, inward.map((v) => -v));
  assert.ok(inside > 0 && inside < 60 && outside === 0, `${inside} within, ${outside} without`);
  await close();
});

test("between two samples far apart on the screen the pointer is told the nearer one", async () => {
  const { page, close } = await open(await straight());
  await deepest(page, FAR + 3.06, -FAR - RADIUS);
  for (const [x, s] of [[3.06, "3.100 mm"], [3.059, "3.100 mm"]]) {
    const at = await onPage(page, FAR + x, -FAR - RADIUS);
    await page.mouse.move(at.x, at.y + 3);
    assert.equal(await page.locator(".flag.shown b").first().textContent(), s);
  }
  await close();
});

test("numbers of the grid have a rim of ground where they lie on something, and small errors are told in micrometres", async () => {
  const { page, close } = await open(await straight());
  await page.evaluate(() => {
    globalThis.written = [];
    const { fillText } = CanvasRenderingContext2D.prototype;
    CanvasRenderingContext2D.prototype.fillText = function kept(text, x, y) {
      if (this.canvas.closest(".stage")) globalThis.written.push([text, x, y]);
      fillText.call(this, text, x, y);
    };
  });
  // Into the band of the error: it fills the whole picture.
  const factor = Number(await page.inputValue("#magnify"));
  await deepest(page, FAR + 3, -FAR - RADIUS + 0.05 * factor);
  const [number, x, y] = await page.evaluate(() => globalThis.written.filter(([text]) => /^\d+\.\d+$/.test(text)).at(-1));
  const ground = await page.evaluate(([left, bottom]) => {
    const { data } = document.querySelector(".stage canvas").getContext("2d").getImageData(Math.round(left) - 2, Math.round(bottom) - 14, 40, 14);
    return Array.from({ length: data.length / 4 }, (_, k) => [0, 1, 2].every((c) => data[4 * k + c] === 255)).filter(Boolean).length;
  }, [x, y]);
  assert.ok(ground > 60, `${ground} pixels of ground about ${number}`);
  assert.match(await page.evaluate(() => globalThis.written.filter(([text]) => text.startsWith("error")).at(-1)[0]), /^error \d*\.?\d+ µm$/);
  await close();
});
