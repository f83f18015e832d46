// Part after part: the uncorrected one, the one that was measured as it was milled, and the next; and programs with several cuts.
import assert from "node:assert/strict";
import { test } from "node:test";
import { dataOf, open, PHONE, pictures, report, show, table, write } from "./browser.mjs";
import { thinned } from "./columns.mjs";

/** A length of a table as the page shows it. */
const micrometres = (text) => Number(Number(text).toFixed(3)) || 0;
const captions = (page) => page.locator(".scene:visible figcaption").allTextContents();
const curves = (page) => page.locator(".trace").first().locator(".entry span").allTextContents();

test("a page of learn opens with the part that was milled, beside the next one on demand", async () => {
  const { page, complaints, close } = await open(await report("learn"));
  const choices = await page.locator(".picture .segments label").allTextContents();
  assert.deepEqual(choices, ["uncorrected", "part 2", "part 3", "side by side"]);
  assert.match((await captions(page)).join(), /^part 2: as milled with its correction, by the model of all parts/);
  assert.deepEqual(await curves(page), ["part 2"], "nothing of a pass that is not shown");
  await page.click('label[for="shown-both"]');
  assert.deepEqual(await curves(page), ["part 2", "part 3"]);
  const [left, right] = await captions(page);
  assert.ok(left.startsWith("part 2: as milled") && right.startsWith("part 3: the next one"), `${left} | ${right}`);
  const compared = Number(await page.inputValue("#magnify"));
  await page.click('label[for="shown-before"]');
  assert.match((await captions(page)).join(), /^uncorrected: along the path of the program/);
  assert.deepEqual(await curves(page), ["uncorrected"]);
  assert.ok(Number(await page.inputValue("#magnify")) < compared, "its errors are far larger");
  await page.click('label[for="shown-milled"]');
  assert.equal(Number(await page.inputValue("#magnify")), compared);
  // A factor that was chosen stays.
  await page.selectOption("#magnify", "20");
  await page.click('label[for="shown-before"]');
  assert.equal(await page.inputValue("#magnify"), "20");
  await page.screenshot({ path: `${pictures}learn.png` });
  assert.deepEqual(complaints, []);
  await close();
});

test("every pass has its own correction, and the points are those of the part that was milled", async () => {
  const [milled, next] = [await table("learn/milled.csv"), await table("learn/correction.csv")];
  const { page, close } = await open(await report("learn"));
  const row = (name) => page.locator("#readout tbody tr", { hasText: name }).locator("td").allTextContents();
  const value = (text) => Number(text.replace("−", "-").replace("+", ""));
  for (const i of [7, 400, 1203, 2500]) {
    await page.fill("#scrub", String(i));
    for (const [name, column] of [["correction x", "dx_mm"], ["correction y", "dy_mm"]]) {
      const cells = await row(name);
      assert.deepEqual([cells.length, cells[0], value(cells[1]) || 0, value(cells[2]) || 0], [3, "–", micrometres(milled[column][i]), micrometres(next[column][i])]);
    }
    const errors = (await row("wall error")).map((text) => value(text) || 0);
    assert.deepEqual(errors, [next.predicted_error_before_mm[i], milled.predicted_error_after_mm[i], next.predicted_error_after_mm[i]].map(micrometres));
  }
  const title = () => page.locator(".trace h2").nth(1).textContent();
  assert.equal(await title(), "Correction (part 2)");
  await page.click('label[for="shown-after"]');
  assert.equal(await title(), "Correction (part 3)");
  // Chosen in the table, a point is shown beside the pass that it was touched on.
  await page.getByRole("button", { name: /^Show probe point/ }).first().click();
  assert.ok(await page.isChecked("#shown-milled"));
  await close();
});

test("three columns of figures and four choices fit a phone and a desk", async () => {
  for (const options of [PHONE, {}, { viewport: { width: 1000, height: 700 } }]) {
    const { page, close } = await open(await report("learn"), options);
    await page.fill("#scrub", "1203");
    const wide = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
    assert.equal(wide, 0, "no sideways scrolling");
    const beyond = await page.locator("#readout").evaluate((card) => card.querySelector("table").getBoundingClientRect().right - card.getBoundingClientRect().right);
    assert.ok(beyond <= 0, `${beyond} px beyond the card`);
    await close();
  }
});

test("a pass of three without some of its columns leaves the others as they are", async () => {
  const data = await dataOf("learn");
  const whole = thinned(data.contour, 20);
  delete data.heights;
  const { page, complaints, close } = await open("about:blank");
  for (const name of Object.keys(whole.milled)) {
    const contour = structuredClone(whole);
    delete contour.milled[name];
    await show(page, await write("milled-less", { ...data, contour }));
    assert.equal(await page.locator("[role=alert]").count(), 0, name);
    assert.deepEqual(complaints, [], name);
  }
  await close();
});

test("of a program with several cuts the page says which one it shows and what became of the others", async () => {
  const data = await dataOf("learn");
  const cut = (first_line, became, more) => ({ role: "finish", contour: 1, level: 1, first_line, last_line: first_line + 8, tool: 3,
    z_mm: -6, length_mm: 154.85, closed: true, why: "no other run takes its wall away", became, ...more });
  data.program = {
    ...data.program, shown: "the finishing contour, pass 1 of 2, Z -6 mm, lines 71-79", why: "the only path of tool 3", other_features: ["boss"],
    cuts: [cut(28, "unchanged", { role: "semi", tool: null, z_mm: null, closed: false }), cut(71, "shown"), cut(86, "corrected", { z_mm: -12 })], cuts_left_out: 4,
  };
  const { page, complaints, close } = await open(await write("cuts", data));
  assert.match(await page.locator(".source").textContent(), /the finishing contour, pass 1 of 2, Z -6 mm, lines 71-79/);
  assert.equal(await page.locator("#program h2").textContent(), "Cuts of the program: 7");
  const rows = await page.locator("#program tbody tr").evaluateAll((all) => all.map((row) => [...row.children].map((cell) => cell.textContent)));
  assert.deepEqual(rows.map((row) => row.slice(0, 4)), [["28–36", "semi", "–", "–"], ["71–79", "finish", "T3", "−6.000"], ["86–94", "finish", "T3", "−12.000"]]);
  assert.deepEqual(rows.map((row) => row.slice(5, 7)), [["open", "stays as it is"], ["closed", "this page"], ["closed", "same correction"]]);
  const words = await page.locator("#program").textContent();
  assert.ok(words.includes("boss") && words.includes("4 more cuts are in summary.json"));
  assert.deepEqual(complaints, []);
  await close();
});
