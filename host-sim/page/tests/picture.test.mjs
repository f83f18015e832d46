// The pictures look as they did: compared with tests/reference. TRUEPATH_BLESS=1 renews them and those of the README.
//
// Letters come out a little different on every system, so that no pixel is compared. Both pictures are made small, to cells
// of some 30 × 28 pixels: in such a cell another rendering of the same letters changes the mean grey by some percent, of a
// line by a few. A layer missing, another colour, a curve or a control elsewhere changes tens of cells by more. So two limits: the mean of
// all differences, which a shift of everything breaks, and the largest one of any cell, which a block missing breaks.
import assert from "node:assert/strict";
import { mkdir, readFile, writeFile } from "node:fs/promises";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { browser, open, PHONE, pictures, report } from "./browser.mjs";

const reference = fileURLToPath(new URL("reference/", import.meta.url));
const readme = fileURLToPath(new URL("../../../docs/pictures/", import.meta.url));
const MEAN = 0.012;
const LARGEST = 0.3;
/** A picture in the README loads on a phone: bytes at most. */
const README = 200_000;
const SIZE = { viewport: { width: 1440, height: 900 } };
/** Page, name, browser, pass shown, place of the cutter, whether the README shows it. */
const VIEWS = [
  ["demo/corner", "light", SIZE, "before", 480, true], ["demo/corner", "side-by-side", SIZE, "both", 430],
  ["demo/pocket", "light", SIZE, "before", 560], ["demo/pocket", "both", SIZE, "both", 560, true], ["demo/pocket", "dark", { ...SIZE, colorScheme: "dark" }, "both", 560],
  ["demo/pocket", "phone", PHONE, "after", 560], ["island", "light", SIZE, null, 1500], ["inspect", "light", SIZE, null, null],
];

/** Mean and largest difference of two pictures over a grid of 48 × 32 cells, 0…1; 1 where the sizes differ. */
async function difference(page, one, other) {
  return page.evaluate(async (sources) => {
    const images = await Promise.all(sources.map(async (source) => createImageBitmap(await (await fetch(`data:image/png;base64,${source}`)).blob())));
    if (images[0].width !== images[1].width || images[0].height !== images[1].height) return { mean: 1, largest: 1 };
    const cells = images.map((image) => {
      let from = image;
      // Halved again and again: every pixel counts.
      for (let { width, height } = image; width > 48 || height > 32;) {
        [width, height] = [Math.max(48, Math.ceil(width / 2)), Math.max(32, Math.ceil(height / 2))];
        const next = new OffscreenCanvas(width, height);
        next.getContext("2d").drawImage(from, 0, 0, width, height);
        from = next;
      }
      return from.getContext("2d").getImageData(0, 0, 48, 32).data;
    });
    const apart = Array.from(cells[0], (v, i) => Math.abs(v - cells[1][i]) / 255);
    return { mean: apart.reduce((sum, v) => sum + v, 0) / apart.length, largest: Math.max(...apart) };
  }, [one.toString("base64"), other.toString("base64")]);
}

/** A blank page that may read pictures given to it. */
async function comparer() {
  const page = await (await browser()).newPage();
  await page.goto("about:blank");
  return page;
}

async function shot(page, [, , , shown, place]) {
  if (shown) await page.click(`label[for="shown-${shown}"]`);
  if (place !== null) await page.fill("#scrub", String(place));
  await page.evaluate(() => { document.activeElement.blur(); window.scrollTo(0, 0); });
  await page.mouse.move(0, 0);
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  return page.screenshot();
}

for (const view of VIEWS) {
  const [name, kind, options, , , shownInReadme] = view;
  test(`${name} looks as before: ${kind}`, async (t) => {
    const { page, close } = await open(await report(name), options);
    const now = await shot(page, view);
    await close();
    const file = `${name.replaceAll("/", "-")}-${kind}.png`;
    await writeFile(pictures + file, now);
    if (process.env.TRUEPATH_BLESS) {
      for (const folder of [reference, ...(shownInReadme ? [readme] : [])]) {
        await mkdir(folder, { recursive: true });
        await writeFile(folder + file, now);
      }
    }
    const blank = await comparer();
    const { mean, largest } = await difference(blank, now, await readFile(reference + file));
    await blank.close();
    t.diagnostic(`mean ${mean.toFixed(4)}, largest ${largest.toFixed(2)}`);
    assert.ok(mean < MEAN && largest < LARGEST, `${pictures}${file} is not as ${reference}${file}: mean ${mean.toFixed(4)}, largest ${largest.toFixed(2)}; cargo xtask page --write renews it`);
    if (shownInReadme) assert.ok((await readFile(readme + file)).length < README, `${file} of the README is too large`);
  });
}

test("the comparison notices another colour, a layer missing and another place of the cutter, not another rendering of letters", async (t) => {
  const { page, close } = await open(await report("demo/pocket"), SIZE);
  const blank = await comparer();
  const view = VIEWS.find(([name, kind]) => name === "demo/pocket" && kind === "light");
  const one = await shot(page, view);
  const apart = async (what, change, back) => {
    await change();
    const found = await difference(blank, one, await shot(page, [null, null, null, null, null]));
    await back();
    t.diagnostic(`${what}: mean ${found.mean.toFixed(4)}, largest ${found.largest.toFixed(2)}`);
    return found.mean >= MEAN || found.largest >= LARGEST;
  };
  const style = (text) => page.evaluate((rule) => {
    document.querySelector("#tried")?.remove();
    document.head.insertAdjacentHTML("beforeend", `<style id="tried">${rule}</style>`);
  }, text);
  const layer = (id) => [() => page.uncheck(`#layer-${id}`), () => page.check(`#layer-${id}`)];
  assert.ok(await apart("band missing", ...layer("band")), "the band");
  assert.ok(await apart("cutter elsewhere", () => page.fill("#scrub", "1400"), () => page.fill("#scrub", "560")), "the cutter");
  assert.ok(await apart("traces missing", () => style(".traces { visibility: hidden }"), () => style("")), "the traces");
  assert.ok(!await apart("other letters", () => style("body { -webkit-font-smoothing: none; text-rendering: geometricPrecision; letter-spacing: 0.15px }"), () => style("")), "letters");
  await blank.close();
  await close();
});
