/** The sample of the contour that a place in the picture belongs to. */

import { levelFor } from "./draw";
import type { Model } from "./model";
import type { Line } from "./outline";
import type { View } from "./view";

/** Pixels within which a place belongs to path or wall. */
const REACH = 40;

/**
 * The sample nearest along path or wall, within reach of a place in pixels.
 *
 * Distances are those to the straight pieces between samples: zoomed in, the samples themselves lie far apart.
 */
export function nearestSample(model: Model, wall: Line, view: View, px: number, py: number): number | null {
  const [x, y] = [view.mmX(px), view.mmY(py)];
  const path = { x: model.x.values, y: model.y.values };
  const indices = levelFor(model, view);
  let least = (REACH / view.scale) ** 2;
  let best: number | null = null;
  for (const line of [path, wall]) {
    for (let k = 1; k < indices.length; k++) {
      const [i, j] = [indices[k - 1], indices[k]];
      const [dx, dy] = [line.x[j] - line.x[i], line.y[j] - line.y[i]];
      const [ex, ey] = [x - line.x[i], y - line.y[i]];
      const along = Math.min(1, Math.max(0, (ex * dx + ey * dy) / (dx * dx + dy * dy) || 0));
      const distance = (ex - along * dx) ** 2 + (ey - along * dy) ** 2;
      if (distance < least) [least, best] = [distance, along < 0.5 ? i : j];
    }
  }
  return best;
}
