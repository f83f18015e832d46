// The letters of the page: its own font has every one that page and program write, and with any other font nothing runs over.
// The only font of the system is one of wide boxes (tests/fonts): wherever it is used, it is seen and needs more room than any real one.
import assert from "node:assert/strict";
import { readdir, readFile } from "node:fs/promises";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { dataOf, open, PHONE, pictures, report, write } from "./browser.mjs";
import { faults, listen, named, settled } from "./checks.mjs";

const root = fileURLToPath(new URL("..", import.meta.url));
const WRITTEN = ["demo/corner", "demo/pocket", "simulate-core", "simulate-plant", "island", "inspect", "correct", "learn"];

/** The characters of the page's own font. */
const OWN = new Set((await readFile(`${root}font/characters.txt`, "utf8")).split("\n").filter((line) => line && !line.startsWith("#")).flatMap((line) => {
  const [first, last = first] = line.split("-").map((code) => parseInt(code, 16));
  return Array.from({ length: last - first + 1 }, (_, k) => String.fromCodePoint(first + k));
}));
const foreign = (text) => [...new Set(text)].filter((c) => !OWN.has(c) && c !== "\n");

test("every character that the page and the program write is one of the page's own font", async () => {
  for (const file of await readdir(`${root}src`)) assert.deepEqual(foreign(await readFile(`${root}src/${file}`, "utf8")), [], file);
  for (const name of WRITTEN) assert.deepEqual(foreign(JSON.stringify(await dataOf(name))), [], name);
});

/** Fonts that an element is drawn with, and how many letters with each. */
async function fonts(input, page, selector) {
  const { root: { nodeId } } = await input.send("DOM.getDocument");
  const element = await input.send("DOM.querySelector", { nodeId, selector });
  return (await input.send("CSS.getPlatformFontsForNode", { nodeId: element.nodeId })).fonts;
}

test("the page's own font has all of its characters in both weights, and what it lacks comes from the system", async () => {
  const { context, page, close } = await open(await report("demo/corner"));
  const input = await context.newCDPSession(page);
  for (const domain of ["DOM", "CSS"]) await input.send(`${domain}.enable`);
  const all = [...OWN].filter((c) => /\S/.test(c) && c !== "\u00ad").join("");
  for (const weight of [400, 600]) {
    await page.evaluate(([text, bold]) => {
      document.querySelector("#tried")?.remove();
      const tried = document.createElement("p");
      Object.assign(tried, { id: "tried", textContent: text });
      tried.style.fontWeight = bold;
      document.body.append(tried);
      // A font is read when the first letter wants it; until then another one stands in.
      tried.getBoundingClientRect();
      return document.fonts.ready.then(() => undefined);
    }, [`${all}Деталь`, weight]);
    const [own, other, ...more] = (await fonts(input, page, "#tried")).sort((a, b) => b.glyphCount - a.glyphCount);
    assert.deepEqual([own.isCustomFont, own.glyphCount], [true, [...all].length]);
    assert.deepEqual([other.familyName, other.isCustomFont, other.glyphCount, more.length], ["Boxes", false, 6, 0]);
  }
  await input.detach();
  await close();
});

for (const [letters, font] of [[true, "its own font"], [false, "another one"]]) {
  for (const name of ["demo/pocket", "learn", "inspect"]) {
    test(`${name} with ${font}: nothing is cut off, over another or out of its block, on phone, desk and paper`, async () => {
      const file = await write(`letters-${letters}-${name.replaceAll("/", "-")}`, named(await dataOf(name)), { letters });
      for (const options of [PHONE, {}]) {
        const { page, close } = await open(file, options);
        await listen(page);
        const both = page.locator('label[for="shown-both"]');
        for (const width of options === PHONE ? [360] : [700, 965, 1280]) {
          if (options !== PHONE) await page.setViewportSize({ width, height: 900 });
          if (await both.count()) await both.click();
          await page.locator(".warnings summary").click();
          if (await page.locator("#scrub").count()) await page.fill("#scrub", "620");
          await settled(page);
          await page.locator(".warnings summary").click();
          assert.deepEqual(await faults(page), [], `${width} pixels`);
        }
        if (options === PHONE) {
          await page.screenshot({ path: `${pictures}${name.replaceAll("/", "-")}-letters-${letters}.png`, fullPage: true });
          await page.locator(".stage:visible").first().tap({ position: { x: 5, y: 5 } });
          const { x, y } = await page.locator(".stage:visible").first().boundingBox();
          await page.mouse.move(x + 170, y + 80);
          assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= 360), "with the figures at the pointer");
        } else {
          await page.evaluate(() => window.dispatchEvent(new Event("beforeprint")));
          await settled(page);
          assert.deepEqual((await faults(page)), [], "paper");
          await page.evaluate(() => window.dispatchEvent(new Event("afterprint")));
        }
        await close();
      }
    });
  }
}
