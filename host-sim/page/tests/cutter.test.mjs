// The cutter where it cuts, looked for in the pixels: outside and inside corners, wall right and left, climb and conventional.
import assert from "node:assert/strict";
import { test } from "node:test";
import { dataOf, onPage, open, report, table } from "./browser.mjs";
import { numbers } from "./columns.mjs";

/** Puts the cutter at a sample; whether places of the part then lie on the engaged arc: it is drawn in ochre, and nothing else is. */
async function engaged(page, sample, places) {
  return page.evaluate(([at, all]) => {
    const scrub = document.querySelector("#scrub");
    scrub.value = String(at);
    scrub.dispatchEvent(new Event("input"));
    const stage = [...document.querySelectorAll(".stage")].find((each) => each.offsetParent);
    const canvas = stage.querySelectorAll("canvas")[1];
    const [cx, cy, scale] = stage.dataset.view.split(" ").map(Number);
    return all.map(([x, y]) => {
      const [px, py] = [(x - cx) * scale + stage.clientWidth / 2, stage.clientHeight / 2 - (y - cy) * scale];
      const [r, g, b, a] = canvas.getContext("2d", { willReadFrequently: true }).getImageData(Math.round(px), Math.round(py), 1, 1).data;
      return a > 200 && r > 150 && g > 90 && g < 160 && b < 60;
    });
  }, [sample, places]);
}

for (const [name, radius] of [["island", 6], ["simulate-plant", 5]]) {
  test(`${name}: the engaged arc goes from the wall towards the direction of travel, as far as trace.csv says`, async () => {
    const { contour, job } = await dataOf(name);
    const trace = await table(`${name}/trace.csv`);
    assert.equal(job.milling, name === "island" ? "conventional" : "climb");
    const [x, y, arc, nx, ny] = [contour.x_mm, contour.y_mm, contour.before.arc_deg, contour.nx, contour.ny].map(numbers);
    const { page, close } = await open(await report(name));
    // Enlarged once, the cutter stands on its path to a few hundredths of a millimetre.
    await page.selectOption("#magnify", "1");
    let looked = 0;
    for (let i = 40; i < x.length - 40; i += Math.floor(x.length / 23)) {
      if (!(arc[i] > 15) || Math.abs(arc[i + 20] - arc[i - 20]) > 1) continue;
      const travel = [x[i + 3] - x[i - 3], y[i + 3] - y[i - 3]];
      // The side of the wall by its own means: right or left of travel.
      const side = job.wall === "right" ? [travel[1], -travel[0]] : [-travel[1], travel[0]];
      assert.ok(side[0] * nx[i] + side[1] * ny[i] > 0.99 * Math.hypot(...side), `the normal points to the wall at ${trace.s_mm[i]}`);
      const along = Math.hypot(...travel);
      const at = (degrees) => {
        const a = (degrees * Math.PI) / 180;
        const direction = [0, 1].map((k) => Math.cos(a) * [nx[i], ny[i]][k] + (Math.sin(a) * travel[k]) / along);
        return [x[i] + radius * direction[0], y[i] + radius * direction[1]];
      };
      const found = await engaged(page, i, [-6, 3, arc[i] / 2, arc[i] - 3, arc[i] + 6, 180].map(at));
      assert.deepEqual(found, [false, true, true, true, false, false], `s = ${trace.s_mm[i]}, arc ${arc[i]}`);
      looked++;
    }
    assert.ok(looked >= 10, `${looked} places`);
    await close();
  });
}

test("the cutter touches the enlarged wall it makes, before and after", async () => {
  const { contour, job } = await dataOf("demo/pocket");
  const [x, y, nx, ny] = [contour.x_mm, contour.y_mm, contour.nx, contour.ny].map(numbers);
  const { page, close } = await open(await report("demo/pocket"));
  const factor = Number(await page.inputValue("#magnify"));
  for (const name of ["before", "after"]) {
    await page.click(`label[for="shown-${name}"]`);
    const error = numbers(contour[name].error_mm);
    const arc = numbers(contour[name].arc_deg);
    for (const i of [450, 1400]) {
      const a = (arc[i] * Math.PI) / 360;
      const travel = job.wall === "right" ? [-ny[i], nx[i]] : [ny[i], -nx[i]];
      const out = job.tool.diameter_mm / 2;
      const centre = [x[i] - factor * error[i] * nx[i], y[i] - factor * error[i] * ny[i]];
      const place = [0, 1].map((k) => centre[k] + out * (Math.cos(a) * [nx[i], ny[i]][k] + Math.sin(a) * travel[k]));
      assert.deepEqual(await engaged(page, i, [place]), [true], `${name}, sample ${i}`);
    }
  }
  await close();
});

test("at a corner that the cutter goes round outside, the wall has its own corner and no loop", async () => {
  const { page, close } = await open(await report("island"));
  // The path turns at X46 Y26; the wall at X40 Y20. Beyond it, where the offsets of both sides would run on, there is nothing.
  const still = async (x, y) => {
    const at = await onPage(page, x, y);
    return page.locator(".stage:visible").first().evaluate((stage, [left, top]) => {
      const box = stage.getBoundingClientRect();
      const { data } = stage.querySelector("canvas").getContext("2d").getImageData(Math.round(left - box.left) - 2, Math.round(top - box.top) - 2, 5, 5);
      return Math.min(...Array.from({ length: 25 }, (_, k) => data[4 * k]));
    }, [at.x, at.y]);
  };
  assert.ok(await still(40, 15) < 80, "the wall is there");
  assert.ok(await still(35, 20) < 80, "and there");
  for (const [x, y] of [[40, 24], [44, 20], [43, 23]]) assert.ok(await still(x, y) > 150, `nothing at ${x}, ${y}`);
  await close();
});
