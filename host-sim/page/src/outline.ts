/** Wall and stock beside the contour: from the data, otherwise from normals, radius and allowance. */

import type { Polyline } from "./data";
import { decode } from "./decode";
import type { Path } from "./model";
import type { Box } from "./view";

export interface Line { x: Float64Array; y: Float64Array }

export function offsetOf(model: Path, distance: number): Line {
  const { values: x } = model.x;
  const { values: y } = model.y;
  return { x: x.map((v, i) => v + distance * model.nx[i]), y: y.map((v, i) => v + distance * model.ny[i]) };
}

export function outline(given: Polyline[] | undefined, name: string): Line[] | undefined {
  return given?.map((line, i) => {
    const x = decode(line.x_mm, `${name}[${i}].x_mm`).values;
    return { x, y: decode(line.y_mm, `${name}[${i}].y_mm`, x.length).values };
  });
}

export function boxOf(lines: Line[], margin: number): Box {
  const box = { x0: Infinity, y0: Infinity, x1: -Infinity, y1: -Infinity };
  for (const { x, y } of lines) {
    for (let i = 0; i < x.length; i++) {
      box.x0 = Math.min(box.x0, x[i] - margin);
      box.x1 = Math.max(box.x1, x[i] + margin);
      box.y0 = Math.min(box.y0, y[i] - margin);
      box.y1 = Math.max(box.y1, y[i] + margin);
    }
  }
  return Number.isFinite(box.x0 + box.x1 + box.y0 + box.y1) ? box : { x0: 0, y0: 0, x1: 1, y1: 1 };
}
