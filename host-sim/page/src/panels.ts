/** The blocks in words and figures: head, results, job, parameters, probe points, warnings. */

import type { Parameter, ProbePoint, Program, Report, Result, Several } from "./data";
import { card, el, table } from "./dom";
import { decimalsFor, fixed, LENGTH, NO_VALUE, sigmaText, signed, withUnit } from "./format";
import { nextStep, sentence, three, type Told } from "./headline";
import { decimalsTelling, limitsOf, limitsText, standing, verdictWord, type Limits } from "./limits";
import { MEANING } from "./glossary";
import { SIGNS } from "./marks";
import type { Model } from "./model";

const KINDS = { simulate: "simulated pass", correct: "correction", learn: "correction of the next part", inspect: "inspection" };

/** Heading of the page, what it is of, warnings and buttons. */
export function head(report: Report | Several, source: (string | undefined)[], warnings: HTMLElement, tools: HTMLElement): Node[] {
  const said = [KINDS[report.kind], ...source, report.by].filter((v) => v !== undefined).join(" · ");
  return [el("div", { class: "title" }, el("h1", {}, report.title), el("p", { class: "source" }, said)), warnings, tools];
}

/** Program and the cut of it that is shown. */
export function sourceOf({ program: of }: Report): (string | undefined)[] {
  return [of?.name, of?.crc32 ? `CRC-32 ${of.crc32}` : undefined, of?.shown];
}

export function warnings(list: string[]): HTMLElement {
  if (list.length === 0) return el("p", { class: "warnings none" }, "no warnings");
  return el("details", { class: "warnings" },
    el("summary", {}, list.length === 1 ? "1 warning" : `${list.length} warnings`),
    el("ul", {}, ...list.map((text) => el("li", {}, text))));
}

/** The verdict in a sentence, three figures and the next step; the rest is folded. On a sheet for several contours all figures stand together. */
export function results(report: Report, model: Model | null, brief: boolean): HTMLElement[] {
  const { told, verdict, results: list = [] } = report;
  const limits = limitsOf(report);
  const read = (r: Result): Told => ({ name: r.name, value: withUnit(fixed(r.value, decimalsShown(r, report, limits)), r.unit), note: r.note });
  const shown = three(report, model, list, read);
  const rest = list.map(read).filter(({ name }) => !shown.some((one) => one.name === name));
  const line = sentence(report, model);
  const block = (t: Told) => figure(t.name, t.value, t.note);
  if (brief) return figures({ told: line, verdict, entries: [...shown.filter(({ name }) => name === "tolerance"), ...list.map(read)].map(block) });
  return figures({ told: line, verdict, entries: shown.map(block), next: nextStep(report), rest: rest.map(block), more: told === line ? undefined : told });
}

/** A length to a micrometre, a deviation as far as its verdict can be read from it; an angle to a tenth of a degree. */
function decimalsShown({ unit, decimals }: Result, { kind, points = [] }: Report, limits: Limits | undefined): number {
  if (unit === "mm") return Math.min(decimals, kind === "inspect" ? decimalsTelling(points, limits, LENGTH) : LENGTH);
  return unit === "mm²" ? Math.min(decimals, LENGTH) : Math.min(decimals, 1);
}

/** A head figure with a word on it. */
export function figure(name: string, value: string, note?: string | Node): HTMLElement {
  return el("div", { class: "result" }, el("dt", {}, name), el("dd", {}, value), note ? el("dd", { class: "note" }, note) : null);
}

/** What stands on top of a page or of a contour. */
export interface Head {
  /** How the wall comes out, in a sentence; and more of it. */
  told?: string;
  more?: string;
  verdict: Report["verdict"];
  entries: HTMLElement[];
  next?: HTMLElement | null;
  /** What is folded. */
  rest?: HTMLElement[];
  name?: string;
}

/** The sentence, and the block of figures below it. */
export function figures({ told, more, verdict, entries, next = null, rest = [], name = "Results" }: Head): HTMLElement[] {
  const words = { pass: "within tolerance", fail: "out of tolerance", open: "not decided" };
  const stamp = verdict ? el("p", { class: `verdict ${verdict.state}` }, el("strong", {}, words[verdict.state]),
    el("span", {}, verdict.text)) : null;
  const all = rest.length === 0 ? null : el("details", { class: "all" }, el("summary", {}, `All figures: ${rest.length} more`),
    more ? el("p", { class: "more" }, more) : null, el("dl", {}, ...rest));
  const headline = told ? [el("p", { class: "told" }, told)] : [];
  if (entries.length === 0 && !verdict) return headline;
  return [...headline, el("section", { class: "results", "aria-label": name }, stamp, el("dl", {}, ...entries), next, all)];
}

export function job(report: Report): HTMLElement | null {
  const { tool, cut, stock, wall, milling, material, facts } = report.job ?? {};
  const rows: [string, string | undefined][] = [
    ["tool", tool && [tool.number ? `T${tool.number}` : "", `⌀ ${tool.diameter_mm} mm`, tool.teeth ? `${tool.teeth} teeth` : "",
      tool.helix_deg !== undefined ? `helix ${tool.helix_deg}°` : ""].filter(Boolean).join(", ")],
    ["stick-out", tool?.stickout_mm !== undefined ? `${tool.stickout_mm} mm` : undefined],
    ["axial depth", cut?.axial_depth_mm !== undefined ? `${cut.axial_depth_mm} mm` : undefined],
    ["feed", cut?.feed_mm_per_min !== undefined ? `${cut.feed_mm_per_min} mm/min` : undefined],
    ["spindle", cut?.spindle_rpm !== undefined ? `${cut.spindle_rpm} 1/min` : undefined],
    ["allowance", stock?.allowance_mm !== undefined ? `${stock.allowance_mm} mm` : undefined],
    ["wall", wall && `${wall} of travel`],
    ["milling", milling], ["material", material],
    ...(facts ?? []).map((f): [string, string] => [f.name, f.value]),
  ];
  const known = rows.filter((row): row is [string, string] => row[1] !== undefined);
  if (known.length === 0) return null;
  return card("job", "Job", el("dl", { class: "facts" }, ...known.flatMap(([name, value]) => [el("dt", {}, name), el("dd", {}, value)])));
}

/** Which of the cuts of a program the page shows, and what became of the others; `here` are the contours of the page by name. */
export function program(of: Program, here: string[] = []): HTMLElement | null {
  const { cuts = [], other_features: others = [], cuts_left_out: left = 0 } = of;
  const features = others.filter((name) => !here.includes(name));
  if (cuts.length === 0) return null;
  const words = { shown: here.length ? "this contour" : "this page", corrected: "same correction", unchanged: "stays as it is", elsewhere: NO_VALUE };
  const rows = cuts.map((cut) => {
    const lines = cut.first_line === cut.last_line ? String(cut.first_line) : `${cut.first_line}–${cut.last_line}`;
    const became = cut.became === "shown" ? el("strong", {}, words.shown) : words[cut.became];
    return [lines, cut.role, cut.tool == null ? NO_VALUE : `T${cut.tool}`, fixed(cut.z_mm ?? undefined, 3), fixed(cut.length_mm, 3),
      cut.closed ? "closed" : "open", became, cut.why];
  });
  const notes = [of.shown && of.why ? `${of.shown}: ${of.why}.` : "",
    features.length ? `Other features of the program, each with a report of its own: ${features.join(", ")}.` : "",
    left ? `${left} more cuts are in summary.json.` : ""].filter(Boolean);
  return card("program", `Cuts of the program: ${cuts.length + left}`, ...notes.map((text) => el("p", { class: "at" }, text)),
    table("Cuts of the program", ["lines", "cut", "tool", "Z mm", "length mm", "path", "outcome", "why"], rows, [0, 1, 2, 5, 6, 7]));
}

export function parameters(list: Parameter[]): HTMLElement {
  const rows = list.map((p) => {
    const decimals = decimalsFor(p.sigma);
    const prior = p.prior === undefined ? NO_VALUE : `${fixed(p.prior, decimals)} ± ${fixed(p.prior_sigma, decimals)}`;
    return [p.name.replaceAll("_", " "), fixed(p.value, decimals), `± ${sigmaText(p.sigma, decimals)}`, prior,
      p.unit === "1" ? NO_VALUE : p.unit.replace("um", "µm"),
      el("span", { class: p.observable ? "yes" : "no" }, p.observable ? "yes" : "no")];
  });
  const known = list.filter((p) => MEANING[p.name]);
  const words = known.length === 0 ? null : el("details", { class: "meaning" }, el("summary", {}, "what these are"),
    el("dl", { class: "facts" }, ...known.flatMap((p) => [el("dt", {}, p.name.replaceAll("_", " ")), el("dd", {}, MEANING[p.name])]),
      el("dt", {}, "decided by points"), el("dd", {}, "yes where the points have at least halved what was uncertain before")));
  return card("parameters", "Identified", table("Identified parameters", ["parameter", "value", "σ", "believed before", "unit", "decided by points"], rows, [0, 4, 5]), words);
}

/** What became of a point, and why. */
export function statusOf(p: ProbePoint): string {
  return `${p.status === "used" ? "used" : "set aside"}${p.reason ? `: ${p.reason}` : ""}`;
}

/** Without a verdict of the program: where the deviation lies. */
const PLACES = { within: "in", left: "left", gouge: "too deep", open: "undecided", aside: NO_VALUE, plain: NO_VALUE };

export function points(report: Report, show: (index: number) => void): HTMLElement {
  const list = report.points ?? [];
  const limits: Limits | undefined = limitsOf(report);
  const judged = list.some((p) => p.verdict);
  const used = list.filter((p) => p.status === "used").length;
  const decimals = decimalsTelling(list, limits, LENGTH);
  const rows = list.map((p, index) => {
    const button = el("button", { type: "button", class: "link", "aria-label": `Show probe point ${p.line ?? index + 1} in the picture` }, String(p.line ?? index + 1));
    button.addEventListener("click", () => show(index));
    const where = standing(p, limits);
    const word = judged ? el("span", { class: `standing ${where}` }, `${SIGNS[where]} ${verdictWord(p, limits)}`) : PLACES[where];
    return [button, fixed(p.s_mm, 3), fixed(p.x_mm, LENGTH), fixed(p.y_mm, LENGTH), fixed(p.z_mm, 2), fixed(p.nx, 3), fixed(p.ny, 3),
      signed(p.error_mm, decimals), ...(limits ? [word] : []), statusOf(p)];
  });
  const column = limits ? [judged ? "verdict" : `in ${limitsText(limits)}`] : [];
  return card("points", `Probe points: ${list.length}, used ${used}, set aside ${list.length - used}`,
    table("Probe points", ["line", "s mm", "X mm", "Y mm", "height mm", "normal x", "normal y", "deviation mm", ...column, "status"],
      rows, limits ? [0, 8, 9] : [0, 8]));
}
