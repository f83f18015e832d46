// A wall that is known everywhere.
import { column } from "./columns.mjs";

/**
 * A wall of 100 mm and 10 mm, sampled ten times as densely on its first tenth, at three heights that lie unevenly.
 * Before: leans from −0.04 mm at the tip to 0.06 mm at the top. After: 0.01 mm everywhere, none on the last fifth.
 */
export function leaning(more = {}) {
  const s = [...Array.from({ length: 100 }, (_, i) => i * 0.1), ...Array.from({ length: 91 }, (_, i) => 10 + i)];
  const z = [0, 2, 10];
  const each = (f) => column(s.map(f));
  const over = (f) => column(s.flatMap((at) => z.map((height) => f(at, height))));
  return {
    version: 1, kind: "correct", title: "Leaning", job: { wall: "right", tool: { diameter_mm: 6 }, cut: { feed_mm_per_min: 600 } },
    contour: { s_mm: each((v) => v), x_mm: each((v) => v), y_mm: each(() => 0), before: { error_mm: each(() => 0.01) }, after: { error_mm: each(() => 0.01) } },
    heights: { z_mm: z, stride: 1, before: over((_, height) => -0.04 + 0.01 * height), after: over((at) => (at > 80 ? NaN : 0.01)) }, ...more,
  };
}
