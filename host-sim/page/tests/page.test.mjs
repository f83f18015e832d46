// The page as a file: from disk, without network, in both themes, on a phone, on paper, for everybody.
import assert from "node:assert/strict";
import { stat } from "node:fs/promises";
import { test } from "node:test";
import { open, PHONE, pictures, report } from "./browser.mjs";
import { violations } from "./checks.mjs";

/** A page of every command, and the two parts everybody tries first. */
const EVERY = ["demo/corner", "demo/pocket", "simulate-core", "simulate-plant", "island", "inspect", "correct", "learn"];

for (const name of EVERY) {
  const picture = (kind) => `${pictures}${name.replaceAll("/", "-")}-${kind}.png`;
  test(`${name} opens from disk within 2 MB, complains of nothing, asks the network for nothing, breaks no rule of axe`, async () => {
    const file = await report(name);
    assert.ok((await stat(file)).size < 2_000_000);
    const { page, complaints, requests, close } = await open(file);
    assert.equal(await page.locator("[role=alert]").count(), 0);
    if (await page.locator("#play").count()) {
      await page.click("#play");
      await page.waitForFunction(() => Number(document.querySelector("#scrub").value) > 0);
      await page.click("#play");
    }
    await page.screenshot({ path: picture("whole"), fullPage: true });
    assert.deepEqual(await violations(page), []);
    if (await page.locator(".warnings summary").count()) await page.click(".warnings summary");
    if (await page.locator("#shown-both").count()) await page.click('label[for="shown-both"]');
    assert.deepEqual(await violations(page), []);
    assert.deepEqual(complaints, []);
    assert.deepEqual(requests, []);
    await close();
  });

  test(`${name} fits a phone without scrolling sideways, and is dark where the system is`, async () => {
    const { page, complaints, close } = await open(await report(name), { ...PHONE, colorScheme: "dark" });
    const fits = async (what) => assert.ok(await page.evaluate(() => document.documentElement.scrollWidth) <= 360, what);
    await fits("as opened");
    for (const shown of ["before", "after", "both"]) {
      if (!await page.locator(`#shown-${shown}`).count()) continue;
      await page.click(`label[for="shown-${shown}"]`);
      await fits(shown);
    }
    assert.deepEqual(await violations(page), []);
    await page.screenshot({ path: picture("phone"), fullPage: true });
    assert.deepEqual(complaints, []);
    await close();
  });
}

test("the page is dark where the system is, and the reader may choose otherwise", async () => {
  const { page, close } = await open(await report("demo/pocket"), { colorScheme: "dark" });
  const pixel = () => page.locator(".stage canvas").first().evaluate((canvas) => canvas.getContext("2d").getImageData(5, canvas.height / 2 | 0, 1, 1).data[0]);
  const ground = () => page.evaluate(() => getComputedStyle(document.body).getPropertyValue("--ground").trim());
  assert.equal(await ground(), "#14171a");
  assert.ok(await pixel() < 60);
  await page.click("#theme");
  assert.match(await ground(), /^#fff/);
  assert.ok(await pixel() > 200);
  await close();
});

for (const [name, most] of [["demo/pocket", 3], ["inspect", 3]]) {
  test(`${name} on paper: both passes, all warnings and every point, and afterwards the page is as before`, async () => {
    const { page, complaints, close } = await open(await report(name), { colorScheme: "dark" });
    const points = await page.locator("#points tbody tr").count();
    const state = () => page.evaluate(() => [document.documentElement.dataset.theme ?? "", document.querySelector("#shown-before")?.checked, document.querySelector(".stage").dataset.view, document.querySelector(".warnings").open]);
    const kept = await state();
    const paper = await page.pdf({ path: `${pictures}${name.replaceAll("/", "-")}.pdf`, preferCSSPageSize: true, printBackground: true });
    const sheets = paper.toString("latin1").match(/\/Type \/Page\b/g).length;
    assert.ok(sheets >= 1 && sheets <= most, `${sheets} sheets`);
    assert.deepEqual(await state(), kept);
    await page.evaluate(() => window.dispatchEvent(new Event("beforeprint")));
    assert.equal(await page.locator(".stage:visible").count(), kept[1] === undefined ? 1 : 2);
    for (const line of await page.locator(".warnings li").all()) assert.ok(await line.isVisible());
    assert.equal(await page.locator("#points tbody tr:visible").count(), points);
    await page.evaluate(() => window.dispatchEvent(new Event("afterprint")));
    assert.deepEqual(complaints, []);
    await close();
  });
}

test("everything can be reached and worked with the keyboard, and a change is told", async () => {
  const { page, close } = await open(await report("demo/pocket"));
  const reached = new Set();
  for (let i = 0; i < 40; i++) {
    await page.keyboard.press("Tab");
    reached.add(await page.evaluate(() => document.activeElement.id || document.activeElement.className || document.activeElement.textContent));
  }
  for (const stop of ["theme", "shown-before", "magnify", "stage", "layer-band", "play", "scrub", "speed"]) assert.ok(reached.has(stop), stop);
  await page.focus("#scrub");
  await page.keyboard.press("ArrowRight");
  await page.waitForFunction(() => /^s 0\.1/.test(document.querySelector("#live").textContent));
  assert.match(await page.locator("#live").textContent(), /error before [^;]* mm$/);
  await close();
});

test("for who wants less motion nothing moves before it is asked to, and nothing glides", async () => {
  const { page, close } = await open(await report("demo/pocket"), { reducedMotion: "reduce", clock: true });
  await page.clock.runFor(1000);
  assert.equal(await page.inputValue("#scrub"), "0");
  assert.deepEqual(await page.evaluate(() => document.getAnimations().length), 0);
  await page.locator(".stage:visible").focus();
  const view = () => page.locator(".stage:visible").getAttribute("data-view");
  await page.keyboard.press("+");
  const zoomed = await view();
  await page.clock.runFor(1000);
  assert.equal(await view(), zoomed);
  await close();
});
