/** Limits of the wall error, and where a deviation lies among them. */

import type { ProbePoint, Report } from "./data";
import { fine, LENGTH, per, sayDeviation, sayError, withUnit } from "./format";

export interface Limits { lower: number; upper: number; uncertainty: number | undefined }

/** Where a deviation lies: within, beyond a limit, undecided; or nothing is known of it. */
export type Standing = "within" | "left" | "gouge" | "open" | "aside" | "plain";

export function limitsOf(report: Report): Limits | undefined {
  const { limits, tolerance_mm: half } = report;
  if (limits) return { lower: limits.lower_mm, upper: limits.upper_mm, uncertainty: limits.uncertainty_mm };
  return half === undefined ? undefined : { lower: -half, upper: half, uncertainty: undefined };
}

/** The fewest decimals that hold, up to a hundredth of a micrometre. */
function fewest(decimals: number, holds: (decimals: number) => boolean): number {
  return decimals >= fine(5) || holds(decimals) ? decimals : fewest(decimals + 1, holds);
}

/** Decimals that tell limits and uncertainty with all of their digits: a micrometre, a tenth of a thousandth, or more. */
export function limitDecimals({ lower, upper, uncertainty = 0 }: Limits): number {
  const all = [lower, upper, uncertainty].map((v) => v / per());
  return fewest(per() > 1 ? 4 : LENGTH, (decimals) => all.every((v) => Math.abs(v - Number(v.toFixed(decimals))) < 1e-9));
}

export function limitsText(limits: Limits): string {
  const { lower, upper } = limits;
  const decimals = limitDecimals(limits);
  return withUnit(lower === -upper ? `±${sayError(upper, decimals)}` : `${sayDeviation(lower, decimals)} … ${sayDeviation(upper, decimals)}`);
}

/** As many decimals as it takes, so that no deviation is rounded to the other side of a limit. */
export function decimalsTelling(points: ProbePoint[], limits: Limits | undefined): number {
  if (!limits) return fine();
  const nm = (mm: number) => Math.round(mm * 1e6);
  const [lower, upper, guard] = [nm(limits.lower), nm(limits.upper), nm(limits.uncertainty ?? 0)];
  const side = (e: number) => (e > upper + guard || e < lower - guard ? 2 : e <= upper - guard && e >= lower + guard ? 0 : 1);
  const errors = points.flatMap((p) => (p.error_mm === undefined ? [] : [p.error_mm]));
  return fewest(fine(), (decimals) => errors.every((e) => side(nm(e)) === side(nm(Number((e / per()).toFixed(decimals)) * per()))));
}

export function standing(point: ProbePoint, limits: Limits | undefined): Standing {
  const { error_mm: error, verdict } = point;
  if (point.status !== "used" || error === undefined) return "aside";
  if (!limits) return "plain";
  if (verdict === "open") return "open";
  const within = verdict ? verdict === "pass" : error <= limits.upper && error >= limits.lower;
  return within ? "within" : error > limits.upper ? "left" : "gouge";
}

/** What is known of a point in words; letters tell what colours tell. */
export function verdictWord(point: ProbePoint, limits: Limits | undefined): string {
  const words: Record<Standing, string> = {
    within: "pass", left: "fail, left", gouge: "fail, too deep", open: "undecided", aside: "not judged", plain: "not judged",
  };
  return words[standing(point, limits)];
}
