// What the page shows is what the tables of the program hold, to the last digit.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { after, before, test } from "node:test";
import { parse } from "../samples/convert.mjs";
import { launch, onPage, open, sample, write } from "./browser.mjs";

let browser;
before(async () => { browser = await launch(); });
after(() => browser.close());

const table = async (part, file) => parse(await readFile(new URL(`../samples/raw/${part}/${file}`, import.meta.url), "utf8"));
/** The text of the page as a number, and how many decimals it shows. */
const number = (text) => Number(text.replace("−", "-").replace("+", "").replace(/[^-\d.]/g, ""));
const decimals = (text) => (/\.(\d+)/.exec(text)?.[1] ?? "").length;

for (const part of ["corner", "pocket"]) {
  test(`hovering over the ${part} gives the figures of trace.csv and correction.csv`, async () => {
    const { page, complaints, close } = await open(browser, await write(part, await sample(part)));
    const trace = await table(part, "before.csv");
    const correction = await table(part, "correction.csv");
    for (const share of [0.1, 0.35, 0.45, 0.62, 0.9]) {
      const i = Math.round(share * (trace.s_mm.length - 1));
      const at = await onPage(page, Number(trace.x_mm[i]), Number(trace.y_mm[i]));
      await page.mouse.move(at.x, at.y);
      const cells = await page.locator(".flag.shown b").allTextContents();
      const names = await page.locator(".flag.shown span").allTextContents();
      const shown = Object.fromEntries(names.map((name, k) => [name, cells[k]]));
      // The picture has a few samples a pixel: take the sample that the page names and look its row up.
      const s = number(shown.s);
      const row = correction.s_mm.findIndex((v) => Math.abs(Number(v) - s) < 1e-9);
      assert.ok(row >= 0, `${shown.s} is in the table`);
      assert.ok(Math.abs(row - i) <= 3, `sample ${row} beside the pointer at ${i}`);
      assert.equal(number(shown["error before"]), Number(trace.error_mm[row]));
      assert.ok(decimals(shown["error before"]) >= decimals(trace.error_mm[row]));
      assert.equal(number(shown["force before"]), Number(trace.force_n[row]));
      assert.equal(number(shown.arc), Number(trace.arc_deg[row]));
      const [cx, cy] = shown["correction x, y"].split(",");
      assert.equal(number(cx), Number(correction.dx_mm[row]));
      assert.equal(number(cy), Number(correction.dy_mm[row]));
      assert.equal(number(shown["± σ"]), Number(correction.sigma_mm[row]));
    }
    assert.deepEqual(complaints, []);
    await close();
  });

  test(`the figures at the cutter and beside the traces of the ${part} are those of the tables`, async () => {
    const { page, close } = await open(browser, await write(part, await sample(part)));
    const trace = await table(part, "before.csv");
    const correction = await table(part, "correction.csv");
    const names = {
      "wall error": "error_mm", "engagement arc": "arc_deg", "chip area": "chip_area_mm2", force: "force_n", "force x": "fx_n",
      "force y": "fy_n", "deflection x": "dx_mm", "deflection y": "dy_mm",
    };
    for (let i = 0; i < trace.s_mm.length; i += 97) {
      await page.fill("#scrub", String(i));
      const rows = await page.locator("#readout tbody tr").evaluateAll((all) => all.map((row) => [...row.children].map((cell) => cell.textContent)));
      for (const [name, column] of Object.entries(names)) {
        const shown = rows.find((row) => row[0] === name)[1];
        assert.equal(number(shown), Number(trace[column][i]), `${name} at ${i}`);
      }
      assert.equal(number(rows.find((row) => row[0] === "correction x")[1]), Number(correction.dx_mm[i]));
      assert.equal(number(rows.find((row) => row[0] === "correction y")[1]), Number(correction.dy_mm[i]));
      const beside = await page.locator(".trace").first().locator(".entry b").first().textContent();
      assert.equal(number(beside), Number(trace.error_mm[i]));
    }
    await close();
  });
}

test("the table of probe points holds every point with deviation, normal and status", async () => {
  const { page, close } = await open(browser, await write("pocket", await sample("pocket")));
  const points = await table("pocket", "points.csv");
  const rows = await page.locator("#points tbody tr").evaluateAll((all) => all.map((row) => [...row.children].map((cell) => cell.textContent)));
  assert.equal(rows.length, points.line.length);
  rows.forEach((row, i) => {
    assert.equal(row[0], points.line[i]);
    assert.equal(number(row[7]), Number(Number(points.error_mm[i]).toFixed(4)));
    assert.deepEqual([number(row[5]), number(row[6])], [Number(points.nx[i]), Number(points.ny[i])]);
    assert.equal(row[8], Number(points.error_mm[i]) > 0.02 ? "left" : "in");
    assert.equal(row[9], points.status[i]);
  });
  await close();
});

test("a probe point under the pointer shows its own deviation", async () => {
  const data = await sample("corner");
  const { page, close } = await open(browser, await write("corner", data));
  const factor = Number(await page.inputValue("#magnify"));
  const point = data.points[1];
  const at = await onPage(page, point.x_mm + (1 - factor) * point.error_mm * point.nx, point.y_mm + (1 - factor) * point.error_mm * point.ny);
  await page.mouse.move(at.x, at.y);
  const cells = await page.locator(".flag.shown b").allTextContents();
  assert.equal(number(cells[1]), point.error_mm);
  await close();
});
