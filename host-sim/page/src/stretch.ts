/** The stretch of arc length that the traces show: by keys, and turned like a page when the cutter leaves it. */

import { between } from "./cutter";
import type { Model } from "./model";

type Range = [number, number] | null;

/** Stretch after a key; undefined for other keys. */
export function stretched(key: string, range: Range, model: Model, place: number): Range | undefined {
  const s = model.s.values;
  const [first, last] = [s[0], s[s.length - 1]];
  const [from, to] = range ?? [first, last];
  const wide = to - from;
  const about = Math.min(to, Math.max(from, between(s, place)));
  const scaled = (factor: number): Range => limited(about - (about - from) * factor, wide * factor, first, last);
  switch (key) {
    case "+": case "=": return scaled(0.5);
    case "-": case "_": return scaled(2);
    case "ArrowLeft": return limited(from - wide / 4, wide, first, last);
    case "ArrowRight": return limited(from + wide / 4, wide, first, last);
    case "0": return null;
    default: return undefined;
  }
}

/** The next stretch of the same length when the cutter has left this one. */
export function turned(range: Range, model: Model, place: number): Range {
  if (!range) return null;
  const s = model.s.values;
  const at = between(s, place);
  if (at >= range[0] && at <= range[1]) return range;
  return limited(at, range[1] - range[0], s[0], s[s.length - 1]);
}

function limited(from: number, wide: number, first: number, last: number): Range {
  if (wide >= last - first) return null;
  const kept = Math.max(wide, (last - first) * 1e-5);
  const start = Math.min(last - kept, Math.max(first, from));
  return [start, start + kept];
}
