/** Limits of the wall error, and where a deviation lies among them. */

import type { ProbePoint, Report } from "./data";
import { fixed, signed } from "./format";

export interface Limits { lower: number; upper: number; uncertainty: number | undefined }

/** Where a deviation lies: within, beyond a limit, undecided; or nothing is known of it. */
export type Standing = "within" | "left" | "gouge" | "open" | "aside" | "plain";

export function limitsOf(report: Report): Limits | undefined {
  const { limits, tolerance_mm: half } = report;
  if (limits) return { lower: limits.lower_mm, upper: limits.upper_mm, uncertainty: limits.uncertainty_mm };
  return half === undefined ? undefined : { lower: -half, upper: half, uncertainty: undefined };
}

export function limitsText({ lower, upper }: Limits): string {
  return lower === -upper ? `±${fixed(upper, 4)} mm` : `${signed(lower, 4)} … ${signed(upper, 4)} mm`;
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
