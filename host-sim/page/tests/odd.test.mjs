// Contours and texts that nobody draws on purpose: the page shows what can be shown, and says the rest.
import assert from "node:assert/strict";
import { test } from "node:test";
import { column } from "./columns.mjs";
import { dataOf, open, PHONE, show, write } from "./browser.mjs";

const JOB = { wall: "right", tool: { diameter_mm: 10 }, cut: { feed_mm_per_min: 600 }, stock: { allowance_mm: 0.5 } };

/** A pass along points, a sample each; what is given of it may be replaced. */
function contour(points, change = {}) {
  let s = 0;
  const along = points.map(([x, y], i) => (i === 0 ? 0 : (s += Math.hypot(x - points[i - 1][0], y - points[i - 1][1]))));
  const each = (f) => column(points.map((_, i) => f(i)));
  return {
    s_mm: column(along), x_mm: column(points.map(([x]) => x)), y_mm: column(points.map(([, y]) => y)),
    before: { error_mm: each((i) => 0.01 * Math.sin(i)), arc_deg: each(() => 30), force_n: each(() => 100), fx_n: each(() => 100), fy_n: each(() => 0),
      dx_mm: each(() => 0.01), dy_mm: each(() => -0.01), ...change },
  };
}

const line = (count, step = 0.1, far = 0) => Array.from({ length: count }, (_, i) => [far + i * step, far]);
const circle = (radius, count) => Array.from({ length: count + 1 }, (_, i) => [radius * Math.sin((2 * Math.PI * i) / count), radius * Math.cos((2 * Math.PI * i) / count)]);
const nothing = (count) => column(Array.from({ length: count }, () => NaN));

const ODD = {
  "two samples": contour(line(2)),
  "samples on one spot": contour(Array.from({ length: 20 }, () => [5, 5])),
  "several samples on the spot of a corner": contour([...line(30), ...Array.from({ length: 5 }, () => [2.9, 0]), ...Array.from({ length: 30 }, (_, i) => [2.9, -0.1 * (i + 1)])]),
  "a closed circle smaller than the cutter": contour(circle(2, 200)),
  "an arc of a hundredth of a millimetre": contour(circle(0.01, 60)),
  "no value anywhere": contour(line(50), { error_mm: nothing(50), arc_deg: nothing(50), force_n: nothing(50), dx_mm: nothing(50), dy_mm: nothing(50) }),
  "errors of a metre": contour(line(50), { error_mm: column(Array.from({ length: 50 }, () => 1000)) }),
  "two kilometres from the origin": (() => {
    const far = contour(line(50, 0.1));
    return { ...far, x_mm: { ...far.x_mm, offset: 2e12 }, y_mm: { ...far.y_mm, offset: -2e12 } };
  })(),
};

test("odd contours are shown, zoomed and played without a complaint", async (t) => {
  const { page, complaints, close } = await open("about:blank", { clock: true });
  for (const [name, path] of Object.entries(ODD)) {
    await show(page, await write("odd", { version: 1, kind: "simulate", title: name, job: JOB, contour: path }));
    assert.equal(await page.locator("[role=alert]").count(), 0, name);
    await page.locator(".stage:visible").focus();
    for (const key of ["+", "+", "ArrowLeft", "-", "0", ".", ",", "End", "Home"]) await page.keyboard.press(key);
    for (const number of (await page.getAttribute(".stage:visible", "data-view")).split(" ")) assert.ok(Number.isFinite(Number(number)), name);
    await page.click("#play");
    await page.clock.runFor(100);
    assert.deepEqual(complaints, [], name);
    t.diagnostic(name);
  }
  await close();
});

test("a contour of one sample is not drawn, and the page says so and shows the rest", async () => {
  const { points } = await dataOf("correct");
  const { page, complaints, close } = await open(await write("odd", { version: 1, kind: "correct", title: "One", job: JOB, contour: contour(line(1)), points }));
  assert.match(await page.locator(".warnings li").first().textContent(), /fewer than two samples/);
  assert.equal(await page.locator("#points tbody tr").count(), points.length);
  assert.deepEqual(complaints, []);
  await close();
});

test("long names, many warnings, points without a place on the contour: nothing runs over, nothing is lost", async () => {
  const data = await dataOf("correct");
  const long = "a very long name of a part that somebody has typed without ever pressing the blank_".repeat(4).replaceAll(" ", "_");
  data.title = long;
  data.program = { name: `${long}.nc`, crc32: "01234567" };
  data.job.material = long;
  data.job.facts = [{ name: long, value: long }];
  data.warnings = Array.from({ length: 60 }, (_, i) => `${i + 1}: ${i % 7 ? "a warning of ordinary length, as the program gives them" : long}`);
  data.results = [...(data.results ?? []), { name: long, value: 1, decimals: 4, unit: "mm", note: long }];
  data.points = data.points.map(({ s_mm: _, ...point }, i) => (i % 2 ? { ...point, status: "aside", reason: long } : point));
  for (const options of [PHONE, { viewport: { width: 1440, height: 900 } }]) {
    const { page, complaints, close } = await open(await write("odd", data), options);
    const { width } = options.viewport;
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth) <= width, `${width}: as opened`);
    await page.click(".warnings summary");
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth) <= width, `${width}: with warnings`);
    assert.equal(await page.locator(".warnings li").count(), 60);
    await page.locator(".warnings li").last().scrollIntoViewIfNeeded();
    assert.ok(await page.locator(".warnings li").last().isVisible());
    assert.equal(await page.locator("#points tbody tr").count(), data.points.length);
    assert.deepEqual(complaints, []);
    await close();
  }
});
