// Millimetres and inches: a page opens in the unit of its program, and one switch says every length in the other.
import assert from "node:assert/strict";
import { test } from "node:test";
import { dataOf, flag, onPage, open, PHONE, report, write } from "./browser.mjs";
import { faults, listen, settled, violations } from "./checks.mjs";
import { column, numbers } from "./columns.mjs";

const INCH = 25.4;
/** As a machinist reads it: a true minus sign, and a sign where the page gives one. */
const inches = (mm, decimals) => { const text = (mm / INCH).toFixed(decimals); return Number(text) === 0 ? text.replace("-", "") : text.replace("-", "−"); };
const signed = (mm, decimals) => { const text = inches(mm, decimals); return text.startsWith("−") || Number(text) === 0 ? text : `+${text}`; };

/** Everything the page says to anybody, and what stands on its canvases. */
async function said(page) {
  await settled(page);
  return page.evaluate(() => {
    const all = [];
    const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    for (let node = walk.nextNode(); node; node = walk.nextNode()) if (!node.parentElement.closest("script, style, noscript, #unit, #live")) all.push(node.data);
    for (const name of ["aria-label", "aria-valuetext", "title", "data-at"]) {
      for (const element of document.querySelectorAll(`[${name}]:not(#unit)`)) all.push(element.getAttribute(name));
    }
    for (const [canvas, texts] of globalThis.written ?? []) if (canvas.isConnected) all.push(...texts.map(({ text }) => text));
    return all.map((text) => text.trim()).filter(Boolean);
  });
}

const metric = (texts) => texts.filter((text) => /(^|[\s(])(mm|µm|mm²|mm\/min)([\s,.;:)]|$)/.test(text));
const imperial = (texts) => texts.filter((text) => /\d in([,.;:)]|$)|^(in|in²|in\/min)$|^(?!Zoom).* in$/.test(text));

/** A straight pass along X of 127 mm with an even wall of 10 mm, which was touched; all of it by numbers that are known. */
function straight(more = {}) {
  const each = (f) => column(Array.from({ length: 128 }, (_, i) => f(i)));
  const error = (i) => (i === 100 ? 0.0508 : 0.0127);
  const z_mm = [0, 5, 10];
  return {
    version: 1, kind: "correct", unit: "in", title: "Straight", program: { name: "part.nc" },
    job: {
      wall: "right", tool: { number: 3, diameter_mm: 12.7, teeth: 4, stickout_mm: 38.1 }, cut: { axial_depth_mm: 10.16, feed_mm_per_min: 1016, spindle_rpm: 6100 },
      stock: { allowance_mm: 0.508 }, facts: [{ name: "contour", value: ["127.000 mm long", "5.0000 in long"] }, { name: "route", value: "corrected program" }],
    },
    contour: {
      s_mm: each((i) => i), x_mm: each((i) => i), y_mm: each(() => -25.4), correction_x_mm: each(() => 0), correction_y_mm: each(() => 0.0254),
      before: { error_mm: each(error), sigma_mm: each(() => 0.00254), force_n: each(() => 100), fx_n: each(() => 100), fy_n: each(() => 0), dx_mm: each(() => 0.0127), dy_mm: each(() => -0.0127),
        arc_deg: each(() => 20), chip_area_mm2: each(() => 0.064516), feed_mm_per_min: each(() => 1016) },
      after: { error_mm: each(() => 0.000254), sigma_mm: each(() => 0.00254) },
    },
    heights: { z_mm, stride: 1, before: column(Array.from({ length: 128 }, (_, i) => z_mm.map(() => error(i))).flat()), after: column(Array.from({ length: 128 }, () => z_mm.map(() => 0.000254)).flat()) },
    points: [{ line: 1, status: "used", s_mm: 25.4, x_mm: 25.4, y_mm: -31.75, z_mm: 5.08, nx: 0, ny: -1, error_mm: 0.0127 },
      { line: 2, status: "used", s_mm: 100, x_mm: 100, y_mm: -31.75, z_mm: 5.08, nx: 0, ny: -1, error_mm: 0.0508 },
      { line: 3, status: "aside", reason: ["9.000 mm from the nominal wall", "0.3543 in from the nominal wall"], x_mm: 254, y_mm: 0 }],
    parameters: [{ name: "datum_x", value: 0.00508, sigma: 0.00254, prior: 0, prior_sigma: 0.0127, unit: "mm", observable: true },
      { name: "compliance", value: 0.4, sigma: 0.1, unit: "um/N", observable: true }],
    outlook: { now: { mean_mm: 0.0508, worst_mm: 0.0508 }, next: { mean_mm: 0.000254, mean_sigma_mm: 0.00127, worst_mm: 0.000254, worst_sigma_mm: 0.00254 }, floor_mm: 0.00254 },
    results: [{ name: "largest error", value: 0.0508, decimals: 3, unit: "mm", note: ["at s = 100.0 mm", "at s = 3.937 in"] },
      { name: "chip", value: 0.064516, decimals: 3, unit: "mm²" }, { name: "force", value: 100, decimals: 1, unit: "N" }],
    told: ["Will be 0.003 mm", "Will be 0.0001 in"], tolerance_mm: 0.0381, warnings: [["0.127 mm are left", "0.0050 in are left"], "no lengths"],
    verdict: { state: "open", text: ["within ±0.0381 mm", "within ±0.0015 in"] },
    ...more,
  };
}

test("a page of a program in inches says every figure of it in inches, to a tenth of a thousandth, errors to a hundredth", async () => {
  const { page, complaints, close } = await open(await write("inches", straight()));
  const text = async (of) => (await page.locator(of).first().textContent()).trim();
  const cells = (of) => page.locator(of).evaluateAll((all) => all.map((row) => [...row.children].map((cell) => cell.textContent)));
  assert.equal(await text(".told"),
    "Uncorrected, this wall is out of tolerance by 0.00050 in at one place; the corrected program is predicted to hold it, with more than 99 % where that is least certain.");
  assert.equal(await text(".verdict span"), "within ±0.0015 in");
  assert.deepEqual(await cells(".results > dl .result"), [["worst at any height", "0.00001 ± 0.00020 in", "0.00200 in before; 2 sigma"],
    ["mean over the height", "0.00001 ± 0.00010 in", "0.00200 in before; 2 sigma"], ["tolerance", "±0.0015 in", "held with more than 99 %"]]);
  assert.deepEqual(await cells(".all .result"), [["largest error", "0.00200 in", "at s = 3.937 in"], ["chip", "0.000100 in²"], ["force", "100.0 N"]]);
  assert.equal(await text(".all .more"), "Will be 0.0001 in");
  assert.deepEqual((await page.locator("#job dd").allTextContents()).slice(0, 6), ["T3, ⌀ 0.5 in, 4 teeth", "1.5 in", "0.4 in", "40 in/min", "6100 1/min", "0.02 in"]);
  assert.ok((await page.locator("#job dd").allTextContents()).includes("5.0000 in long"));
  assert.deepEqual(await cells("#points thead tr"), [["line", "s in", "X in", "Y in", "height in", "normal x", "normal y", "deviation in", "within ±0.0015 in", "status"]]);
  assert.deepEqual(await cells("#points tbody tr"), [["1", "1.0000", "1.0000", "−1.2500", "0.200", "0.000", "−1.000", "+0.00050", "within", "used"],
    ["2", "3.9370", "3.9370", "−1.2500", "0.200", "0.000", "−1.000", "+0.00200", "left", "used"],
    ["3", "–", "10.0000", "0.0000", "–", "–", "–", "–", "–", "set aside: 0.3543 in from the nominal wall"]]);
  assert.deepEqual(await cells("#parameters tbody tr"), [["datum x", "0.00020", "± 0.00010", "0.00000 ± 0.00050", "in", "yes"], ["compliance", "0.40", "± 0.10", "–", "µm/N", "yes"]]);
  await page.fill("#scrub", "100");
  assert.equal(await text("#readout .at"), "s 3.9370 in, X 3.9370 in, Y −1.0000 in");
  assert.equal(await text(".transport output"), "s 3.937 in · t 5.91 / 7.50 s");
  const rows = Object.fromEntries((await cells("#readout tbody tr")).map(([name, ...values]) => [name, [values[0], values.at(-1)]]));
  assert.deepEqual(rows, { "wall error": ["+0.00200", "in"], "σ of it": ["0.00010", "in"], "engagement arc": ["20.0", "°"], "chip area": ["0.000100", "in²"], force: ["100.0", "N"],
    "force x": ["+100.0", "N"], "force y": ["0.0", "N"], "deflection x": ["+0.00050", "in"], "deflection y": ["−0.00050", "in"], feed: ["40.00", "in/min"],
    "correction x": ["0.00000", "in"], "correction y": ["+0.00100", "in"] });
  assert.deepEqual(await page.locator(".trace").evaluateAll((all) => all.map((trace) => [...trace.querySelectorAll(".fold, .unit, b")].map((e) => e.textContent))), [
    ["Wall error", "in, ±2σ", "0.00200"], ["Deflection (before)", "in", "0.00050", "−0.00050"], ["Force (before)", "N", "100.0", "100.0", "0.0"],
    ["Engagement arc", "°", "20.0"], ["Chip area", "in²", "0.000100"], ["Feed", "in/min", "40.00"]]);
  assert.equal(await text(".worst-places b"), "+0.00200 in");
  assert.equal(await text(".traces .axis"), "arc length s, in");
  assert.equal(await text(".unrolled-told"), "s 3.937 in, 0.197 in above the tip: before +0.00200 in");
  assert.equal(await text("#colour-scale option"), "± 0.00200 in");
  await page.fill("#height", "2");
  assert.equal(await text("output[for=height]"), "0.197 in");
  // Under the pointer: the path, then a touched point.
  const path = await onPage(page, 60, -25.4);
  await page.mouse.move(path.x, path.y);
  const shown = await flag(page);
  assert.deepEqual([shown["error before"], shown["± σ"]], ["+0.00050 in", "0.00010 in"]);
  assert.match(shown.s, /^2\.3\d{3} in$/);
  await page.locator("#points .link").nth(1).click();
  const factor = Number(await page.locator("#magnify").inputValue());
  const point = await onPage(page, 100, -31.75 - (1 - factor) * 0.0508);
  await page.mouse.move(point.x, point.y);
  const touched = await flag(page);
  assert.deepEqual([touched.deviation, touched["X, Y"], touched.height], ["+0.00200 in", "3.9370, −1.2500 in", "0.200 in"]);
  assert.deepEqual(complaints, []);
  await close();
});

test("axes, rulers and the scale of colours are round in the unit that is said", async () => {
  const { page, close } = await open(await write("inches", straight()));
  await listen(page);
  await page.setViewportSize({ width: 1300, height: 900 });
  const numbersOn = async (of) => page.evaluate((selector) => [...globalThis.written].filter(([canvas]) => canvas.isConnected && canvas.closest(selector)).flatMap(([, all]) => all.map(({ text }) => text)), of);
  const round = (texts) => texts.filter((t) => /^[−+]?[\d.]+$/.test(t)).every((t) => /^[−+]?0*\.?0*(1|2|5|10|15|25|\d)\d?0*$/.test(t.replace(".", "")) && t.length <= 8);
  for (const [unit, steps] of [["in", ["1", "2", "3", "4"]], ["mm", ["20", "40", "60", "80", "100"]]]) {
    await settled(page);
    const picture = await numbersOn(".stage");
    assert.ok(picture.includes(`X ${unit}`) && picture.includes(`Y ${unit}`), picture.join());
    assert.ok(picture.some((text) => new RegExp(`^error [\\d.]+ (${unit}|µm)$`).test(text)), picture.join());
    const map = await numbersOn(".unrolled");
    assert.ok(map.includes(`s ${unit}`) && steps.every((step) => map.some((text) => Number(text) === Number(step))), map.join());
    const trace = await numbersOn(".trace");
    assert.ok(trace.length > 6 && round(trace), trace.join());
    await page.click("#unit");
  }
  // In 3D as on the map.
  await page.click('label[for="wall-3D"]');
  await settled(page);
  const ruler = (await numbersOn(".unrolled")).filter((text) => / in$/.test(text));
  assert.equal(ruler.length, 1, ruler.join());
  await page.click('label[for="wall-map"]');
  await close();
});

const PAGES = ["inch/correct", "inch/learn", "inch/inspect", "correct", "learn", "inspect", "simulate-plant", "demo/pocket", "plate/correct", "plate/inspect"];

for (const name of PAGES) {
  test(`${name}: one switch says every length in the other unit, and the next brings back every letter`, async () => {
    const data = await dataOf(name);
    const { page, complaints, close } = await open(await report(name));
    await listen(page);
    await page.setViewportSize({ width: 1400, height: 900 });
    const inch = (data.contours?.[0].page ?? data).unit === "in";
    assert.equal(inch, name.startsWith("inch/"));
    const before = await said(page);
    const [own, other] = inch ? [imperial, metric] : [metric, imperial];
    assert.ok(own(before).length > 20);
    assert.deepEqual(other(before), []);
    assert.equal(await page.textContent("#unit"), inch ? "mm" : "inches");
    await page.click("#unit");
    assert.equal(await page.textContent("#unit"), inch ? "inches" : "mm");
    assert.equal(await page.evaluate(() => document.activeElement.id), "unit", "who presses a key can press it again");
    const switched = await said(page);
    assert.ok(other(switched).length > 20);
    assert.deepEqual(own(switched), []);
    assert.deepEqual(await violations(page), []);
    await page.click("#unit");
    assert.deepEqual(await said(page), before);
    assert.deepEqual(complaints, []);
    await close();
  });
}

test("every deviation of a table is the one of the data in the unit of the page", async () => {
  for (const [name, factor] of [["inch/inspect", INCH], ["correct", 1]]) {
    const all = await dataOf(name);
    const data = all.contours?.[0].page ?? all;
    const { page, close } = await open(await report(name));
    if (all.contours) await page.goto(`${page.url()}#contour=${encodeURIComponent(all.contours[0].name)}`);
    const heads = await page.locator("#points thead th").allTextContents();
    const at = (start) => heads.findIndex((head) => head.startsWith(start));
    const rows = await page.locator("#points tbody tr").evaluateAll((found) => found.map((row) => [...row.children].map((cell) => cell.textContent)));
    assert.equal(rows.length, data.points.length);
    rows.forEach((row, i) => {
      for (const [head, key, decimals] of [["s ", "s_mm", factor === 1 ? 3 : 4], ["X ", "x_mm", factor === 1 ? 3 : 4], ["deviation", "error_mm", factor === 1 ? 3 : 5]]) {
        const value = data.points[i][key];
        const shown = row[at(head)];
        if (value === undefined) assert.equal(shown, "–");
        else assert.ok(Math.abs(Number(shown.replace("−", "-")) - value / factor) <= 0.5001 * 10 ** -decimals, `${name}, ${head} in row ${i}: ${shown} for ${value} mm`);
      }
    });
    await close();
  }
});

test("what the reader has chosen stays: pass, place, height, stretch, open traces, picture; and paper has the unit of the screen", async () => {
  const { page, close } = await open(await report("correct"));
  await page.click('label[for="shown-after"]');
  await page.fill("#scrub", "300");
  await page.fill("#height", "3");
  await page.click(".fold >> nth=1");
  await page.click("[aria-label='Zoom in']");
  await page.focus(".traces");
  await page.keyboard.press("+");
  const chosen = () => page.evaluate(() => [document.querySelector("[name=shown]:checked").value, document.querySelector("#scrub").value, document.querySelector("#height").value,
    document.querySelector("#magnify").value, document.querySelector(".stage:not([hidden] *)").dataset.view,
    ...[...document.querySelectorAll(".fold")].map((fold) => fold.getAttribute("aria-expanded"))].join());
  const was = await chosen();
  await page.click("#unit");
  assert.equal(await chosen(), was);
  await page.evaluate(() => window.dispatchEvent(new Event("beforeprint")));
  assert.deepEqual(metric(await said(page)), []);
  await page.evaluate(() => window.dispatchEvent(new Event("afterprint")));
  assert.deepEqual(metric(await said(page)), []);
  await page.click("#unit");
  assert.equal(await chosen(), was);
  await close();
});

test("another contour of several is in the unit that was chosen", async () => {
  const { page, close } = await open(await report("plate/correct"));
  await page.click("#unit");
  await page.click('.contour-head [aria-label="The next contour"]');
  await settled(page);
  assert.deepEqual(metric(await said(page)), []);
  await page.click('label[for="as-cut"]');
  await page.selectOption("#rank", { index: 0 });
  assert.deepEqual(metric(await said(page)), []);
  await page.evaluate(() => window.dispatchEvent(new Event("beforeprint")));
  assert.deepEqual(metric(await said(page)), []);
  await page.evaluate(() => window.dispatchEvent(new Event("afterprint")));
  await close();
});

for (const name of ["inch/learn", "inch/inspect", "plate/learn", "correct"]) {
  test(`${name} in inches fits a phone and a desk: no text over another, none cut off`, async () => {
    for (const options of [PHONE, {}]) {
      const { page, close } = await open(await report(name), options);
      await listen(page);
      if ((await page.textContent("#unit")) === "inches") await page.click("#unit");
      else for (let k = 0; k < 2; k++) await page.click("#unit");
      await settled(page);
      assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
      assert.deepEqual(await faults(page), []);
      assert.deepEqual(await violations(page), []);
      await close();
    }
  });
}

test("a deviation in inches is never rounded to the other side of its limit", async () => {
  const limits = { lower_mm: -0.0254, upper_mm: 0.0254 };
  const close_ = [0.02541, 0.0253, -0.0254].map((error_mm, i) => ({ line: i + 1, status: "used", s_mm: 10 * i, x_mm: 10 * i, y_mm: 0, nx: 0, ny: 1, error_mm, verdict: i ? "pass" : "fail" }));
  const { page, close } = await open(await write("close-inches", { version: 1, kind: "inspect", unit: "in", title: "Close", points: close_, limits, verdict: { state: "fail", text: "fail" } }));
  const column_ = await page.locator("#points tbody tr td:nth-child(8)").allTextContents();
  assert.deepEqual(column_, close_.map(({ error_mm }) => signed(error_mm, 7)));
  assert.match(await page.locator(".results").textContent(), /±0\.0010 in/);
  await close();
});
