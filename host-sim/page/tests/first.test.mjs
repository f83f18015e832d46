// What a reader sees first: a verdict in a sentence, three figures, the next step; then where the wall is worst.
import assert from "node:assert/strict";
import { test } from "node:test";
import { dataOf, open, PHONE, plate, report, show, write } from "./browser.mjs";
import { column } from "./columns.mjs";
import { violations } from "./checks.mjs";

const told = (page) => page.locator(".told").first().textContent();
const view = async (page) => (await page.locator(".stage:visible").first().getAttribute("data-view")).split(" ").map(Number);

/** A straight pass of 100 mm with a sample every millimetre; errors before and after, mm, and their standard deviation. */
function straight(before, after, sigma, more = {}) {
  const each = (f) => column(Array.from({ length: 101 }, (_, i) => f(i)));
  const data = {
    version: 1, kind: "correct", title: "Straight", job: { wall: "right", tool: { diameter_mm: 6 }, cut: { feed_mm_per_min: 600 } },
    contour: { s_mm: each((i) => i), x_mm: each((i) => i), y_mm: each(() => 0), before: { error_mm: each(before) },
      ...(after ? { after: { error_mm: each(after), sigma_mm: each(() => sigma) } } : {}) },
    ...more,
  };
  return data;
}
/** Too much at three places, the most at s 80. */
const bumps = (i) => ({ 20: 0.04, 21: 0.035, 50: -0.03, 80: 0.05 })[i] ?? 0;
const TOLERANCE = { tolerance_mm: 0.02 };

test("the sentence says by how much and at how many places the wall is out of tolerance, and how surely the correction holds it", async () => {
  const { page, complaints, close } = await open("about:blank");
  const said = async (data) => { await show(page, await write("headline", data)); return told(page); };
  // 0.02 mm of room and a standard deviation of 0.01 mm: two deviations to both sides hold 95.45 %.
  assert.equal(await said(straight(bumps, () => 0, 0.01, TOLERANCE)),
    "Uncorrected, this wall is out of tolerance by 0.030 mm at 3 places; the corrected program is predicted to hold it, with 95 % where that is least certain.");
  assert.match(await said(straight(bumps, () => 0, 0.001, TOLERANCE)), /hold it, with more than 99 % where/);
  assert.match(await said(straight(bumps, (i) => (i === 40 ? 0.024 : 0), 0.004, TOLERANCE)), /is predicted to miss it by 0\.004 mm at one place \(held with 15 %\)\.$/);
  assert.match(await said(straight(() => 0.01, () => 0, 0.001, TOLERANCE)), /^Uncorrected, this wall is within tolerance; /);
  // Limits need not lie evenly.
  assert.match(await said(straight(bumps, () => 0, 0.001, { limits: { lower_mm: -0.05, upper_mm: 0.045 } })), /out of tolerance by 0\.005 mm at one place;/);
  assert.deepEqual(complaints, []);
  await close();
});

test("without a tolerance the sentence says mean and worst before and after with two sigma, and the floor", async () => {
  const outlook = { now: { mean_mm: 0.1352, worst_mm: 0.17 }, next: { mean_mm: 0.0091, mean_sigma_mm: 0.0011, worst_mm: 0.0353, worst_sigma_mm: 0.002 }, floor_mm: 0.0015 };
  const next = { what: "mill a new part with corrected.nc:", command: "truepath learn job.toml --probe FILE" };
  const results = Array.from({ length: 6 }, (_, i) => ({ name: `figure ${i}`, value: 0.123456, decimals: 6, unit: "mm" }));
  const { page, close } = await open(await write("headline", straight(bumps, () => 0, 0.001, { outlook, next, results })));
  assert.equal(await told(page), "Predicted with the correction: mean over the height 0.135 → 0.009 ± 0.002 mm, worst at any height 0.170 → 0.035 ± 0.004 mm (2 sigma); floor, to which machine and probe repeat: 0.002 mm (1 sigma).");
  const figures = await page.locator(".results > dl .result").evaluateAll((all) => all.map((e) => [...e.children].map((c) => c.textContent)));
  assert.deepEqual(figures, [["worst at any height", "0.035 ± 0.004 mm", "0.170 mm before; 2 sigma"], ["mean over the height", "0.009 ± 0.002 mm", "0.135 mm before; 2 sigma"],
    ["floor", "0.002 mm", "1 sigma; to which machine and probe repeat"]]);
  assert.equal(await page.locator(".next").textContent(), "Next: mill a new part with corrected.nc: truepath learn job.toml --probe FILE");
  // The rest is folded, and opens.
  assert.ok(!await page.getByText("figure 5").isVisible());
  await page.click(".all summary");
  assert.ok(await page.getByText("figure 5").isVisible());
  assert.equal(await page.locator(".all dd").first().textContent(), "0.123 mm");
  assert.deepEqual(await violations(page), []);
  await page.evaluate(() => { document.querySelector(".all").open = false; window.dispatchEvent(new Event("beforeprint")); });
  assert.ok(await page.getByText("figure 5").isVisible(), "paper has all of them");
  await page.evaluate(() => window.dispatchEvent(new Event("afterprint")));
  assert.ok(!await page.getByText("figure 5").isVisible());
  await close();
});

test("an inspection says at how many points the part is out of tolerance; several contours, how many of them", async () => {
  const point = (k, error_mm, verdict) => ({ line: k, status: "used", s_mm: k, x_mm: k, y_mm: 0, z_mm: 1, nx: 0, ny: 1, error_mm, verdict });
  const limits = { lower_mm: -0.02, upper_mm: 0.02, uncertainty_mm: 0.002 };
  const inspected = (state, points) => ({ version: 1, kind: "inspect", title: "Part", points, limits, verdict: { state, text: `${state}: as the program says` } });
  const { page, close } = await open("about:blank");
  for (const [state, points, text] of [
    ["fail", [point(1, 0.03, "fail"), point(2, -0.05, "fail"), point(3, 0, "pass")], "This wall is out of tolerance by 0.030 mm at 2 of 3 measured points."],
    ["pass", [point(1, 0.01, "pass"), point(2, 0, "pass")], "This wall is within tolerance at all 2 measured points."],
    ["open", [point(1, 0.0195, "open"), point(2, 0, "pass")], "Not decided: 1 of 2 measured points lie closer to a limit than the uncertainty."],
  ]) {
    await show(page, await write("headline", inspected(state, points)));
    assert.equal(await told(page), text);
  }
  await close();
  for (const kind of ["correct", "inspect"]) {
    const data = await plate(kind);
    const misses = ({ page: { verdict, outlook, tolerance_mm: half } }) => verdict?.state === "fail" || outlook?.next?.worst_mm > half;
    const failed = data.contours.filter(misses).length;
    const { page: all, close: done } = await open(await write("headline-several", data));
    assert.ok(failed > 0 && failed < 5, `${failed}`);
    assert.match(await told(all), new RegExp(`^${failed} of 5 contours are ${kind === "correct" ? "predicted to miss their tolerance" : "out of tolerance"}`));
    await done();
  }
});

test("no figure of any page has more than a hundredth of a micrometre, none but deviations beside a limit more than a micrometre", async () => {
  for (const name of ["demo/pocket", "simulate-plant", "correct", "learn", "inspect"]) {
    const { page, close } = await open(await report(name));
    if (await page.locator("#shown-both").count()) await page.click('label[for="shown-both"]');
    await page.evaluate(() => { for (let fold; (fold = document.querySelector('.fold[aria-expanded="false"]')); ) fold.click(); });
    const figures = await page.evaluate(() => [...document.querySelectorAll(".results, .scenes, .traces, #readout, #points, #unrolled, .worst-places, .transport")]
      .flatMap((e) => e.innerText.match(/\d+\.\d{4,}/g) ?? []));
    assert.deepEqual(figures.filter((text) => name !== "inspect" || /\.\d{6,}/.test(text)), [], name);
    await close();
  }
});

test("a button for each of the worst places puts the cutter there and its wall in the middle; zooming goes to it", async () => {
  const { page, complaints, close } = await open(await write("worst", straight(bumps, () => 0, 0.01, TOLERANCE)));
  const buttons = page.locator(".worst-places button");
  assert.deepEqual(await buttons.allTextContents(), ["+0.050 mm left, s 80.0 mm", "+0.040 mm left, s 20.0 mm", "−0.030 mm too deep, s 50.0 mm"]);
  for (const [k, x] of [80, 20, 50].entries()) {
    await buttons.nth(k).click();
    assert.equal(await page.inputValue("#scrub"), String(x));
    // Wall right of travel along X: three millimetres below the path.
    const [cx, cy] = await view(page);
    assert.ok(Math.abs(cx - x) < 1e-6 && Math.abs(cy + 3) < 1e-6, `${cx} ${cy}`);
  }
  await page.getByRole("button", { name: "whole" }).click();
  await page.click("#worst");
  const zoom = page.getByRole("button", { name: "Zoom in" });
  for (let k = 0; k < 6; k++) await zoom.click();
  const [cx, cy] = await view(page);
  assert.ok(Math.abs(cx - 80) < 1e-6 && Math.abs(cy + 3) < 1e-6, "still at the place");
  const middle = await page.locator(".stage:visible canvas").first().evaluate((canvas) => [...canvas.getContext("2d").getImageData(canvas.width >> 1, canvas.height >> 1, 1, 1).data]);
  assert.ok(middle[0] < 90, `the line of the wall is in the middle: ${middle}`);
  assert.deepEqual(await violations(page), []);
  assert.deepEqual(complaints, []);
  await close();
});

test("a worst place at a height shows that height", async () => {
  const { page, close } = await open(await report("demo/pocket"));
  const { heights } = await dataOf("demo/pocket");
  const button = page.locator(".worst-places button").first();
  const z = Number(/, ([\d.]+) mm above the tip/.exec(await button.textContent())[1]);
  await button.click();
  const shown = heights.z_mm[Number(await page.inputValue("#height")) - 1];
  assert.ok(Math.abs(shown - z) <= 0.051, `${shown} for ${z}`);
  await close();
});

test("the wheel scrolls the page over the picture, and zooms with Ctrl or when the picture is chosen", async () => {
  const { page, close } = await open(await report("demo/pocket"), { viewport: { width: 1440, height: 700 } });
  const box = await page.locator(".stage:visible").boundingBox();
  await page.mouse.move(box.x + 100, box.y + 100);
  const before = await view(page);
  await page.mouse.wheel(0, 200);
  await page.waitForFunction(() => scrollY > 100);
  assert.deepEqual(await view(page), before);
  await page.keyboard.down("Control");
  await page.mouse.wheel(0, -200);
  await page.waitForFunction((scale) => Number(document.querySelector(".stage").dataset.view.split(" ")[2]) > scale, before[2]);
  await page.keyboard.up("Control");
  await page.evaluate(() => scrollTo(0, 0));
  await page.locator(".stage:visible").focus();
  const [zoomed, scrolled] = [await view(page), await page.evaluate(() => scrollY)];
  await page.mouse.wheel(0, -200);
  await page.waitForFunction((scale) => Number(document.querySelector(".stage").dataset.view.split(" ")[2]) > scale, zoomed[2]);
  assert.equal(await page.evaluate(() => scrollY), scrolled);
  await close();
});

test("before shows nothing of after: no curve, no key, no column, no correction", async () => {
  const { page, close } = await open(await report("demo/pocket"));
  const seen = () => page.evaluate(() => [".trace", ".legend", "#readout", ".scene figcaption"].map((of) => [...document.querySelectorAll(of)].filter((e) => e.checkVisibility()).map((e) => e.innerText).join(" ")).join(" "));
  assert.doesNotMatch(await seen(), /after|commanded|[Cc]orrection(?! )|correction x/);
  await page.click('label[for="shown-after"]');
  assert.match(await seen(), /after.*commanded|commanded.*after/s);
  assert.doesNotMatch(await seen(), /actual path before/);
  await page.click('label[for="shown-both"]');
  assert.match(await seen(), /actual path before/);
  assert.match(await seen(), /actual path after/);
  await close();
});

test("one trace is open, the others are folded with their figures, and each opens and folds again", async () => {
  const { page, close } = await open(await report("demo/pocket"));
  const folds = page.locator(".fold");
  assert.equal(await page.locator(".u-over").count(), 1);
  assert.equal(await folds.first().getAttribute("aria-expanded"), "true");
  assert.ok(await folds.count() > 4);
  const force = page.locator(".trace", { hasText: "Force" });
  assert.match(await force.locator(".entry b").first().textContent(), /^[−\d.]+$/);
  await force.locator(".fold").focus();
  await page.keyboard.press("Enter");
  assert.equal(await page.locator(".u-over").count(), 2);
  assert.ok(await page.evaluate(() => document.activeElement.matches('.fold[aria-expanded="true"]') && document.activeElement.textContent.startsWith("Force")), "the focus stays");
  await page.click('label[for="shown-after"]');
  assert.equal(await page.locator(".u-over").count(), 2, "what is open stays open");
  await force.locator(".fold").click();
  assert.equal(await page.locator(".u-over").count(), 1);
  await close();
});

test("on a phone the picture comes right after the verdict", async () => {
  const { page, close } = await open(await report("demo/pocket"), PHONE);
  const top = (of) => page.locator(of).first().evaluate((e) => e.getBoundingClientRect().top + scrollY);
  const stage = await page.locator(".stage:visible").first().boundingBox();
  assert.ok(stage.y < 400, `the picture begins at ${stage.y}`);
  assert.ok(await top(".told") < stage.y && await top(".results dl") > stage.y && await top(".bar") > stage.y);
  assert.deepEqual(await violations(page), []);
  await close();
});

test("on paper the deviation of every probe point stands in the picture", async () => {
  const data = await dataOf("correct");
  const { page, close } = await open(await write("paper-labels", data));
  await page.evaluate(() => {
    globalThis.texts = [];
    const { fillText } = CanvasRenderingContext2D.prototype;
    CanvasRenderingContext2D.prototype.fillText = function kept(text, ...rest) { if (this.canvas.closest(".stage")) globalThis.texts.push(text); fillText.call(this, text, ...rest); };
  });
  const texts = await page.evaluate(() => { window.dispatchEvent(new Event("beforeprint")); globalThis.texts = []; document.querySelector("#layer-band").click(); return globalThis.texts; });
  const written = texts.filter((text) => /^[+−]?\d\.\d{3}$/.test(text));
  const used = data.points.filter((p) => p.error_mm !== undefined);
  assert.equal(written.length, used.length, `${written}`);
  await page.evaluate(() => window.dispatchEvent(new Event("afterprint")));
  await close();
});
