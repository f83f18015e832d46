// The report for a customer: verdicts that can be read without colour, what they rest on, and paper.
import assert from "node:assert/strict";
import { test } from "node:test";
import { dataOf, open, write } from "./browser.mjs";

const points = [
  { line: 1, status: "used", s_mm: 5, x_mm: 5, y_mm: 10, z_mm: 4, nx: 0, ny: 1, error_mm: 0.01, verdict: "pass" },
  { line: 2, status: "used", s_mm: 10, x_mm: 10, y_mm: 10, z_mm: 4, nx: 0, ny: 1, error_mm: 0.03, verdict: "fail" },
  { line: 3, status: "used", s_mm: 15, x_mm: 15, y_mm: 10, z_mm: 4, nx: 0, ny: 1, error_mm: -0.012, verdict: "fail" },
  { line: 4, status: "used", s_mm: 20, x_mm: 20, y_mm: 10, z_mm: 4, nx: 0, ny: 1, error_mm: 0.021, verdict: "open" },
  { line: 5, status: "aside", reason: "9.000 mm from the nominal wall", x_mm: 400, y_mm: 1 },
];
const made = {
  version: 1, kind: "inspect", title: "Inspection report: cover <3>", by: "truepath", program: { name: "cover.nc", crc32: "00c0ffee" }, points,
  part: { name: "cover <3>", drawing: null, serial: "17", customer: "Example \"Ltd\"" },
  files: [{ what: "program", name: "cover.nc", crc32: "00c0ffee" }, { what: "probe file", name: "probe.txt", crc32: "12345678" }],
  limits: { lower_mm: 0, upper_mm: 0.02, uncertainty_mm: 0.002, from: "as asked for on the command line" },
  verdict: { state: "fail", text: "fail: 2 of 4 points are outside" }, statements: ["Decision rule", "Measured places only"],
  coverage: { reach_mm: 4, length_mm: 30, stretches: [{ from_mm: 0, to_mm: 1 }, { from_mm: 24, to_mm: 30 }] },
};

test("each point of an inspection has its verdict in words and as a shape, with uneven limits", async () => {
  const { page, complaints, close } = await open(await write("inspected", made));
  const heads = await page.locator("#points thead th").allTextContents();
  const verdicts = await page.locator(`#points tbody tr td:nth-child(${heads.indexOf("verdict") + 1})`).allTextContents();
  assert.deepEqual(verdicts, ["● pass", "▲ fail, left", "▼ fail, too deep", "◆ undecided", "× not judged"]);
  const marks = await page.locator("#deviations .chart > svg path.mark").evaluateAll((all) => all.map((mark) => mark.classList[1]));
  assert.deepEqual(marks, ["within", "left", "gouge", "open"]);
  const shapes = await page.locator("#deviations .chart > svg path.mark").evaluateAll((all) => all.map((mark) => mark.getAttribute("d").replace(/[\d. -]+/g, "")));
  assert.equal(new Set(shapes.slice(0, 2)).size, 2, "a pass is round, a failure is not");
  assert.equal(await page.locator("#deviations rect.unmeasured").evaluateAll((all) => all.filter((r) => r.closest(".chart > svg")).length), 2);
  assert.deepEqual(await page.locator("#deviations .limit-text").allTextContents(), ["+0.020", "0.000"]);
  assert.match(await page.locator(".results").textContent(), /tolerance0\.000 … \+0\.020 mmuncertainty ±0\.002 mm, k = 2; as asked for on the command line/);
  assert.deepEqual(await page.locator("#statements li").allTextContents(), made.statements);
  assert.doesNotMatch(await page.locator("#keys").textContent(), /cutter|Traces/, "nothing is said of what is not there");
  assert.deepEqual(await page.locator("#part dd").allTextContents(), ["cover <3>", "17", 'Example "Ltd"', "cover.nc · CRC-32 00c0ffee", "probe.txt · CRC-32 12345678"]);
  assert.deepEqual(complaints, []);
  await close();
});

test("the wall unrolled shows at which heights it was touched and what no point speaks for", async () => {
  const heights = [1, 6, 11, 6];
  const touched = points.map((p, i) => (i < 4 ? { ...p, z_mm: heights[i] } : p));
  const layers = [
    { from_mm: 0, to_mm: 3, stretches: [{ from_mm: 9, to_mm: 30 }] },
    { from_mm: 3, to_mm: 9, stretches: [{ from_mm: 0, to_mm: 6 }, { from_mm: 24, to_mm: 30 }] },
  ];
  const coverage = { ...made.coverage, face: { depth_mm: 12, reach_mm: 3, layers } };
  const { page, complaints, close } = await open(await write("face", { ...made, points: touched, coverage }));
  const face = page.locator("#deviations svg.face");
  assert.match(await face.getAttribute("aria-label"), /^The wall unrolled, arc length by height: 4 points/);
  const box = async (of) => of.evaluateAll((all) => all.map((e) => { const r = e.getBBox(); return [r.x, r.y, r.x + r.width, r.y + r.height]; }));
  const open3 = await box(face.locator("rect.unmeasured"));
  const marks = await box(face.locator("path.mark"));
  const [[left, top, right, bottom]] = await box(face.locator("path.tick"));
  const s = (x) => ((x - left) / (right - left)) * 30;
  const z = (y) => ((bottom - y) / (bottom - top)) * 12;
  assert.deepEqual(open3.map(([x0, y0, x1, y1]) => [s(x0), s(x1), z(y1), z(y0)].map((v) => Math.round(v * 100) / 100)),
    [[9, 30, 0, 3], [0, 6, 3, 9], [24, 30, 3, 9]]);
  assert.deepEqual(marks.map(([x0, y0, x1, y1]) => [Math.round(s((x0 + x1) / 2)), Math.round(z((y0 + y1) / 2))]), [[5, 1], [10, 6], [15, 11], [20, 6]]);
  assert.match(await page.locator("#deviations .chart-key").last().textContent(), /farther than 4 mm along the contour or 3 mm in height/);
  assert.deepEqual(complaints, []);
  await close();
});

test("no deviation and no limit is rounded so far that figures and verdict contradict each other", async () => {
  const close = [{ ...points[0], error_mm: 0.02004, verdict: "fail" }, { ...points[1], error_mm: 0.019, verdict: "pass" }];
  const limits = { lower_mm: -0.02, upper_mm: 0.02 };
  const shown = async (name, changes) => {
    const { page, complaints, close } = await open(await write(name, { ...made, points: changes.points ?? made.points, limits: changes.limits }));
    const heads = await page.locator("#points thead th").allTextContents();
    const deviations = await page.locator(`#points tbody tr td:nth-child(${heads.indexOf("deviation mm") + 1})`).allTextContents();
    const head = await page.locator(".results").textContent();
    assert.deepEqual(complaints, []);
    await close();
    return { deviations, head };
  };
  assert.deepEqual((await shown("close", { points: close, limits })).deviations, ["+0.02004", "+0.01900"]);
  const clear = [close[1], { ...close[0], error_mm: 0.0201 }];
  assert.deepEqual((await shown("clear", { points: clear, limits })).deviations, ["+0.0190", "+0.0201"]);
  const odd = { lower_mm: -0.02, upper_mm: 0.02808, uncertainty_mm: 0.00001 };
  assert.match((await shown("odd-limits", { limits: odd })).head, /−0\.02000 … \+0\.02808 mmuncertainty ±0\.00001 mm/);
});

test("on paper there are lines to sign, a head and a number on every sheet, and nothing wider than the sheet", async () => {
  const many = Array.from({ length: 200 }, (_, i) => ({ ...points[i % 5], line: i + 1 }));
  const { page, complaints, close } = await open(await write("inspected-many", { ...made, points: many }));
  assert.ok(!(await page.locator(".signature").isVisible()));
  const sheets = async (format) => (await page.pdf({ format, printBackground: false })).toString("latin1").match(/\/Type \/Page\b/g).length;
  for (const format of ["A4", "Letter"]) {
    const count = await sheets(format);
    assert.ok(count >= 3 && count <= 6, `${format}: ${count} sheets`);
  }
  const rule = await page.evaluate(() => [...document.styleSheets].flatMap((s) => [...s.cssRules]).filter((r) => r instanceof CSSPageRule).map((r) => r.cssText).join(" "));
  assert.match(rule, /counter\(page\)/);
  assert.match(rule, /serial 17/);
  await page.evaluate(() => window.dispatchEvent(new Event("beforeprint")));
  assert.ok(await page.locator(".signature").isVisible());
  assert.deepEqual(await page.locator(".signature .line").allTextContents(), ["inspected by", "date", "signature"]);
  const wider = await page.evaluate(() => [...document.querySelectorAll("main *")].filter((e) => e.getBoundingClientRect().right > document.body.getBoundingClientRect().right + 1).map((e) => e.id || e.className || e.tagName));
  assert.deepEqual(wider.filter((name) => typeof name === "string" && !/hidden|flag/.test(name)), []);
  assert.equal(await page.evaluate(() => getComputedStyle(document.querySelector("#points thead")).display), "table-header-group");
  await page.evaluate(() => window.dispatchEvent(new Event("afterprint")));
  assert.ok(!(await page.locator(".signature").isVisible()));
  assert.deepEqual(complaints, []);
  await close();
});

test("the inspection that the program wrote names its files and what no point speaks for", async () => {
  const data = await dataOf("inspect");
  assert.deepEqual(data.files.map((f) => f.what), ["program", "probe file", "job"]);
  const { page, close } = await open(await write("inspect-written", data));
  assert.deepEqual(await page.locator("#statements li").allTextContents(), data.statements.map((said) => (typeof said === "string" ? said : said[0])));
  const shaded = (of) => page.locator(`${of} rect.unmeasured`).evaluateAll((all) => all.filter((r) => r.hasAttribute("x")).length);
  assert.equal(await shaded("#deviations .chart > svg:not(.face)"), data.coverage.stretches.length);
  assert.equal(await shaded("#deviations svg.face"), data.coverage.face.layers.reduce((sum, layer) => sum + layer.stretches.length, 0));
  assert.equal(await page.locator("#deviations svg.face path.mark").count(), data.points.filter((p) => p.z_mm !== undefined).length);
  await close();
});
