// The pictures look as they did: compared with tests/reference, coarsely, since letters differ from system to system.
// `node tests/picture.test.mjs --bless` renews them.
import assert from "node:assert/strict";
import { copyFile, mkdir, readFile } from "node:fs/promises";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { launch, open, out, sample, write } from "./browser.mjs";

const reference = fileURLToPath(new URL("reference/", import.meta.url));
const bless = process.argv.includes("--bless");
const SIZE = { viewport: { width: 1440, height: 900 } };
const VIEWS = [
  ["corner", "light", SIZE, "before", "480"], ["corner", "side-by-side", SIZE, "both", "430"],
  ["pocket", "light", SIZE, "before", "560"], ["pocket", "dark", { ...SIZE, colorScheme: "dark" }, "both", "560"],
  ["pocket", "phone", { viewport: { width: 360, height: 740 }, deviceScaleFactor: 2, isMobile: true, hasTouch: true }, "after", "560"],
];
let browser;
before(async () => { browser = await launch(); });
after(() => browser.close());

/** Mean and largest difference of two pictures over a grid of 48 × 32 cells, 0…1. */
async function difference(page, one, other) {
  const [a, b] = await Promise.all([readFile(one, "base64"), readFile(other, "base64")]);
  return page.evaluate(async (sources) => {
    const cells = await Promise.all(sources.map(async (source) => {
      const bytes = Uint8Array.from(atob(source), (c) => c.charCodeAt(0));
      const image = await createImageBitmap(new Blob([bytes], { type: "image/png" }), { resizeWidth: 48, resizeHeight: 32, resizeQuality: "high" });
      const canvas = new OffscreenCanvas(48, 32);
      canvas.getContext("2d").drawImage(image, 0, 0);
      return canvas.getContext("2d").getImageData(0, 0, 48, 32).data;
    }));
    const apart = Array.from(cells[0], (v, i) => Math.abs(v - cells[1][i]) / 255);
    return { mean: apart.reduce((sum, v) => sum + v, 0) / apart.length, largest: Math.max(...apart) };
  }, [a, b]);
}

for (const [part, name, options, shown, place] of VIEWS) {
  test(`the ${part} looks as before: ${name}`, async (t) => {
    const { page, close } = await open(browser, await write(part, await sample(part)), options);
    await page.click(`label[for="shown-${shown}"]`);
    await page.fill("#scrub", place);
    await page.evaluate(() => { document.activeElement.blur(); window.scrollTo(0, 0); });
    await page.waitForTimeout(100);
    const file = `${part}-${name}.png`;
    await page.screenshot({ path: out + file });
    if (bless) {
      await mkdir(reference, { recursive: true });
      await copyFile(out + file, reference + file);
    }
    const { mean, largest } = await difference(page, out + file, reference + file);
    t.diagnostic(`mean ${mean.toFixed(4)}, largest ${largest.toFixed(2)}`);
    assert.ok(mean < 0.02 && largest < 0.5, `mean ${mean}, largest ${largest}`);
    await close();
  });
}
