// The page as a file: from disk, without network, in both themes, on a phone, on paper, for everybody.
import assert from "node:assert/strict";
import { readFile, stat } from "node:fs/promises";
import { createRequire } from "node:module";
import { after, before, test } from "node:test";
import { launch, open, out, sample, write } from "./browser.mjs";

const axe = await readFile(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const PHONE = { viewport: { width: 360, height: 740 }, deviceScaleFactor: 2, isMobile: true, hasTouch: true };
let browser;
before(async () => { browser = await launch(); });
after(() => browser.close());

async function violations(page) {
  await page.evaluate(axe);
  const result = await page.evaluate(() => globalThis.axe.run(document, { resultTypes: ["violations"] }));
  return result.violations.map((v) => `${v.id}: ${v.nodes.map((n) => n.target.join(" ")).join(", ")}`);
}

for (const part of ["corner", "pocket"]) {
  test(`the ${part} opens from disk within a second, complains of nothing and asks the network for nothing`, async () => {
    const file = await write(part, await sample(part));
    assert.ok((await stat(file)).size < 2_000_000);
    const { page, complaints, requests, close } = await open(browser, file);
    assert.ok(Number(await page.getAttribute("html", "data-first-picture")) < 1000);
    await page.click("#play");
    await page.waitForTimeout(300);
    await page.click("#play");
    await page.screenshot({ path: `${out}${part}-light.png`, fullPage: true });
    assert.deepEqual(complaints, []);
    assert.deepEqual(requests, []);
    await close();
  });

  test(`the ${part} fits a phone without scrolling sideways`, async () => {
    const { page, close } = await open(browser, await write(part, await sample(part)), PHONE);
    for (const shown of ["before", "after", "both"]) {
      await page.click(`label[for="shown-${shown}"]`);
      assert.ok(await page.evaluate(() => document.documentElement.scrollWidth) <= 360, shown);
    }
    await page.screenshot({ path: `${out}${part}-phone.png`, fullPage: true });
    await close();
  });

  test(`the ${part} breaks no rule of axe in light, in dark, on a phone`, async () => {
    const file = await write(part, await sample(part));
    for (const options of [{}, { colorScheme: "dark" }, PHONE]) {
      const { page, close } = await open(browser, file, options);
      assert.deepEqual(await violations(page), []);
      await page.click(".warnings summary");
      if (!options.isMobile) await page.click('label[for="shown-both"]');
      assert.deepEqual(await violations(page), []);
      await close();
    }
  });
}

test("the page is dark where the system is, and the reader may choose otherwise", async () => {
  const { page, close } = await open(browser, await write("pocket", await sample("pocket")), { colorScheme: "dark" });
  const pixel = () => page.locator(".stage canvas").first().evaluate((canvas) => canvas.getContext("2d").getImageData(5, canvas.height / 2 | 0, 1, 1).data[0]);
  const ground = () => page.evaluate(() => getComputedStyle(document.body).getPropertyValue("--ground").trim());
  assert.equal(await ground(), "#14171a");
  assert.ok(await pixel() < 60);
  await page.screenshot({ path: `${out}pocket-dark.png`, fullPage: true });
  await page.click("#theme");
  assert.match(await ground(), /^#fff/);
  assert.ok(await pixel() > 200);
  await close();
});

test("on paper both passes, all warnings and every point are there, and afterwards the page is as before", async () => {
  const { page, complaints, close } = await open(browser, await write("pocket", await sample("pocket")), { colorScheme: "dark" });
  const state = () => page.evaluate(() => [document.documentElement.dataset.theme ?? "", document.querySelector("#shown-before").checked, document.querySelector(".stage").dataset.view]);
  const kept = await state();
  const paper = await page.pdf({ path: `${out}pocket.pdf`, preferCSSPageSize: true, printBackground: true });
  const pages = paper.toString("latin1").match(/\/Type \/Page\b/g).length;
  assert.ok(pages >= 2 && pages <= 3, `${pages} pages`);
  assert.deepEqual(await state(), kept);
  await page.evaluate(() => window.dispatchEvent(new Event("beforeprint")));
  assert.equal(await page.locator(".stage:visible").count(), 2);
  assert.ok(await page.locator(".warnings li").first().isVisible());
  assert.equal(await page.locator("#points tbody tr").count(), 15);
  await page.evaluate(() => window.dispatchEvent(new Event("afterprint")));
  assert.deepEqual(complaints, []);
  await close();
});

test("everything can be reached and worked with the keyboard, and a change is told", async () => {
  const { page, close } = await open(browser, await write("pocket", await sample("pocket")));
  const reached = new Set();
  for (let i = 0; i < 40; i++) {
    await page.keyboard.press("Tab");
    reached.add(await page.evaluate(() => document.activeElement.id || document.activeElement.className || document.activeElement.textContent));
  }
  for (const stop of ["theme", "shown-before", "magnify", "stage", "layer-band", "play", "scrub", "speed"]) assert.ok(reached.has(stop), stop);
  await page.focus("#scrub");
  await page.keyboard.press("ArrowRight");
  await page.waitForFunction(() => /^s 0\.1/.test(document.querySelector("#live").textContent));
  assert.match(await page.locator("#live").textContent(), /error before .* error after/);
  await close();
});
