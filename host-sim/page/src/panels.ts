/** The blocks in words and figures: head, results, job, parameters, probe points, warnings. */

import type { Parameter, ProbePoint, Program, Report, Result, Several, Told } from "./data";
import { card, el, type Said, table } from "./dom";
import { decimalsFor, decimalsOf, fine, fixed, NO_VALUE, say, saysInches, sayAsGiven, sayDeviation, sayError, sayLength, sigmaText, unitOf, withUnit } from "./format";
import { nextStep, sentence, three, type Figure } from "./headline";
import { decimalsTelling, limitsOf, limitsText, standing, verdictWord, type Limits } from "./limits";
import { MEANING } from "./glossary";
import { SIGNS } from "./marks";
import type { Model } from "./model";

const KINDS = { simulate: "simulated pass", correct: "correction", learn: "correction of the next part", inspect: "inspection" };

/** Heading of the page, what it is of, warnings and buttons. */
export function head(report: Report | Several, source: (Told | undefined)[], warnings: HTMLElement, tools: HTMLElement): Node[] {
  const said = () => [KINDS[report.kind], ...source, report.by].flatMap((v) => (v === undefined ? [] : [say(v)])).join(" · ");
  return [el("div", { class: "title" }, el("h1", {}, report.title), el("p", { class: "source" }, said)), warnings, tools];
}

/** Program and the cut of it that is shown. */
export function sourceOf({ program: of }: Report): (Told | undefined)[] {
  return [of?.name, of?.crc32 ? `CRC-32 ${of.crc32}` : undefined, of?.shown];
}

export function warnings(list: Told[]): HTMLElement {
  if (list.length === 0) return el("p", { class: "warnings none" }, "no warnings");
  return el("details", { class: "warnings" },
    el("summary", {}, list.length === 1 ? "1 warning" : `${list.length} warnings`),
    el("ul", {}, ...list.map((text) => el("li", {}, () => say(text)))));
}

/** The verdict in a sentence, three figures and the next step; the rest is folded. On a sheet for several contours all figures stand together. */
export function results(report: Report, model: Model | null, brief: boolean): HTMLElement[] {
  const { told, verdict, results: list = [] } = report;
  const limits = limitsOf(report);
  const read = ({ name, value, unit, decimals, note }: Result): Figure => ({
    name, note: note && (() => say(note)),
    value: () => withUnit(sayError(value, unit === "mm" && report.kind === "inspect" ? Math.min(fine(decimals), decimalsTelling(report.points ?? [], limits)) : decimalsOf(unit, decimals), unit), unit),
  });
  const shown = three(report, model, list, read);
  const rest = list.map(read).filter(({ name }) => !shown.some((one) => one.name === name));
  const line = () => sentence(report, model) ?? "";
  const block = (t: Figure) => figure(t.name, t.value, t.note);
  if (brief) return figures({ told: line() && line, verdict, entries: [...shown.filter(({ name }) => name === "tolerance"), ...list.map(read)].map(block) });
  return figures({ told: line() && line, verdict, entries: shown.map(block), next: nextStep(report), rest: rest.map(block), more: told && say(told) !== line() ? () => say(told) : undefined });
}

/** A head figure with a word on it. */
export function figure(name: string, value: Said, note?: Said | Node): HTMLElement {
  return el("div", { class: "result" }, el("dt", {}, name), el("dd", {}, value), note ? el("dd", { class: "note" }, note) : null);
}

/** What stands on top of a page or of a contour. */
export interface Head {
  /** How the wall comes out, in a sentence; and more of it. */
  told?: Said;
  more?: Said;
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
    el("span", {}, () => say(verdict.text))) : null;
  const all = rest.length === 0 ? null : el("details", { class: "all" }, el("summary", {}, `All figures: ${rest.length} more`),
    more ? el("p", { class: "more" }, more) : null, el("dl", {}, ...rest));
  const headline = told ? [el("p", { class: "told" }, told)] : [];
  if (entries.length === 0 && !verdict) return headline;
  return [...headline, el("section", { class: "results", "aria-label": name }, stamp, el("dl", {}, ...entries), next, all)];
}

export function job(report: Report): HTMLElement | null {
  const { tool, cut, stock, wall, milling, material, facts } = report.job ?? {};
  const given = (value?: number, unit?: string) => (value === undefined ? undefined : () => sayAsGiven(value, unit));
  const rows: [string, Said | undefined][] = [
    ["tool", tool && (() => [tool.number ? `T${tool.number}` : "", `⌀ ${sayAsGiven(tool.diameter_mm)}`, tool.teeth ? `${tool.teeth} teeth` : "",
      tool.helix_deg !== undefined ? `helix ${tool.helix_deg}°` : ""].filter(Boolean).join(", "))],
    ["stick-out", given(tool?.stickout_mm)],
    ["axial depth", given(cut?.axial_depth_mm)],
    ["feed", given(cut?.feed_mm_per_min, "mm/min")],
    ["spindle", cut?.spindle_rpm !== undefined ? `${cut.spindle_rpm} 1/min` : undefined],
    ["allowance", given(stock?.allowance_mm)],
    ["wall", wall && `${wall} of travel`],
    ["milling", milling], ["material", material],
    ...(facts ?? []).map((f): [string, Said] => [f.name, () => say(f.value)]),
  ];
  const known = rows.filter((row): row is [string, Said] => row[1] !== undefined);
  if (known.length === 0) return null;
  return card("job", "Job", el("dl", { class: "facts" }, ...known.flatMap(([name, value]) => [el("dt", {}, name), el("dd", {}, value)])));
}

/** Head of a column of lengths. */
export function inUnit(name: string): () => string {
  return () => `${name} ${unitOf()}`;
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
    return [lines, cut.role, cut.tool == null ? NO_VALUE : `T${cut.tool}`, () => sayLength(cut.z_mm ?? undefined), () => sayLength(cut.length_mm),
      cut.closed ? "closed" : "open", became, () => say(cut.why)];
  });
  const notes = [of.shown && of.why ? () => `${say(of.shown as Told)}: ${of.why}.` : "",
    features.length ? `Other features of the program, each with a report of its own: ${features.join(", ")}.` : "",
    left ? `${left} more cuts are in summary.json.` : ""].filter(Boolean);
  return card("program", `Cuts of the program: ${cuts.length + left}`, ...notes.map((text) => el("p", { class: "at" }, text)),
    table("Cuts of the program", ["lines", "cut", "tool", inUnit("Z"), inUnit("length"), "path", "outcome", "why"], rows, [0, 1, 2, 5, 6, 7]));
}

export function parameters(list: Parameter[]): HTMLElement {
  const rows = list.map((p) => {
    const decimals = () => decimalsFor(p.sigma, p.unit);
    const read = (value?: number) => sayError(value, decimals(), p.unit);
    const prior = p.prior === undefined ? NO_VALUE : () => `${read(p.prior)} ± ${read(p.prior_sigma)}`;
    return [p.name.replaceAll("_", " "), () => read(p.value), () => `± ${sigmaText(p.sigma, decimals(), p.unit)}`, prior,
      () => (p.unit === "1" ? NO_VALUE : unitOf(p.unit)),
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
  return `${p.status === "used" ? "used" : "set aside"}${p.reason ? `: ${say(p.reason)}` : ""}`;
}

/** Without a verdict of the program: where the deviation lies. */
const PLACES = { within: "within", left: "left", gouge: "too deep", open: "undecided", aside: NO_VALUE, plain: NO_VALUE };

export function points(report: Report, show: (index: number) => void): HTMLElement {
  const list = report.points ?? [];
  const limits: Limits | undefined = limitsOf(report);
  const judged = list.some((p) => p.verdict);
  const used = list.filter((p) => p.status === "used").length;
  const by = new Map<boolean, number>();
  const decimals = () => by.get(saysInches()) ?? by.set(saysInches(), decimalsTelling(list, limits)).get(saysInches());
  const rows = list.map((p, index) => {
    const button = el("button", { type: "button", class: "link", "aria-label": `Show probe point ${p.line ?? index + 1} in the picture` }, String(p.line ?? index + 1));
    button.addEventListener("click", () => show(index));
    const where = standing(p, limits);
    const word = judged ? el("span", { class: `standing ${where}` }, `${SIGNS[where]} ${verdictWord(p, limits)}`) : PLACES[where];
    return [button, ...[p.s_mm, p.x_mm, p.y_mm].map((v) => () => sayLength(v)), () => sayLength(p.z_mm, 2), fixed(p.nx, 3), fixed(p.ny, 3),
      () => sayDeviation(p.error_mm, decimals()), ...(limits ? [word] : []), () => statusOf(p)];
  });
  const column = limits ? [judged ? "verdict" : () => `within ${limitsText(limits)}`] : [];
  return card("points", `Probe points: ${list.length}, used ${used}, set aside ${list.length - used}`,
    table("Probe points", ["line", ...["s", "X", "Y", "height"].map(inUnit), "normal x", "normal y", inUnit("deviation"), ...column, "status"],
      rows, limits ? [0, 8, 9] : [0, 8]));
}
