// Each command sends what it has; what is wrong with the data is said by name.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { column } from "../samples/convert.mjs";
import { launch, open, out, sample, write } from "./browser.mjs";

let browser;
before(async () => { browser = await launch(); });
after(() => browser.close());

async function opened(name, data) {
  const report = await open(browser, await write(name, data));
  assert.deepEqual(report.complaints, []);
  assert.deepEqual(report.requests, []);
  return report;
}

test("a simulated pass has no after, no correction and no choice between passes", async () => {
  const data = await sample("corner");
  const { s_mm, x_mm, y_mm, before: pass } = data.contour;
  const { page, close } = await opened("simulate", { version: 1, kind: "simulate", title: "A pass", job: data.job, contour: { s_mm, x_mm, y_mm, before: pass } });
  assert.equal(await page.locator(".segments").count(), 0);
  assert.equal(await page.locator(".trace").count(), 5);
  assert.equal(await page.locator("#points").count(), 0);
  await close();
});

test("an inspection shows wall, points and verdict, and no cutter", async () => {
  const data = await sample("pocket");
  const { s_mm, x_mm, y_mm } = data.contour;
  const points = data.points.map((p, i) => (i === 4 ? { ...p, status: "aside", reason: "beside the wall" } : p));
  const { page, close } = await opened("inspect", {
    version: 1, kind: "inspect", title: "Pocket, part 17", by: data.by, program: data.program, job: data.job, contour: { s_mm, x_mm, y_mm }, points,
    tolerance_mm: 0.05, verdict: { state: "fail", text: "largest deviation 0.0790 mm" },
    results: [{ name: "largest deviation", value: 0.078989, decimals: 4, unit: "mm" }],
  });
  assert.equal(await page.locator("#play").count(), 0);
  assert.equal(await page.locator(".verdict.fail strong").textContent(), "out of tolerance");
  assert.match(await page.locator("#points h2").textContent(), /used 14, set aside 1/);
  assert.match(await page.locator("#points tbody tr").nth(4).textContent(), /set aside: beside the wall/);
  await page.screenshot({ path: `${out}inspect.png`, fullPage: true });
  await close();
});

test("points alone, a wall as an outline alone, and nothing but a title are shown as they are", async () => {
  const { points } = await sample("corner");
  const wall = [{ x_mm: column(["0", "10", "10"]), y_mm: column(["0", "0", "10"]) }];
  const few = [{ points }, { outlines: { wall } }, {}];
  for (const [i, part] of few.entries()) {
    const { page, close } = await opened(`few-${i}`, { version: 1, kind: "inspect", title: "Little", ...part });
    assert.equal(await page.locator("h1").textContent(), "Little");
    assert.equal(await page.locator(".stage:visible").count(), i < 2 ? 1 : 0);
    await close();
  }
});

test("every column of a pass may be missing", async () => {
  const data = await sample("corner");
  for (const name of Object.keys(data.contour.before).filter((key) => key !== "label")) {
    const contour = structuredClone(data.contour);
    delete contour.before[name];
    delete contour.after[name];
    const { close } = await opened("missing", { ...data, contour });
    await close();
  }
});

test("missing values leave gaps", async () => {
  const data = await sample("corner");
  const error = Array.from({ length: 1040 }, (_, i) => (i > 300 && i < 400 ? "" : "0.1"));
  data.contour.before.error_mm = column(error);
  const { page, complaints, close } = await opened("gaps", data);
  await page.fill("#scrub", "350");
  assert.match(await page.locator("#readout tbody tr").first().textContent(), /–/);
  assert.deepEqual(complaints, []);
  await close();
});

test("the page without data, of another version, or with a column too short says so", async () => {
  const data = await sample("corner");
  const short = structuredClone(data);
  short.contour.before.force_n = column(["1", "2"]);
  for (const [content, text] of [
    [null, /holds no data yet/], [{ ...data, version: 2 }, /Data of version 2; this page reads version 1/],
    [short, /before\.force_n: 2 values, expected 1040/],
  ]) {
    const { page, close } = await opened("wrong", content);
    assert.match(await page.locator("[role=alert]").textContent(), text);
    await close();
  }
});

test("text in the data stays text", async () => {
  const data = await sample("corner");
  data.title = "</script><img src=x onerror=alert(1)>";
  data.warnings = ["<b>not bold</b>"];
  const { page, close } = await opened("text", data);
  assert.equal(await page.locator("h1").textContent(), data.title);
  assert.equal(await page.locator("img, .warnings b").count(), 0);
  await close();
});
