/** The wall unrolled under the deviations: where it was touched, contour by height, and what no point speaks for. */

import type { Report } from "./data";
import { el, svg } from "./dom";
import { sayAsGiven, sayError, stepDecimals, unitOf } from "./format";
import { limitsOf, standing } from "./limits";
import { markPath } from "./marks";
import { roundStep } from "./view";

const HEIGHT = 102;
const TOP = 8;
const BOTTOM = 6;

/** A line of words below a drawing, from its left edge to its right one; long ones wrap. */
export function beside(line: HTMLElement, edge: { left: number; right: number }): HTMLElement {
  line.style.paddingLeft = `${edge.left}px`;
  line.style.paddingRight = `${edge.right}px`;
  return line;
}

/** Heading, drawing and its key; nothing where the heights are not known. `px` is the place of an arc length. */
export function face(report: Report, width: number, edge: { left: number; right: number }, px: (s: number) => number): Element[] {
  const { coverage, points = [] } = report;
  const wall = coverage?.face;
  if (!coverage || !wall || !(wall.depth_mm > 0)) return [];
  const touched = points.filter((p) => p.s_mm !== undefined && p.error_mm !== undefined && p.z_mm !== undefined);
  const floor = HEIGHT - BOTTOM;
  const py = (z: number) => TOP + (1 - z / wall.depth_mm) * (floor - TOP);
  const open = wall.layers.flatMap((layer) => layer.stretches.map((stretch) => ({ layer, stretch })));
  const picture = svg("svg", { class: "face", width, height: HEIGHT, viewBox: `0 0 ${width} ${HEIGHT}`, role: "img",
    "aria-label": `The wall unrolled, arc length by height: ${touched.length} points${open.length ? ", grey where no point speaks for it" : ", all of it within reach of one"}` });
  for (const { layer, stretch } of open) {
    picture.append(svg("rect", { class: "unmeasured", x: px(stretch.from_mm), width: Math.max(0, px(stretch.to_mm) - px(stretch.from_mm)),
      y: py(layer.to_mm), height: py(layer.from_mm) - py(layer.to_mm) }));
  }
  const step = roundStep(wall.depth_mm / 3);
  for (let k = 0; k * step <= wall.depth_mm * (1 + 1e-9); k++) {
    picture.append(svg("path", { class: "rule", d: `M${edge.left} ${py(k * step)}H${width - edge.right}` }));
    picture.append(svg("text", { x: edge.left - 6, y: py(k * step) + 4, "text-anchor": "end" }, sayError(k * step, stepDecimals(step))));
  }
  picture.append(svg("path", { class: "tick", d: `M${edge.left} ${TOP}V${floor}H${width - edge.right}V${TOP}Z` }));
  const limits = limitsOf(report);
  for (const p of touched) {
    const where = standing(p, limits);
    picture.append(svg("path", { class: `mark ${where}`, d: markPath(where, px(p.s_mm as number), py(p.z_mm as number), 4) }));
  }
  const axis = beside(el("p", { class: "chart-axis" }, `height above the cutter's tip, ${unitOf()}, over the same arc length`), edge);
  const key = svg("svg", { width: 16, height: 12, "aria-hidden": "true" });
  key.append(svg("rect", { class: "unmeasured", width: 16, height: 12 }));
  const words = `farther than ${sayAsGiven(coverage.reach_mm)} along the contour or ${sayAsGiven(wall.reach_mm)} in height from every measured place`;
  return [el("h3", {}, "Where the wall was touched"), picture, axis, ...(open.length ? [el("p", { class: "chart-key" }, el("span", {}, key, words))] : [])];
}
