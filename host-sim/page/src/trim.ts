/**
 * A line beside the path, without the loops that no wall has.
 *
 * Where the path turns towards the wall more sharply than the cutter's radius, the places at the radius from it run past
 * their own crossing and back. Those nearer to the path than the line is meant to be are put onto the crossing.
 * Limit: only crossings of the path with itself within two radii are looked for, and only at the first so many corners.
 */

import type { Path } from "./model";
import type { Line } from "./outline";

/** Comparisons at most: a fraction of a second. */
const WORK = 2e7;
/** What a line may be nearer to the path than it is meant to be, mm. */
const SLACK = 1e-3;

export interface Trimmed extends Line {
  /** 1 where a sample has no place on the line of its own. */
  gone: Uint8Array;
}

export function trimmed(model: Path, line: Line, distance: number): Trimmed {
  const result = { x: line.x.slice(), y: line.y.slice(), gone: new Uint8Array(model.count) };
  if (!(distance > 0)) return result;
  let work = 0;
  for (let i = 1; i < model.count && work < WORK; i++) {
    if (!backwards(model, line, i)) continue;
    const [first, last] = reach(model, i, 2 * distance);
    for (let k = first; k <= last; k++) if (tooNear(model, line, k, first, last, distance)) result.gone[k] = 1;
    work += (last - first) ** 2;
    while (i < last && backwards(model, line, i + 1)) i++;
  }
  toCrossings(result);
  return result;
}

/** Whether the line runs against the path from the sample before to this one. */
function backwards(model: Path, line: Line, i: number): boolean {
  const dx = line.x[i] - line.x[i - 1];
  const dy = line.y[i] - line.y[i - 1];
  // Direction of travel, at a right angle to the mean of both normals: also where samples stand on one spot.
  const tx = -model.turn * (model.ny[i] + model.ny[i - 1]);
  const ty = model.turn * (model.nx[i] + model.nx[i - 1]);
  return dx * tx + dy * ty < -1e-9;
}

/** The samples within an arc length of one. */
function reach(model: Path, i: number, length: number): [number, number] {
  const s = model.s.values;
  return [model.indexAt(s[i] - length), model.indexAt(s[i] + length)];
}

function tooNear(model: Path, line: Line, k: number, first: number, last: number, distance: number): boolean {
  const least = (distance - SLACK) ** 2;
  for (let j = first; j <= last; j++) {
    if ((model.x.values[j] - line.x[k]) ** 2 + (model.y.values[j] - line.y[k]) ** 2 < least) return true;
  }
  return false;
}

/** Every run of samples without a place goes to the middle between its neighbours, which is where the line crosses itself. */
function toCrossings(line: Trimmed): void {
  const { x, y, gone } = line;
  for (let i = 0; i < gone.length; i++) {
    if (!gone[i]) continue;
    const before = i - 1;
    let after = i;
    while (after < gone.length && gone[after]) after++;
    const a = before >= 0 ? before : after;
    const b = after < gone.length ? after : before;
    if (a >= 0 && b >= 0 && a < gone.length) {
      const [cx, cy] = [(x[a] + x[b]) / 2, (y[a] + y[b]) / 2];
      for (let k = i; k < after; k++) [x[k], y[k]] = [cx, cy];
    }
    i = after;
  }
}
