// The page of a plan: one file without scripts, for everybody, on a phone, on paper, and for eyes that tell few colours apart.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { after, test } from "node:test";
import { fileURLToPath, pathToFileURL } from "node:url";
import { launch, pages, PHONE, pictures } from "./browser.mjs";
import { faults, violations } from "./checks.mjs";

const PLANS = [["plan", 1], ["plate/plan", 5]];
/** A picture of the documents loads on a phone: bytes at most. */
const SMALL = 150_000;
const documents = fileURLToPath(new URL("../../../docs/pictures/", import.meta.url));

// It has no font of its own: that of the system has to do.
let launched;
const system = () => (launched ??= launch({ system: true }));
after(async () => (await launched)?.close());

async function open(name, options = {}) {
  const context = await (await system()).newContext({ viewport: { width: 1100, height: 900 }, ...options });
  const page = await context.newPage();
  const heard = [];
  page.on("console", (message) => heard.push(message.text()));
  page.on("request", (request) => { if (!/^(file|data):/.test(request.url())) heard.push(request.url()); });
  await page.goto(pathToFileURL(`${pages}${name}/report.html`).href);
  return { page, heard, close: () => context.close() };
}

const picture = (name, kind) => `${pictures}${name.replaceAll("/", "-")}-${kind}.png`;
const summary = async (name) => JSON.parse(await readFile(`${pages}${name}/summary.json`, "utf8"));
const walls = async (name) => { const s = await summary(name); return s.contours ?? [s]; };

for (const [name, count] of PLANS) {
  test(`${name} shows every choice of every wall, breaks no rule of axe and asks for nothing`, async () => {
    const { page, heard, close } = await open(name);
    const plans = await walls(name);
    assert.equal(plans.length, count);
    assert.equal(await page.locator("table").count(), count);
    for (const [k, plan] of plans.entries()) {
      const rows = page.locator("table").nth(k).locator("tbody tr");
      assert.equal(await rows.count(), plan.choices.length);
      // The recommended choice is the one that is shown, and another is shown when it is picked.
      const shown = () => page.locator(`figure.choice[class*="wc${k + 1}-"]:visible`).evaluateAll((all) => all.map((one) => one.className.split("-").pop()));
      assert.deepEqual(await shown(), [String(plan.recommended ?? plan.choices.length)]);
      await rows.first().locator("label").first().click();
      assert.deepEqual(await shown(), ["1"]);
      const cells = await rows.first().locator("td").allTextContents();
      assert.match(cells[2], new RegExp(`^${(plan.choices[0].profile_mm * 1e3).toFixed(1)}`));
      assert.match(cells[5], plan.choices[0].within_tolerance >= plan.confidence ? /✓$/ : /✗$/, "said without a colour as well");
    }
    assert.deepEqual(await violations(page), []);
    assert.deepEqual(await faults(page), []);
    assert.deepEqual(heard, []);
    assert.equal(await page.locator("script").count(), 0);
    await page.screenshot({ path: picture(name, "light"), fullPage: true });
    await close();
  });

  test(`${name} fits a phone without scrolling sideways, and is dark where the system is`, async () => {
    const { page, close } = await open(name, { ...PHONE, colorScheme: "dark" });
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth) <= 360);
    const dark = await page.evaluate(() => getComputedStyle(document.body).backgroundColor.match(/\d+/g).map(Number));
    assert.ok(dark.every((channel) => channel < 60), `${dark}`);
    // Letters of the drawings keep a size that can be read: what is wider scrolls by itself.
    const heights = await page.locator("svg[role=img]:visible text").evaluateAll((all) => all.map((text) => text.getBoundingClientRect()).map((box) => Math.min(box.width, box.height)).filter((size) => size > 0));
    assert.ok(heights.length > 10 && Math.min(...heights) >= 5, `${Math.min(...heights)}`);
    assert.deepEqual(await violations(page), []);
    await page.screenshot({ path: picture(name, "phone"), fullPage: true });
    await close();
  });
}

test("a choice is picked with the keyboard", async () => {
  const { page, close } = await open("plan");
  const [plan] = await walls("plan");
  assert.ok(plan.choices.length > 1);
  await page.locator("input[type=radio]:checked").focus();
  await page.keyboard.press("ArrowUp");
  const before = plan.recommended ?? plan.choices.length;
  const expected = before === 1 ? plan.choices.length : before - 1;
  assert.equal(await page.locator("input[type=radio]:checked").getAttribute("id"), `c1-${expected}`);
  assert.ok(await page.locator(`.wc1-${expected}`).isVisible());
  assert.notEqual(await page.locator(`#c1-${expected}`).evaluate((input) => getComputedStyle(input).outlineStyle), "none");
  await close();
});

test("on paper the plan is dark on white, nothing is wider than the sheet, and the colours of the wall are printed", async () => {
  const { page, close } = await open("plan", { colorScheme: "dark", viewport: { width: 720, height: 1000 } });
  await page.emulateMedia({ media: "print", colorScheme: "dark" });
  const style = await page.evaluate(() => [getComputedStyle(document.body).color, getComputedStyle(document.querySelector("figure svg")).printColorAdjust]);
  assert.deepEqual(style, ["rgb(29, 37, 48)", "exact"]);
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth) <= 720);
  const pdf = await page.pdf({ format: "A4", printBackground: false });
  const sheets = pdf.toString("latin1").match(/\/Type \/Page\b/g).length;
  assert.ok(sheets >= 1 && sheets <= 3, `${sheets} sheets`);
  await close();
});

// Linear RGB as protanopes and deuteranopes see it (Machado, Oliveira, Fernandes 2009, severity 1), and as all do.
const EYES = {
  all: [1, 0, 0, 0, 1, 0, 0, 0, 1],
  protanopia: [0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998],
  deuteranopia: [0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.01182, 0.04294, 0.968881],
};
const linear = (v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
/** CIE L*a*b* of a colour of the screen, as some eyes see it. */
function lab(rgb, eyes) {
  const own = rgb.map((v) => linear(v / 255));
  const seen = [0, 3, 6].map((row) => Math.min(1, Math.max(0, eyes[row] * own[0] + eyes[row + 1] * own[1] + eyes[row + 2] * own[2])));
  const xyz = [[0.4124, 0.3576, 0.1805, 0.9505], [0.2126, 0.7152, 0.0722, 1], [0.0193, 0.1192, 0.9505, 1.089]]
    .map(([r, g, b, white]) => (r * seen[0] + g * seen[1] + b * seen[2]) / white)
    .map((v) => (v > 0.008856 ? Math.cbrt(v) : 7.787 * v + 16 / 116));
  return [116 * xyz[1] - 16, 500 * (xyz[0] - xyz[1]), 200 * (xyz[1] - xyz[2])];
}

test("the classes of the wall are told apart by every eye, in light and in dark", async () => {
  for (const colorScheme of ["light", "dark"]) {
    const { page, close } = await open("plan", { colorScheme });
    const fills = await page.locator(".legend rect").evaluateAll((all) => all.map((rect) => getComputedStyle(rect).fill.match(/\d+/g).map(Number)));
    assert.equal(fills.length, 7);
    for (const [name, eyes] of Object.entries(EYES)) {
      const seen = fills.map((fill) => lab(fill, eyes));
      seen.forEach((one, i) => seen.slice(i + 1).forEach((other, k) => {
        const apart = Math.hypot(...one.map((v, axis) => v - other[axis]));
        assert.ok(apart > 12, `${colorScheme}, ${name}: classes ${i} and ${i + k + 1} are ${apart.toFixed(1)} apart`);
      }));
    }
    await close();
  }
});

test("the picture of the documents is small", async () => {
  const { page, close } = await open("plan", { viewport: { width: 900, height: 700 } });
  const shot = await page.screenshot({ path: process.env.TRUEPATH_BLESS ? `${documents}plan-light.png` : picture("plan", "documents"), fullPage: true });
  assert.ok(shot.length < SMALL, `${shot.length} bytes`);
  await close();
});
