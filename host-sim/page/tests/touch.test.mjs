// A phone in the hand: real touches, as the browser gets them from the screen.
import assert from "node:assert/strict";
import { test } from "node:test";
import { open, PHONE, report } from "./browser.mjs";

/** Touches a place, moves and lifts; each finger a start and a way. */
async function touch(context, page, fingers) {
  const input = await context.newCDPSession(page);
  const at = (share) => fingers.map(({ x, y, dx, dy }, id) => ({ x: x + dx * share, y: y + dy * share, id }));
  await input.send("Input.dispatchTouchEvent", { type: "touchStart", touchPoints: at(0) });
  for (let k = 1; k <= 10; k++) await input.send("Input.dispatchTouchEvent", { type: "touchMove", touchPoints: at(k / 10) });
  await input.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
  await input.detach();
}

/** Waits until nothing scrolls any more: a page goes on for a while when the finger has left it. */
async function settled(page) {
  await page.evaluate(() => new Promise((done) => {
    let [last, still] = [scrollY, 0];
    const look = () => {
      still = scrollY === last ? still + 1 : 0;
      last = scrollY;
      if (still > 20) done();
      else requestAnimationFrame(look);
    };
    look();
  }));
}

const view = (page) => page.locator(".stage:visible").first().getAttribute("data-view");
const scrolled = (page) => page.evaluate(() => scrollY);

async function shown(page, place) {
  const element = page.locator(place).first();
  await settled(page);
  await element.scrollIntoViewIfNeeded();
  await settled(page);
  return element.boundingBox();
}

test("a finger over the whole picture scrolls the page; two zoom, and then one moves the picture", async () => {
  const { context, page, close } = await open(await report("demo/pocket"), PHONE);
  const box = await shown(page, ".stage");
  const [whole, from] = [await view(page), await scrolled(page)];
  await touch(context, page, [{ x: box.x + 150, y: box.y + 200, dx: 0, dy: -180 }]);
  await page.waitForFunction((y) => scrollY > y + 60, from);
  assert.equal(await view(page), whole, "the picture has not moved");
  const { x, y } = await shown(page, ".stage");
  await touch(context, page, [{ x: x + 140, y: y + 150, dx: -60, dy: -30 }, { x: x + 180, y: y + 150, dx: 60, dy: 30 }]);
  const zoomed = await view(page);
  assert.ok(Number(zoomed.split(" ")[2]) > 2 * Number(whole.split(" ")[2]));
  await settled(page);
  const here = await scrolled(page);
  await touch(context, page, [{ x: x + 150, y: y + 150, dx: 30, dy: -80 }]);
  assert.notEqual(await view(page), zoomed);
  await settled(page);
  assert.equal(await scrolled(page), here, "the page stays");
  await close();
});

test("a finger across a trace frames a stretch, up and down it scrolls the page, a tap puts the cutter there", async () => {
  const { context, page, close } = await open(await report("demo/pocket"), PHONE);
  const box = await shown(page, ".u-over");
  const from = await scrolled(page);
  await touch(context, page, [{ x: box.x + 100, y: box.y + 20, dx: 0, dy: -180 }]);
  await page.waitForFunction((y) => scrollY > y + 60, from);
  assert.equal(await page.getByRole("button", { name: "fragment" }).count(), 0);
  const trace = await shown(page, ".u-over");
  await touch(context, page, [{ x: trace.x + 0.25 * trace.width, y: trace.y + 20, dx: 0.25 * trace.width, dy: 3 }]);
  await page.getByRole("button", { name: "fragment" }).waitFor();
  const { x, y, width } = await shown(page, ".u-over");
  await page.touchscreen.tap(x + 0.5 * width, y + 20);
  // The middle of 25 % … 50 % of 1,932 samples.
  await page.waitForFunction(() => Math.abs(Number(document.querySelector("#scrub").value) - 0.375 * 1932) < 12);
  await close();
});
