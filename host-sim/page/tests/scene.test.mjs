// The picture under pointer, wheel, fingers and keys; cutter, passes, layers, heights, traces.
import assert from "node:assert/strict";
import { test } from "node:test";
import { column } from "./columns.mjs";
import { dataOf, flag, onPage, open, pictures, report, write } from "./browser.mjs";

const view = async (page) => (await page.locator(".stage:visible").first().getAttribute("data-view")).split(" ").map(Number);
const place = (page) => page.inputValue("#scrub").then(Number);
const still = (page) => page.locator(".stage:visible canvas").first().evaluate((canvas) => canvas.toDataURL());
const pocket = async () => open(await report("demo/pocket"));

test("play moves the cutter at the speed of the machine, pause holds it, scrubbing puts it elsewhere", async () => {
  const { page, close } = await open(await report("demo/pocket"), { clock: true });
  const moving = () => page.locator(".stage:visible canvas").nth(1).evaluate((canvas) => canvas.toDataURL());
  const first = await moving();
  await page.click("#play");
  await page.clock.runFor(1500);
  // 600 mm/min and a sample every 0.1 mm: 100 samples a second, and the cutter stands where it was at the last frame.
  const at = await place(page);
  assert.ok(at >= 147 && at <= 150, `${at}`);
  assert.notEqual(await moving(), first);
  await page.click("#play");
  await page.clock.runFor(500);
  assert.equal(await place(page), at);
  await page.fill("#scrub", "900");
  assert.match(await page.locator("#readout .at").textContent(), /^s 89\.9/);
  await page.locator(".playhead").first().waitFor();
  await close();
});

test("the end of the contour stops the cutter, and play begins anew", async () => {
  const { page, close } = await open(await report("demo/pocket"), { clock: true });
  await page.selectOption("#speed", "10");
  await page.fill("#scrub", "1900");
  await page.click("#play");
  await page.clock.runFor(1000);
  assert.equal(await page.textContent("#play"), "▶");
  assert.equal(await place(page), 1932);
  await page.click("#play");
  await page.clock.runFor(200);
  const at = await place(page);
  assert.ok(at > 150 && at <= 200, `${at}`);
  await close();
});

test("the wheel zooms about the pointer, dragging moves, 0 shows everything", async () => {
  const { page, close } = await pocket();
  const [cx, cy, scale] = await view(page);
  await page.locator(".stage:visible").focus();
  const at = await onPage(page, 26, 16);
  await page.mouse.move(at.x, at.y);
  for (let k = 0; k < 3; k++) await page.mouse.wheel(0, -200);
  await page.waitForFunction((whole) => Number(document.querySelector(".stage").dataset.view.split(" ")[2]) > 2.5 * whole, scale);
  const zoomed = await view(page);
  assert.ok(zoomed[2] > 2 * scale);
  const again = await onPage(page, 26, 16);
  assert.ok(Math.hypot(again.x - at.x, again.y - at.y) < 2, "the place under the pointer stays");
  await page.mouse.down();
  await page.mouse.move(at.x + 50, at.y + 20, { steps: 3 });
  await page.mouse.up();
  const moved = await view(page);
  assert.ok(Math.abs((zoomed[0] - moved[0]) * moved[2] - 50) < 1 && Math.abs((moved[1] - zoomed[1]) * moved[2] - 20) < 1);
  await page.locator(".stage:visible").focus();
  await page.keyboard.press("0");
  assert.deepEqual(await view(page), [cx, cy, scale]);
  await close();
});

test("keys zoom, move and step; a frame with Shift zooms to what it holds", async () => {
  const { page, close } = await pocket();
  const [cx, cy, scale] = await view(page);
  await page.locator(".stage:visible").focus();
  await page.keyboard.press("+");
  assert.ok(Math.abs((await view(page))[2] / scale - 1.25) < 1e-9);
  await page.keyboard.press("-");
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("ArrowUp");
  const moved = await view(page);
  assert.ok(moved[0] > cx && moved[1] > cy);
  await page.keyboard.press(".");
  await page.keyboard.press(".");
  await page.keyboard.press(",");
  assert.equal(await place(page), 1);
  await page.keyboard.press("End");
  assert.equal(await place(page), 1932);
  await page.keyboard.press("0");
  const a = await onPage(page, 20, 20);
  const b = await onPage(page, 32, 10);
  await page.keyboard.down("Shift");
  await page.mouse.move(a.x, a.y);
  await page.mouse.down();
  await page.mouse.move(b.x, b.y, { steps: 3 });
  await page.mouse.up();
  await page.keyboard.up("Shift");
  const framed = await view(page);
  assert.ok(Math.abs(framed[0] - 26) < 0.1 && Math.abs(framed[1] - 15) < 0.1 && framed[2] > 2 * scale);
  await close();
});

test("two fingers zoom", async () => {
  const { page, close } = await pocket();
  const [, , scale] = await view(page);
  await page.locator(".stage:visible").evaluate((stage) => {
    stage.setPointerCapture = () => undefined;
    const box = stage.getBoundingClientRect();
    const fire = (type, id, x) => stage.dispatchEvent(new PointerEvent(type, { pointerId: id, pointerType: "touch", clientX: box.left + x, clientY: box.top + 200, bubbles: true }));
    fire("pointerdown", 1, 200);
    fire("pointerdown", 2, 300);
    fire("pointermove", 2, 400);
    fire("pointerup", 1, 200);
    fire("pointerup", 2, 400);
  });
  assert.ok(Math.abs((await view(page))[2] / scale - 2) < 1e-6);
  await close();
});

test("before, after and side by side show different passes in one view", async () => {
  const { page, close } = await pocket();
  const before = await still(page);
  await page.click('label[for="shown-after"]');
  assert.notEqual(await still(page), before);
  await page.click('label[for="shown-both"]');
  assert.equal(await page.locator(".stage:visible").count(), 2);
  await page.locator(".stage:visible").nth(1).focus();
  await page.keyboard.press("+");
  const views = await page.locator(".stage:visible").evaluateAll((all) => all.map((stage) => stage.dataset.view));
  assert.equal(views[0], views[1]);
  await page.screenshot({ path: `${pictures}pocket-side-by-side.png` });
  await close();
});

test("the magnification and every layer change the picture", async () => {
  const { page, close } = await pocket();
  await page.click('label[for="shown-after"]');
  let last = await still(page);
  await page.selectOption("#magnify", "100");
  assert.notEqual(await still(page), last);
  for (const layer of ["band", "nominal", "commanded", "actual", "stock"]) {
    last = await still(page);
    await page.uncheck(`#layer-${layer}`);
    assert.notEqual(await still(page), last, layer);
  }
  await close();
});

test("a stretch drawn in a trace is shown in all of them, and in the picture on demand", async () => {
  const { page, close } = await pocket();
  const [, , scale] = await view(page);
  await page.click('label[for="shown-after"]');
  assert.equal(await page.getByRole("button", { name: "fragment" }).count(), 0);
  const box = await page.locator(".u-over").first().boundingBox();
  await page.mouse.move(box.x + box.width * 0.3, box.y + 10);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width * 0.4, box.y + 12, { steps: 4 });
  await page.mouse.up();
  await page.getByRole("button", { name: "fragment" }).click();
  assert.ok((await view(page))[2] > 1.5 * scale);
  await page.mouse.click(box.x + box.width * 0.5, box.y + 10);
  // The middle of 30 % … 40 % of 193.1 mm.
  assert.match(await page.locator("#readout .at").textContent(), /^s 67\.\d/);
  await page.getByRole("button", { name: "whole" }).click();
  assert.ok(Math.abs((await view(page))[2] - scale) < 1e-9);
  await close();
});

test("the height slider shows the error at the height it names", async () => {
  const data = await dataOf("demo/pocket");
  // Made up for the test: a wall that leans, 10 µm at the tip and −10 µm at the top.
  const nodes = 194;
  data.heights = {
    z_mm: [0, 6, 12], stride: 10,
    before: column(Array.from({ length: nodes }, () => ["0.010", "0.000", "-0.010"]).flat()),
  };
  const { page, complaints, close } = await open(await write("heights", data));
  const at = await onPage(page, 12, -20);
  const error = async () => {
    await page.mouse.move(at.x + 1, at.y);
    await page.mouse.move(at.x, at.y);
    return (await flag(page))["error before"];
  };
  const mean = await error();
  for (const [value, text] of [["1", "+0.010 mm"], ["2", "0.000 mm"], ["3", "−0.010 mm"]]) {
    await page.fill("#height", value);
    assert.equal(await error(), text);
  }
  await page.fill("#height", "0");
  assert.equal(await error(), mean);
  assert.deepEqual(complaints, []);
  await close();
});

test("a probe point chosen in the table is shown large", async () => {
  const { page, close } = await pocket();
  const [, , scale] = await view(page);
  await page.getByRole("button", { name: "Show probe point 10 in the picture" }).click();
  const [x, y, large] = await view(page);
  assert.ok(Math.hypot(x + 34.926, y + 0.2) < 0.01 && large > 2 * scale);
  await close();
});

test("keys zoom and move the traces, and while playing their stretch turns with the cutter", async () => {
  const { page, complaints, close } = await open(await report("demo/pocket"), { clock: true });
  const ticks = () => page.locator(".trace canvas").last().evaluate((canvas) => canvas.toDataURL());
  const whole = await ticks();
  await page.fill("#scrub", "400");
  await page.focus(".traces");
  for (const key of ["+", "+", "+"]) await page.keyboard.press(key);
  const near = await ticks();
  assert.notEqual(near, whole);
  await page.keyboard.press("ArrowRight");
  assert.notEqual(await ticks(), near);
  await page.selectOption("#speed", "10");
  await page.click("#play");
  await page.clock.runFor(900);
  assert.ok(await place(page) > 1200, "the cutter has left the stretch that was shown");
  await page.click("#play");
  assert.ok(await page.locator(".playhead").first().isVisible(), "the cutter is within the traces");
  await page.focus(".traces");
  await page.keyboard.press("0");
  await page.fill("#scrub", "400");
  assert.equal(await ticks(), whole);
  assert.deepEqual(complaints, []);
  await close();
});

test("the line of the cutter in the traces stays when another pass, another theme or paper is asked for", async () => {
  const { page, close } = await pocket();
  await page.fill("#scrub", "966");
  const middle = () => page.locator(".playhead").evaluateAll((all) => all.map((line) => {
    const [at, within] = [line, line.parentElement].map((e) => e.getBoundingClientRect());
    return at.width > 0 && Math.abs((at.left - within.left) / within.width - 0.5) < 0.01;
  }));
  for (const change of ['label[for="shown-after"]', 'label[for="shown-both"]', "#theme"]) {
    await page.click(change);
    assert.deepEqual(await middle(), [true], change);
  }
  await page.setViewportSize({ width: 1200, height: 900 });
  await page.waitForFunction(() => document.querySelector(".u-over").clientWidth < 460);
  assert.deepEqual(await middle(), [true], "another width");
  await page.evaluate(() => window.dispatchEvent(new Event("beforeprint")));
  assert.deepEqual(await middle(), Array(7).fill(true), "paper");
  await page.evaluate(() => window.dispatchEvent(new Event("afterprint")));
  await close();
});

test("the picture follows the cutter when told to", async () => {
  const { page, close } = await pocket();
  await page.locator(".stage:visible").focus();
  for (let k = 0; k < 5; k++) await page.keyboard.press("+");
  await page.check("#follow");
  await page.fill("#scrub", "500");
  const [cx, cy] = await view(page);
  assert.ok(Math.abs(cx - 30) < 0.01 && cy > -16 && cy < 16);
  await close();
});
