/** Where the wall is worst: at any height where the error over the height is known, otherwise of the mean. */

import type { Limits } from "./limits";
import type { Model, Pass } from "./model";

/** A place of the wall: sample, height (null: mean over the height, or the only one there is), error. */
export interface Place { index: number; height: number | null; error: number }

/** Largest and smallest error of every sample over the heights, and at which height. NaN where nothing is known. */
export interface Extremes { high: Float64Array; low: Float64Array; highAt: Int8Array; lowAt: Int8Array }

/** Errors of a pass at every height; without them the mean alone, as height −1. Undefined where no error is known. */
export function extremes(model: Model, pass: Pass): Extremes | undefined {
  const heights = model.report.heights?.z_mm ?? [];
  const layers = heights.flatMap((_, k) => { const e = model.error(pass.name, k); return e ? [{ k, e }] : []; });
  const mean = model.error(pass.name, null);
  if (layers.length === 0 && mean) layers.push({ k: -1, e: mean });
  if (layers.length === 0) return undefined;
  const found = { high: new Float64Array(model.count).fill(NaN), low: new Float64Array(model.count).fill(NaN), highAt: new Int8Array(model.count), lowAt: new Int8Array(model.count) };
  for (const { k, e } of layers) {
    for (let i = 0; i < model.count; i++) {
      if (!(e[i] <= found.high[i])) if (Number.isFinite(e[i])) [found.high[i], found.highAt[i]] = [e[i], k];
      if (!(e[i] >= found.low[i])) if (Number.isFinite(e[i])) [found.low[i], found.lowAt[i]] = [e[i], k];
    }
  }
  return found;
}

/** How far a sample lies beyond the limits; without limits the size of its error. NaN where nothing is known. */
function beyond({ high, low }: Extremes, i: number, limits: Limits | undefined): number {
  return limits ? Math.max(high[i] - limits.upper, limits.lower - low[i]) : Math.max(Math.abs(high[i]), Math.abs(low[i]));
}

function placeOf({ high, low, highAt, lowAt }: Extremes, index: number, limits: Limits | undefined): Place {
  const left = limits ? high[index] - limits.upper >= limits.lower - low[index] : Math.abs(high[index]) >= Math.abs(low[index]);
  const at = left ? highAt[index] : lowAt[index];
  return { index, height: at < 0 ? null : at, error: left ? high[index] : low[index] };
}

/** Arc length below which two places are one, mm: half of the cutter, a millimetre at least. */
function apart(model: Model): number {
  return Math.max(1, model.radius);
}

/** By how much a pass leaves the limits, at how many places; nought where it holds them. Undefined where nothing is known. */
export function outside(model: Model, pass: Pass, limits: Limits): { by: number; places: number } | undefined {
  const found = extremes(model, pass);
  if (!found) return undefined;
  const s = model.s.values;
  let [by, places, first, last] = [0, 0, NaN, NaN];
  for (let i = 0; i < model.count; i++) {
    const excess = beyond(found, i, limits);
    if (!(excess > 0)) continue;
    by = Math.max(by, excess);
    if (!(s[i] - last <= apart(model))) places++;
    if (Number.isNaN(first)) first = s[i];
    last = s[i];
  }
  // Of a closed contour the end goes on at the start.
  if (places > 1 && model.closed && first - s[0] + s[model.count - 1] - last <= apart(model)) places--;
  return { by, places };
}

/** The probability that the limits are held where that is least certain; undefined without standard deviations. */
export function holding(model: Model, pass: Pass, limits: Limits): number | undefined {
  const found = extremes(model, pass);
  const sigma = pass.series.sigma_mm?.values;
  if (!found || !sigma) return undefined;
  let least = 1;
  for (let i = 0; i < model.count; i++) {
    if (Number.isNaN(found.high[i]) || Number.isNaN(sigma[i])) continue;
    const above = below((limits.upper - found.high[i]) / sigma[i], limits.upper >= found.high[i]);
    const under = below((found.low[i] - limits.lower) / sigma[i], found.low[i] >= limits.lower);
    least = Math.min(least, Math.max(0, above + under - 1));
  }
  return least;
}

/** Share of a normal distribution below so many standard deviations (Abramowitz and Stegun 26.2.17, error below 1e-7). */
function below(deviations: number, certain: boolean): number {
  if (!Number.isFinite(deviations)) return certain ? 1 : 0;
  const t = 1 / (1 + 0.2316419 * Math.abs(deviations));
  const series = t * (0.319381530 + t * (-0.356563782 + t * (1.781477937 + t * (-1.821255978 + t * 1.330274429))));
  const above = (Math.exp((-deviations * deviations) / 2) / Math.sqrt(2 * Math.PI)) * series;
  return deviations > 0 ? 1 - above : above;
}

/** The worst places of a pass, the worst first: each the largest of its surroundings. */
export function worstPlaces(model: Model, pass: Pass, limits: Limits | undefined, most: number): Place[] {
  const found = extremes(model, pass);
  if (!found) return [];
  const s = model.s.values;
  const order = Array.from({ length: model.count }, (_, i) => i).filter((i) => !Number.isNaN(beyond(found, i, limits)));
  order.sort((a, b) => beyond(found, b, limits) - beyond(found, a, limits));
  const room = Math.max(apart(model), model.length / 40);
  const length = s[model.count - 1] - s[0];
  const picked: Place[] = [];
  for (const i of order) {
    const place = placeOf(found, i, limits);
    // What is left is small beside the worst.
    if (picked.length === most || Math.abs(place.error) < 0.1 * Math.abs(picked[0]?.error ?? 0)) break;
    const near = picked.some(({ index }) => {
      const d = Math.abs(s[index] - s[i]);
      return d < room || (model.closed && length - d < room);
    });
    if (!near && peak(found, i, limits, model)) picked.push(place);
  }
  return picked;
}

/** Whether no sample beside is worse: the flank of a place already named is no place of its own. */
function peak(found: Extremes, i: number, limits: Limits | undefined, model: Model): boolean {
  const here = beyond(found, i, limits);
  const [a, b] = [i - 1, i + 1].map((k) => (k < 0 || k >= model.count ? -Infinity : beyond(found, k, limits)));
  return !(a > here) && !(b > here);
}
