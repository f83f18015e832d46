/** The verdict in one sentence, three figures, one next step. */

import type { Report, Result, WallFigures } from "./data";
import { el, type Said } from "./dom";
import { say, sayError, sigmaText, withUnit } from "./format";
import { limitDecimals, limitsOf, limitsText, standing, type Limits } from "./limits";
import type { Model, Pass } from "./model";
import { holding, outside } from "./places";

/** A figure as it is read: its name, its value with unit, a word on it. */
export interface Figure { name: string; value: Said; note?: Said }

const mm = (value: number | undefined) => withUnit(sayError(value));

/** "97 %": whole percent, rounded so that nothing is promised that is not held. */
export function percent(share: number): string {
  if (share >= 0.995) return "more than 99 %";
  return share < 0.01 ? "less than 1 %" : `${Math.floor(share * 100)} %`;
}

function places(count: number): string {
  return count === 1 ? "at one place" : `at ${count} places`;
}

/** "out of tolerance by 0.030 mm at 3 places", "within tolerance". */
function stands({ by, places: count }: { by: number; places: number }): string {
  return count === 0 ? "within tolerance" : `out of tolerance by ${mm(Math.max(by, 0.001))} ${places(count)}`;
}

/** What two standard deviations leave open. */
function give(sigma: number | undefined): string {
  return sigma === undefined ? "" : ` ± ${sigmaText(2 * sigma)}`;
}

/** "0.135 → 0.009 ± 0.002 mm", or the one that is known. */
function fall(before: number | undefined, after: number | undefined, sigma: number | undefined): string {
  const [a, b] = [before, after].map((v) => (v === undefined ? "" : sayError(v)));
  return withUnit([a, b].filter(Boolean).join(" → ") + give(sigma));
}

/** The sentence on top; undefined where nothing is known. */
export function sentence(report: Report, model: Model | null): string | undefined {
  const limits = limitsOf(report);
  if (report.kind === "inspect") return inspected(report, limits);
  const { outlook, told } = report;
  const [now, next] = [model?.compared[0], model?.compared[1]];
  if (limits && model && now) {
    const judged = ofTolerance(report, model, now, next, limits);
    if (judged) return judged;
  }
  if (!outlook) return told && say(told);
  const { now: before, next: after, floor_mm: floor } = outlook;
  if (!after) {
    const worst = before.worst_mm === undefined ? "" : ` and ${mm(before.worst_mm)} at the worst height`;
    return `This pass leaves the wall off by up to ${mm(before.mean_mm)}, mean over the height${worst}.`;
  }
  const who = outlook.cut ? "As cut" : report.kind === "learn" && now && next ? `From ${now.title} to ${next.title}, predicted` : "Predicted with the correction";
  const sigmas = after.worst_sigma_mm === undefined ? "" : " (2 sigma)";
  const below = floor === undefined ? "" : `; floor, to which machine and probe repeat: ${mm(floor)} (1 sigma)`;
  return `${who}: mean over the height ${fall(before.mean_mm, after.mean_mm, after.mean_sigma_mm)}, worst at any height ${fall(before.worst_mm, after.worst_mm, after.worst_sigma_mm)}${sigmas}${below}.`;
}

function ofTolerance(report: Report, model: Model, now: Pass, next: Pass | undefined, limits: Limits): string | undefined {
  const was = outside(model, now, limits);
  const will = next && outside(model, next, limits);
  if (!was) return undefined;
  const named = report.kind === "learn";
  const subject = named ? capital(now.title) : report.kind === "simulate" ? "This wall" : "Uncorrected, this wall";
  const first = `${subject} is ${stands(was)}`;
  if (!next || !will) return `${first}.`;
  const share = holding(model, next, limits);
  const corrected = named ? next.title : "the corrected program";
  const certain = share === undefined ? "" : `, with ${percent(share)} where that is least certain`;
  if (will.places === 0) return `${first}; ${corrected} is predicted to hold it${certain}.`;
  const chance = share === undefined ? "" : ` (held with ${percent(share)})`;
  return `${first}; ${corrected} is predicted to miss it by ${mm(Math.max(will.by, 0.001))} ${places(will.places)}${chance}.`;
}

function inspected(report: Report, limits: Limits | undefined): string | undefined {
  const { outlook, verdict, told } = report;
  const points = (report.points ?? []).filter((p) => p.status === "used" && p.error_mm !== undefined);
  if (points.length === 0) return say(verdict?.text ?? told ?? "");
  const all = points.length === 1 ? "the one measured point" : `all ${points.length} measured points`;
  if (limits && verdict) {
    const of = (kinds: string[]) => points.filter((p) => kinds.includes(standing(p, limits)));
    const [failed, undecided] = [of(["left", "gouge"]), of(["open"])];
    const by = failed.reduce((most, { error_mm: e = 0 }) => Math.max(most, e - limits.upper, limits.lower - e), 0);
    if (verdict.state === "fail") return `This wall is out of tolerance by ${mm(Math.max(by, 0.001))} at ${failed.length} of ${points.length} measured points.`;
    if (verdict.state === "pass") return `This wall is within tolerance at ${all}.`;
    if (undecided.length > 0) return `Not decided: ${undecided.length} of ${points.length} measured points lie closer to a limit than the uncertainty.`;
    const text = say(verdict.text);
    return `Not decided: ${text.replace(/^\w+: /, "")}${text.endsWith(".") ? "" : "."}`;
  }
  if (!outlook) return told && say(told);
  const { now } = outlook;
  const sigmas = now.worst_sigma_mm === undefined ? "" : " (2 sigma)";
  return `At ${points.length} measured points this wall is off by up to ${fall(now.worst_mm, undefined, now.worst_sigma_mm)}${sigmas}; the largest mean over the touched heights of a place is ${mm(now.mean_mm)}.`;
}

function capital(text: string): string {
  return text.charAt(0).toUpperCase() + text.slice(1);
}

/** The three figures: worst at any height, mean over the height, and what they are held against. */
export function three(report: Report, model: Model | null, rest: Result[], told: (r: Result) => Figure): Figure[] {
  const { outlook } = report;
  const limits = limitsOf(report);
  const against: Figure[] = limits ? [held(report, model, limits)] : [];
  if (!outlook) return [...against, ...rest.map(told)].slice(0, 3);
  const { now, next, floor_mm: floor } = outlook;
  const shown = next ?? now;
  const inspects = report.kind === "inspect";
  const figure = (name: string, key: "worst_mm" | "mean_mm", sigma: keyof WallFigures): Figure[] => (shown[key] === undefined ? [] : [{
    name, value: () => fall(shown[key], undefined, shown[sigma]),
    note: () => [next && now[key] !== undefined ? `${mm(now[key])} before` : "", shown[sigma] === undefined ? "" : "2 sigma"].filter(Boolean).join("; "),
  }]);
  const figures = [
    ...figure(inspects ? "worst at a touched height" : "worst at any height", "worst_mm", "worst_sigma_mm"),
    ...figure("mean over the height", "mean_mm", "mean_sigma_mm"),
    ...against,
    ...(!limits && floor !== undefined ? [{ name: "floor", value: () => mm(floor), note: "1 sigma; to which machine and probe repeat" }] : []),
  ];
  return [...figures, ...rest.map(told)].slice(0, 3);
}

function held(report: Report, model: Model | null, limits: Limits): Figure {
  const next = report.kind === "inspect" ? undefined : model?.compared[1];
  const share = model && next ? holding(model, next, limits) : undefined;
  const notes = () => [limits.uncertainty === undefined ? "" : `uncertainty ±${withUnit(sayError(limits.uncertainty, limitDecimals(limits)))}, k = 2`,
    report.limits?.from ?? "", share === undefined ? "" : `held with ${percent(share)}`].filter(Boolean).join("; ");
  return { name: "tolerance", value: () => limitsText(limits), note: notes };
}

/** What to do next. */
export function nextStep({ next }: Report): HTMLElement | null {
  if (!next) return null;
  return el("p", { class: "next" }, el("strong", {}, "Next: "), next.what ? `${next.what} ` : "", el("code", {}, next.command));
}

/** Of several contours: how many are out of tolerance, and the worst of all. */
export function ofSeveral(all: { name: string; report: Report }[]): string | undefined {
  const foretold = all[0].report.kind !== "inspect";
  const judged = all.filter(({ report }) => report.verdict);
  // What is foretold misses its tolerance where it is expected beyond it, also where that is not certain.
  const misses = ({ report: { verdict, outlook, ...report } }: { report: Report }) => {
    const limits = limitsOf(report as Report);
    return verdict?.state === "fail" || (foretold && limits !== undefined && (outlook?.next?.worst_mm ?? 0) > Math.max(limits.upper, -limits.lower));
  };
  const failed = judged.filter(misses).length;
  const open = judged.filter(({ report }) => report.verdict?.state === "open").length;
  const counts = judged.length === 0 ? "" : failed > 0 ? `${failed} of ${all.length} contours ${foretold ? "are predicted to miss their tolerance" : "are out of tolerance"}`
    : open > 0 && !foretold ? `${open} of ${all.length} contours are not decided`
    : foretold ? `All ${all.length} contours are predicted to hold their tolerance` : `All ${all.length} contours are within tolerance at their measured points`;
  const known = all.filter(({ report }) => report.outlook);
  const size = ({ report: { outlook } }: { report: Report }) => (outlook?.next ?? outlook?.now)?.worst_mm ?? (outlook?.next ?? outlook?.now)?.mean_mm ?? -1;
  if (known.length === 0) return counts ? `${counts}.` : undefined;
  const worst = known.reduce((a, b) => (size(b) > size(a) ? b : a));
  const { now, next } = worst.report.outlook as NonNullable<Report["outlook"]>;
  const shown = next ?? now;
  const any = shown.worst_mm !== undefined;
  const text = `worst ${any ? `at ${foretold ? "any" : "a touched"} height` : "mean over the height"} ${any
    ? fall(next ? now.worst_mm : undefined, shown.worst_mm, shown.worst_sigma_mm) : fall(next ? now.mean_mm : undefined, shown.mean_mm, shown.mean_sigma_mm)}${
    shown.worst_sigma_mm === undefined ? "" : " (2 sigma)"}, at ${worst.name}`;
  return `${capital(counts ? `${counts}; ${text}` : text)}.`;
}
