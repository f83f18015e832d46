// What the page shows is what the tables of the same run hold: lengths to a micrometre, angles to a tenth of a degree.
import assert from "node:assert/strict";
import { test } from "node:test";
import { dataOf, flag, onPage, open, report, table } from "./browser.mjs";

/** The text of the page as a number, and how many decimals it shows. */
const number = (text) => (text.trim() === "–" ? NaN : Number(text.replace("−", "-").replace("+", "").replace(/[^-\d.]/g, "")));
const decimals = (text) => (/\.(\d+)/.exec(text)?.[1] ?? "").length;

/** The number shown is that of the table, rounded once; no number in the one is none in the other. */
function same(shown, text, what) {
  assert.ok(shown !== undefined, `${what} is shown`);
  if (text === "" || text === undefined) {
    assert.ok(Number.isNaN(number(shown)), what);
    return;
  }
  // A standard deviation that is not nought is not shown as nought.
  if (shown.trim().startsWith("<")) {
    assert.ok(Number(text) > 0 && Number(text) < 0.0005, `${what}: ${shown} for ${text}`);
    return;
  }
  const places = decimals(shown);
  assert.ok(places === 1 || places === 3, `${what}: ${shown} to a micrometre or to a tenth`);
  assert.ok(Math.abs(number(shown) - Number(text)) <= 0.5001 * 10 ** -places, `${what}: ${shown} for ${text}`);
}

/** Hovers over places of the wanted path; calls back with the figures shown and the row of the table they belong to. */
async function hovered(page, rows, check) {
  for (const share of [0.1, 0.35, 0.45, 0.62, 0.9]) {
    let i = Math.round(share * (rows.s_mm.length - 1));
    let shown;
    do {
      const at = await onPage(page, Number(rows.x_mm[i]), Number(rows.y_mm[i]));
      await page.mouse.move(at.x, at.y);
      shown = await flag(page);
      // Enlarged, a probe point may stand where the path is; under the pointer it goes first.
    } while ("probe point" in shown && (i += 8) < rows.s_mm.length);
    // A pixel holds a few samples: take the one that the page names and look its row up.
    assert.ok(shown.s !== undefined, `figures are shown at the pointer beside row ${i}: ${JSON.stringify(shown)}`);
    const s = number(shown.s);
    const row = rows.s_mm.findIndex((v, k) => Math.abs(Number(v) - s) < 5.1e-4 && Math.abs(k - i) < 5);
    assert.ok(row >= 0, `${shown.s} is in the table, beside row ${i}`);
    check(shown, row);
  }
}

/** The figures in words and digits at the cutter, by name: one for each pass. */
async function readout(page) {
  const rows = await page.locator("#readout tbody tr").evaluateAll((all) => all.map((row) => [...row.children].map((cell) => cell.textContent)));
  // Beside three passes the unit stands with the name.
  return Object.fromEntries(rows.map(([name, ...cells]) => [name.replace(/ (mm|mm²|mm\/min|N|°)$/, ""), cells]));
}

const QUANTITIES = {
  "wall error": "error_mm", "engagement arc": "arc_deg", "chip area": "chip_area_mm2", force: "force_n", "force x": "fx_n",
  "force y": "fy_n", "deflection x": "dx_mm", "deflection y": "dy_mm",
};

for (const name of ["simulate-core", "simulate-plant", "island"]) {
  test(`${name}: pointer, figures at the cutter and traces show trace.csv`, async () => {
    const trace = await table(`${name}/trace.csv`);
    const { page, complaints, close } = await open(await report(name));
    await hovered(page, trace, (shown, row) => {
      same(shown.error, trace.error_mm[row], `error in row ${row}`);
      same(shown.force, trace.force_n[row], `force in row ${row}`);
      same(shown.arc, trace.arc_deg[row], `arc in row ${row}`);
    });
    for (let i = 3; i < trace.s_mm.length; i += 197) {
      await page.fill("#scrub", String(i));
      const shown = await readout(page);
      for (const [title, quantity] of Object.entries(QUANTITIES)) same(shown[title][0], trace[quantity][i], `${title} in row ${i}`);
      const beside = await page.locator(".trace .entry b").first().textContent();
      same(beside, trace.error_mm[i], `error beside its trace in row ${i}`);
      const at = await page.locator("#readout .at").textContent();
      for (const [letter, quantity] of [["s", "s_mm"], ["X", "x_mm"], ["Y", "y_mm"]]) {
        same(new RegExp(`${letter} (\\S+) mm`).exec(at)[1], trace[quantity][i], `${letter} in row ${i}`);
      }
    }
    assert.deepEqual(complaints, []);
    await close();
  });
}

/** What the passes of a page are called under the pointer, and the columns at the cutter that show correction.csv. */
const CALLED = { correct: [" before", " after", 0, 1, 0], learn: [", uncorrected", ", part 3", 0, 2, 2] };

for (const [name, [before, after, first, last, own]] of Object.entries(CALLED)) {
  test(`${name}: pointer and figures at the cutter show correction.csv`, async () => {
    const rows = await table(`${name}/correction.csv`);
    const { page, complaints, close } = await open(await report(name));
    await page.click('label[for="shown-before"]');
    await hovered(page, rows, (shown, row) => {
      same(shown[`error${before}`], rows.predicted_error_before_mm[row], `error before in row ${row}`);
      assert.deepEqual(Object.keys(shown).filter((key) => key.endsWith(after) || key.startsWith("correction")), [], "nothing of the pass after");
    });
    await page.click('label[for="shown-after"]');
    await hovered(page, rows, (shown, row) => {
      same(shown[`error${after}`], rows.predicted_error_after_mm[row], `error after in row ${row}`);
      same(shown["± σ"], rows.sigma_mm[row], `sigma in row ${row}`);
      const [cx, cy] = (shown["correction x, y"] ?? shown[`correction${after}`]).split(",");
      same(cx, rows.dx_mm[row], `correction x in row ${row}`);
      same(cy, rows.dy_mm[row], `correction y in row ${row}`);
    });
    for (let i = 5; i < rows.s_mm.length; i += 211) {
      await page.fill("#scrub", String(i));
      const shown = await readout(page);
      same(shown["wall error"][first], rows.predicted_error_before_mm[i], `error before in row ${i}`);
      same(shown["wall error"][last], rows.predicted_error_after_mm[i], `error after in row ${i}`);
      same(shown["correction x"][own], rows.dx_mm[i], `correction x in row ${i}`);
      same(shown["correction y"][own], rows.dy_mm[i], `correction y in row ${i}`);
    }
    assert.deepEqual(complaints, []);
    await close();
  });
}

for (const name of ["correct", "inspect"]) {
  test(`${name}: the table of probe points holds every line of points.csv`, async () => {
    const { page, close } = await open(await report(name));
    const points = await table(`${name}/points.csv`);
    const heads = await page.locator("#points thead th").allTextContents();
    const rows = await page.locator("#points tbody tr").evaluateAll((all) => all.map((row) => [...row.children].map((cell) => cell.textContent)));
    assert.equal(rows.length, points.line.length);
    const cell = (row, title) => row[heads.findIndex((head) => head.startsWith(title))];
    const lines = [];
    for (const row of rows) {
      const i = points.line.indexOf(cell(row, "line"));
      lines.push(i);
      const error = Number(points.error_mm[i]);
      assert.ok(Math.abs(number(cell(row, "deviation")) - error) <= 0.5001e-3, `deviation of line ${points.line[i]}`);
      assert.ok(Math.abs(number(cell(row, "normal x")) - Number(points.nx[i])) <= 0.5001e-3);
      assert.ok(Math.abs(number(cell(row, "normal y")) - Number(points.ny[i])) <= 0.5001e-3);
      assert.ok(cell(row, "status").startsWith(points.status[i] === "used" ? "used" : "set aside"), points.status[i]);
    }
    assert.equal(new Set(lines).size, points.line.length, "every line once");
    await close();
  });
}

test("a probe point under the pointer shows its own deviation", async () => {
  const { points } = await dataOf("correct");
  const { page, close } = await open(await report("correct"));
  const factor = Number(await page.inputValue("#magnify"));
  const point = points[1];
  const at = await onPage(page, point.x_mm + (1 - factor) * point.error_mm * point.nx, point.y_mm + (1 - factor) * point.error_mm * point.ny);
  await page.mouse.move(at.x, at.y);
  const shown = await flag(page);
  assert.ok(Math.abs(number(shown.deviation) - point.error_mm) <= 0.5001e-3);
  await close();
});
