// Where things stand on screens of several widths and on paper: nothing cut off, nothing out of line, no sheet half empty.
import assert from "node:assert/strict";
import { test } from "node:test";
import { numbers } from "./columns.mjs";
import { dataOf, open, report } from "./browser.mjs";

test("side by side both pictures stand at one height, whatever their captions say", async () => {
  for (const width of [1000, 1440]) {
    const { page, close } = await open(await report("learn"), { viewport: { width, height: 900 } });
    await page.click('label[for="shown-both"]');
    const stages = await page.locator(".stage:visible").evaluateAll((all) => all.map((stage) => [stage.getBoundingClientRect().top, stage.clientHeight]));
    assert.equal(stages.length, 2);
    assert.deepEqual(stages[0], stages[1], `${width}`);
    await close();
  }
});

test("side by side no column of an older picture is left standing", async () => {
  for (const width of [1440, 1441, 1442, 1443]) {
    const { page, close } = await open(await report("demo/pocket"), { viewport: { width, height: 900 } });
    await page.click('label[for="shown-both"]');
    await page.fill("#scrub", "620");
    await page.locator(".stage:visible").first().focus();
    for (let k = 0; k < 6; k++) await page.keyboard.press("+");
    // Inside the pocket nothing is drawn but the grid, and its lines have one colour along the edge.
    const left = await page.locator(".stage:visible").evaluateAll((all) => all.flatMap((stage) => [...stage.querySelectorAll("canvas")].map((canvas, layer) => {
      const [from, high] = [Math.round(canvas.height * 0.3), Math.round(canvas.height * 0.4)];
      const { data } = canvas.getContext("2d").getImageData(canvas.width - 1, from, 1, high);
      const drawn = (k) => (layer === 0 ? data[4 * k] < 200 || data[4 * k] - data[4 * k + 2] > 20 : data[4 * k + 3] > 0);
      return Array.from({ length: high }, (_, k) => k).filter(drawn).length;
    })));
    assert.deepEqual(left, [0, 0, 0, 0], `${width}`);
    await close();
  }
});

test("no figure of a trace and no control of the cutter is cut off in a narrow column", async () => {
  for (const width of [965, 1024, 1200]) {
    const { page, close } = await open(await report("demo/pocket"), { viewport: { width, height: 768 } });
    await page.fill("#scrub", "620");
    const cut = await page.locator(".trace-head, .transport, .bar").evaluateAll((all) => all
      .filter((e) => e.scrollHeight > e.clientHeight + 1 || e.scrollWidth > e.clientWidth + 1).map((e) => e.textContent));
    assert.deepEqual(cut, [], `${width}`);
    assert.ok((await page.locator("#scrub").boundingBox()).width > 200, `${width}: room to scrub`);
    await close();
  }
});

test("verdict and figures stand in one row and leave the first screen to the picture", async () => {
  const { page, close } = await open(await report("correct"));
  const { y, height } = await page.locator(".results").boundingBox();
  const rows = new Set(await page.locator(".results > dl .result").evaluateAll((all) => all.map((e) => e.offsetTop)));
  assert.ok(rows.size === 1 && y + height < 240, `${rows.size} rows, down to ${y + height}`);
  await close();
});

test("in a row of figures all values stand on one line, however long their names are", async () => {
  for (const width of [360, 1024, 1440]) {
    const { page, close } = await open(await report("demo/pocket"), { viewport: { width, height: 900 } });
    const lines = await page.locator(".result").evaluateAll((all) => all.map((e) => [e.offsetTop, e.querySelector("dd").offsetTop]));
    const rows = new Map(lines);
    assert.ok(rows.size > 0 && lines.every(([row, value]) => rows.get(row) === value), `${width}: ${JSON.stringify(lines)}`);
    await close();
  }
});

test("on paper the traces say where their figures are of, and have numbers on every axis", async () => {
  const { page, close } = await open(await report("demo/pocket"));
  await page.evaluate(() => {
    globalThis.written = new Map();
    const { fillText } = CanvasRenderingContext2D.prototype;
    CanvasRenderingContext2D.prototype.fillText = function kept(text, x, y) {
      const trace = [...document.querySelectorAll(".trace canvas")].indexOf(this.canvas);
      if (trace >= 0) globalThis.written.set(trace, [...(globalThis.written.get(trace) ?? []), [text, x]]);
      fillText.call(this, text, x, y);
    };
  });
  await page.fill("#scrub", "620");
  const numbersOf = await page.evaluate(async () => {
    window.dispatchEvent(new Event("beforeprint"));
    await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
    return [...globalThis.written.values()].map((all) => new Set(all.map(([text]) => text)).size);
  });
  assert.equal(numbersOf.length, 7);
  for (const count of numbersOf) assert.ok(count >= 3, `${numbersOf}`);
  assert.equal(await page.locator(".axis").evaluate((e) => getComputedStyle(e, "::before").content.replaceAll('"', "").replace("attr(data-at)", e.dataset.at)), "figures at s 61.983 mm");
  assert.ok(await page.locator(".playhead").first().isVisible());
  await page.evaluate(() => window.dispatchEvent(new Event("afterprint")));
  await close();
});

for (const name of ["correct", "demo/corner", "simulate-core"]) {
  test(`${name} on paper: the first sheet holds head, figures and the pictures`, async () => {
    const { page, close } = await open(await report(name));
    await page.evaluate(() => window.dispatchEvent(new Event("beforeprint")));
    const bottom = await page.locator(".picture").evaluate((e) => e.getBoundingClientRect().bottom - document.body.getBoundingClientRect().top);
    // Letter between its margins is 950 pixels high, A4 1017.
    assert.ok(bottom > 450 && bottom < 950, `${bottom}`);
    for (const { height } of await page.locator(".stage:visible").evaluateAll((all) => all.map((e) => e.getBoundingClientRect().toJSON()))) assert.ok(height >= 220);
    await page.evaluate(() => window.dispatchEvent(new Event("afterprint")));
    await close();
  });
}

test("one button puts the cutter at the largest error of the pass shown, and the picture shows it", async () => {
  const { contour } = await dataOf("demo/pocket");
  const { page, close } = await open(await report("demo/pocket"));
  await page.locator(".stage:visible").focus();
  for (let k = 0; k < 8; k++) await page.keyboard.press("+");
  for (const pass of ["before", "after"]) {
    await page.click(`label[for="shown-${pass}"]`);
    await page.click("#worst");
    const sizes = numbers(contour[pass].error_mm).map((e) => (Number.isFinite(e) ? Math.abs(e) : -1));
    const at = Number(await page.inputValue("#scrub"));
    assert.equal(sizes[at], Math.max(...sizes), pass);
    const [cx, cy, scale] = (await page.locator(".stage:visible").getAttribute("data-view")).split(" ").map(Number);
    const box = await page.locator(".stage:visible").boundingBox();
    assert.ok(Math.abs(numbers(contour.x_mm)[at] - cx) * scale < box.width / 2 && Math.abs(numbers(contour.y_mm)[at] - cy) * scale < box.height / 2, `${pass}: in the picture`);
  }
  await close();
});

test("the trace of the error takes the scale of the pass shown", async () => {
  const { page, close } = await open(await report("demo/pocket"));
  await page.evaluate(() => {
    globalThis.written = [];
    const { fillText } = CanvasRenderingContext2D.prototype;
    CanvasRenderingContext2D.prototype.fillText = function kept(text, x, y) {
      if (this.canvas === document.querySelector(".trace canvas")) globalThis.written.push(text);
      fillText.call(this, text, x, y);
    };
  });
  const most = async (pass) => {
    await page.click(`label[for="shown-${pass}"]`);
    return page.evaluate(async () => {
      await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
      return Math.max(...globalThis.written.splice(0).filter((text) => text.includes(".")).map(Number).filter(Number.isFinite));
    });
  };
  // Errors of 0.135 mm before and 0.009 mm after.
  assert.ok(await most("after") < 0.0101);
  assert.ok(await most("both") >= 0.1);
  assert.ok(await most("before") >= 0.1);
  await close();
});

test("the two keys that step the cutter step ten with Shift on every keyboard", async () => {
  const { page, close } = await open(await report("demo/pocket"));
  const press = (key, code) => page.locator(".stage:visible").evaluate((stage, of) => stage.dispatchEvent(new KeyboardEvent("keydown", of)), { key, code, shiftKey: true });
  for (const [key, code, place] of [[":", "Period", 10], [">", "Period", 20], [";", "Comma", 10], ["<", "Comma", 0]]) {
    await press(key, code);
    assert.equal(Number(await page.inputValue("#scrub")), place, key);
  }
  await close();
});
