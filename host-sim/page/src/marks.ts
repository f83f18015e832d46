/** The marks of probe points: shapes that can be told apart without colour, in the picture, the chart and the table. */

import type { Standing } from "./limits";
import type { Palette } from "./palette";

type Corner = [number, number];

/** Corners in units of the mark's radius, y down; none: a circle. */
const SHAPES: Record<Standing, Corner[]> = {
  within: [], plain: [],
  left: [[0, -1.3], [1.2, 0.9], [-1.2, 0.9]],
  gouge: [[0, 1.3], [1.2, -0.9], [-1.2, -0.9]],
  open: [[0, -1.35], [1.35, 0], [0, 1.35], [-1.35, 0]],
  aside: [[-1, -1], [1, 1], [0, 0], [1, -1], [-1, 1], [0, 0]],
};

export const SIGNS: Record<Standing, string> = { within: "●", plain: "○", left: "▲", gouge: "▼", open: "◆", aside: "×" };

export function fillOf(standing: Standing, colours: Palette): string {
  if (standing === "within" || standing === "left" || standing === "gouge") return colours[standing];
  return standing === "open" ? colours.first : colours.ground;
}

/** Traces and draws a mark around a place. */
export function drawMark(c: CanvasRenderingContext2D, standing: Standing, x: number, y: number, radius: number): void {
  const corners = SHAPES[standing];
  c.beginPath();
  if (corners.length === 0) c.arc(x, y, radius, 0, 2 * Math.PI);
  corners.forEach(([dx, dy], i) => (i ? c.lineTo(x + radius * dx, y + radius * dy) : c.moveTo(x + radius * dx, y + radius * dy)));
  if (corners.length) c.closePath();
  if (standing !== "aside") c.fill();
  c.stroke();
}

/** The same as the outline of an SVG path. */
export function markPath(standing: Standing, x: number, y: number, radius: number): string {
  const corners = SHAPES[standing];
  const at = (dx: number, dy: number) => `${(x + radius * dx).toFixed(2)} ${(y + radius * dy).toFixed(2)}`;
  if (corners.length) return `M${corners.map(([dx, dy]) => at(dx, dy)).join("L")}Z`;
  return `M${at(-1, 0)}a${radius} ${radius} 0 1 0 ${2 * radius} 0a${radius} ${radius} 0 1 0 ${-2 * radius} 0Z`;
}
