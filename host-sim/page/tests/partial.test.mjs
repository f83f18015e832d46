// Each command sends what it has; what is wrong with the data is said by name.
import assert from "node:assert/strict";
import { test } from "node:test";
import { column, thinned } from "./columns.mjs";
import { dataOf, open, show, write } from "./browser.mjs";

async function opened(name, data) {
  const report = await open(await write(name, data));
  assert.deepEqual(report.complaints, []);
  assert.deepEqual(report.requests, []);
  return report;
}

test("points alone, a wall as an outline alone, and nothing but a title are shown as they are", async () => {
  const { points } = await dataOf("demo/corner");
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
  const data = await dataOf("demo/corner");
  data.contour = thinned(data.contour, 20);
  delete data.heights;
  const { page, complaints, requests, close } = await opened("missing", data);
  for (const name of Object.keys(data.contour.before).filter((key) => key !== "label")) {
    const contour = structuredClone(data.contour);
    delete contour.before[name];
    delete contour.after[name];
    await show(page, await write("missing", { ...data, contour }));
    assert.equal(await page.locator("[role=alert]").count(), 0, name);
  }
  assert.deepEqual([complaints, requests], [[], []]);
  await close();
});

test("missing values leave gaps", async () => {
  const data = await dataOf("demo/corner");
  const error = Array.from({ length: 1040 }, (_, i) => (i > 300 && i < 400 ? "" : "0.1"));
  data.contour.before.error_mm = column(error);
  const { page, complaints, close } = await opened("gaps", data);
  await page.fill("#scrub", "350");
  assert.match(await page.locator("#readout tbody tr").first().textContent(), /–/);
  assert.deepEqual(complaints, []);
  await close();
});

test("the page without data, of another version, or with a column too short says so", async () => {
  const data = await dataOf("demo/corner");
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
  const data = await dataOf("demo/corner");
  data.title = "</script><img src=x onerror=alert(1)>";
  data.warnings = ["<b>not bold</b>"];
  const { page, close } = await opened("text", data);
  assert.equal(await page.locator("h1").textContent(), data.title);
  assert.equal(await page.locator("img, .warnings b").count(), 0);
  await close();
});
