// Makes samples/corner.json and samples/pocket.json from the tables of the demonstration in samples/raw:
//   before.csv, after.csv   trace.csv of `simulate --plant`, of the original and of the corrected program
//   correction.csv, points.csv, summary.json   as `correct` writes them
// The program writes such data itself; this is for the tests of the page and as an example of the format.
import { readFile, writeFile } from "node:fs/promises";
import { fileURLToPath } from "node:url";

const here = fileURLToPath(new URL(".", import.meta.url));

/** Text of a table as columns of numbers as they are written. */
export function parse(text) {
  const [head, ...rows] = text.trim().split("\n").map((line) => line.split(","));
  return Object.fromEntries(head.map((name, i) => [name, rows.map((row) => row[i])]));
}

/** A compact column, with as many decimals as its longest number. */
export function column(values) {
  const decimals = Math.max(...values.map((v) => decimalsOf(v)));
  const bytes = Buffer.alloc(values.length * 4);
  values.forEach((v, i) => bytes.writeInt32LE(v === "" || Number.isNaN(Number(v)) ? -2147483648 : Math.round(Number(v) * 10 ** decimals), 4 * i));
  return { decimals, data: bytes.toString("base64") };
}

function decimalsOf(text) {
  const exponent = /e-(\d+)$/.exec(text);
  if (exponent) return Number(exponent[1]) + (/\.(\d+)e/.exec(text)?.[1].replace(/0+$/, "").length ?? 0);
  return (/\.(\d+)$/.exec(text)?.[1] ?? "").replace(/0+$/, "").length;
}

const QUANTITIES = ["arc_deg", "chip_area_mm2", "force_n", "fx_n", "fy_n", "dx_mm", "dy_mm"];

/** The pass of the corrected program at the samples of the original: its nearest sample ahead. */
function follow(after, x, y) {
  const px = after.x_mm.map(Number);
  const py = after.y_mm.map(Number);
  let from = 0;
  return x.map((_, i) => {
    let best = from;
    let least = Infinity;
    for (let k = from; k < Math.min(from + 60, px.length); k++) {
      const distance = Math.hypot(px[k] - x[i], py[k] - y[i]);
      if (distance < least) [best, least] = [k, distance];
    }
    from = best;
    return best;
  });
}

async function sample(name, facts) {
  const read = (file) => readFile(`${here}raw/${name}/${file}`, "utf8");
  const before = parse(await read("before.csv"));
  const after = parse(await read("after.csv"));
  const correction = parse(await read("correction.csv"));
  const points = parse(await read("points.csv"));
  const summary = JSON.parse(await read("summary.json"));
  const x = correction.x_mm.map((v, i) => Number(v) + Number(correction.dx_mm[i]));
  const y = correction.y_mm.map((v, i) => Number(v) + Number(correction.dy_mm[i]));
  const at = follow(after, x, y);
  const cut = Object.fromEntries(QUANTITIES.map((q) => [q, at.map((k) => after[q][k])]));
  // The wall that the corrected pass leaves beside the wanted one: what is left of correction and deflection.
  const normal = normals(correction, facts.job.wall);
  const left = at.map((_, i) => (-(normal[i][0] * (Number(correction.dx_mm[i]) + Number(cut.dx_mm[i]))
    + normal[i][1] * (Number(correction.dy_mm[i]) + Number(cut.dy_mm[i])))).toFixed(6));
  const largest = (values) => Math.max(...values.map((v) => Math.abs(Number(v))));
  const tolerance = facts.tolerance_mm;
  const worst = largest(left);
  return {
    version: 1,
    kind: "correct",
    by: "truepath 0.1.0",
    ...facts,
    program: { name: "program.nc", crc32: summary.program_crc32 },
    contour: {
      s_mm: column(correction.s_mm), x_mm: column(correction.x_mm), y_mm: column(correction.y_mm),
      correction_x_mm: column(correction.dx_mm), correction_y_mm: column(correction.dy_mm),
      before: {
        label: "uncorrected, cut by the virtual machine", error_mm: column(before.error_mm),
        ...Object.fromEntries(QUANTITIES.map((q) => [q, column(before[q])])),
      },
      after: {
        label: "corrected, cut by the virtual machine", error_mm: column(left), sigma_mm: column(correction.sigma_mm),
        ...Object.fromEntries(QUANTITIES.map((q) => [q, column(cut[q])])),
      },
    },
    points: points.line.map((line, i) => ({
      line: Number(line), status: points.status[i] === "used" ? "used" : "aside", ...(points.reason[i] ? { reason: points.reason[i] } : {}),
      s_mm: Number(points.s_mm[i]), x_mm: Number(points.x_mm[i]), y_mm: Number(points.y_mm[i]),
      z_mm: Number((Number(points.height[i]) * facts.job.cut.axial_depth_mm).toFixed(3)),
      nx: Number(points.nx[i]), ny: Number(points.ny[i]), error_mm: Number(points.error_mm[i]),
    })),
    parameters: Object.entries(summary.identified).map(([parameter, values]) => ({ name: parameter, ...values })),
    results: [
      { name: "largest error before", value: largest(before.error_mm), decimals: 4, unit: "mm" },
      { name: "largest error after", value: worst, decimals: 4, unit: "mm" },
      { name: "standard deviation there", value: summary.sigma_at_max_error_mm, decimals: 4, unit: "mm" },
      { name: "spread over the height", value: summary.axial_form_error_mm, decimals: 4, unit: "mm" },
      { name: "largest correction", value: summary.max_correction_mm, decimals: 4, unit: "mm" },
      { name: "residual of the fit", value: summary.fit_residual_mm, decimals: 4, unit: "mm" },
    ],
    verdict: worst <= tolerance
      ? { state: "pass", text: `corrected wall within ±${tolerance.toFixed(3)} mm` }
      : { state: "fail", text: `corrected wall outside ±${tolerance.toFixed(3)} mm` },
    warnings: summary.warnings,
  };
}

function normals(table, wall) {
  const x = table.x_mm.map(Number);
  const y = table.y_mm.map(Number);
  const turn = wall === "left" ? -1 : 1;
  return x.map((_, i) => {
    const a = Math.max(0, i - 1);
    const b = Math.min(x.length - 1, i + 1);
    const size = Math.hypot(x[b] - x[a], y[b] - y[a]);
    return [turn * (y[b] - y[a]) / size, -turn * (x[b] - x[a]) / size];
  });
}

export const FACTS = {
  corner: {
    title: "Inside corner of the papers, steel 40",
    tolerance_mm: 0.03,
    job: {
      wall: "right", milling: "climb", material: "steel 40",
      tool: { diameter_mm: 20, teeth: 6, helix_deg: 30 },
      cut: { axial_depth_mm: 10, feed_mm_per_min: 400, spindle_rpm: 1500 }, stock: { allowance_mm: 3 },
      facts: [{ name: "law", value: "model, mean" }, { name: "probe ball", value: "⌀ 6 mm" }],
    },
  },
  pocket: {
    title: "Finishing pass round a pocket",
    tolerance_mm: 0.02,
    job: {
      wall: "right", milling: "climb",
      tool: { diameter_mm: 10, teeth: 4, helix_deg: 38 },
      cut: { axial_depth_mm: 12, feed_mm_per_min: 600, spindle_rpm: 3200 }, stock: { allowance_mm: 0.8 },
      facts: [{ name: "law", value: "model, helical" }, { name: "probe ball", value: "⌀ 4 mm" }],
    },
  },
};

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  for (const [name, facts] of Object.entries(FACTS)) {
    await writeFile(`${here}${name}.json`, `${JSON.stringify(await sample(name, facts))}\n`);
  }
}
