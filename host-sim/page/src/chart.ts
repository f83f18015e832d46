/**
 * Deviation of every point over the arc length, with limits, guard band and what no point speaks for.
 *
 * SVG, so that paper has it sharp. Points at one place but at several heights stand above each other.
 */

import type { Report } from "./data";
import { card, el, svg } from "./dom";
import { beside, face } from "./face";
import { fixed, sayAsGiven, sayDeviation, sayError, stepDecimals, unitOf, withUnit } from "./format";
import { limitDecimals, limitsOf, standing, type Limits, type Standing } from "./limits";
import { widest } from "./letters";
import { markPath } from "./marks";
import { roundStep } from "./view";

const HEIGHT = 194;
const EDGE = { left: 54, right: 64, top: 8, bottom: 20 };
type Edge = typeof EDGE;
interface Scale { px(s: number): number; py(e: number): number }

export class Chart {
  readonly element: HTMLElement;
  private readonly box = el("div", { class: "chart" });
  private readonly seen = new ResizeObserver(() => { if (!document.documentElement.dataset.printing) this.draw(); });

  constructor(private readonly report: Report) {
    this.element = card("deviations", "Deviation along the contour", this.box);
    this.seen.observe(this.box);
  }

  close(): void {
    this.seen.disconnect();
  }

  /** Whether there is anything to draw. */
  static of(report: Report): Chart | null {
    return report.kind === "inspect" && report.points?.some((p) => p.s_mm !== undefined && p.error_mm !== undefined) ? new Chart(report) : null;
  }

  draw(): void {
    const width = Math.max(280, this.box.clientWidth);
    const points = (this.report.points ?? []).filter((p) => p.s_mm !== undefined && p.error_mm !== undefined);
    const limits = limitsOf(this.report);
    const guard = limits?.uncertainty ?? 0;
    const values = [0, ...points.flatMap((p) => [(p.error_mm as number) - guard, (p.error_mm as number) + guard]), ...(limits ? [limits.lower, limits.upper] : [])];
    const low = values.reduce((a, b) => Math.min(a, b));
    const high = values.reduce((a, b) => Math.max(a, b));
    const room = 0.06 * Math.max(high - low, 1e-4);
    const { step, decimals } = stepping(high - low + 2 * room);
    const written = [low - room, high + room].map((v) => sayError(Math.trunc(v / step) * step, decimals));
    const bounds = limits ? [limits.upper, limits.lower].map((v) => sayDeviation(v, limitDecimals(limits))) : [];
    // Wide letters get more room.
    const edge = { ...EDGE, left: Math.max(EDGE.left, widest(written) + 8), right: Math.max(EDGE.right, widest(bounds) + 8) };
    const along = points.map((p) => p.s_mm as number);
    const end = this.report.coverage?.length_mm ?? along.reduce((a, b) => Math.max(a, b), 1);
    const scale = {
      px: (s: number) => edge.left + (s / end) * (width - edge.left - edge.right),
      py: (e: number) => EDGE.top + ((high + room - e) / (high - low + 2 * room)) * (HEIGHT - EDGE.top - EDGE.bottom),
    };
    const picture = svg("svg", { width, height: HEIGHT, viewBox: `0 0 ${width} ${HEIGHT}`, role: "img",
      "aria-label": `Deviation of ${points.length} points over arc length; the table holds the figures` });
    this.unmeasured(picture, scale);
    this.axes(picture, scale, edge, width, [low - room, high + room], end);
    if (limits) this.limitLines(picture, scale, end, limits, guard);
    for (const p of points) {
      const [x, y] = [scale.px(p.s_mm as number), scale.py(p.error_mm as number)];
      if (guard > 0) picture.append(svg("path", { class: "bar-u", d: `M${x} ${scale.py((p.error_mm as number) - guard)}V${scale.py((p.error_mm as number) + guard)}` }));
      const where = standing(p, limits);
      picture.append(svg("path", { class: `mark ${where}`, d: markPath(where, x, y, 4) }));
    }
    const axes = el("p", { class: "chart-axis" }, el("span", {}, `deviation, ${unitOf()}: material left is positive`), el("span", {}, `arc length s, ${unitOf()}`));
    this.box.replaceChildren(picture, beside(axes, edge), this.key(guard), ...face(this.report, width, edge, scale.px));
  }

  /** What the signs are. */
  private key(guard: number): HTMLElement {
    const { points = [], coverage } = this.report;
    const limits = limitsOf(this.report);
    const entry = (shape: SVGElement, text: string) => {
      const picture = svg("svg", { width: 16, height: 12, "aria-hidden": "true" });
      picture.append(shape);
      return el("span", {}, picture, text);
    };
    const there = new Set(points.map((p) => standing(p, limits)));
    const words: [Standing, string][] = [["within", "pass"], ["left", "fail: material left"], ["gouge", "fail: too deep"], ["open", "undecided"]];
    const entries = words.filter(([where]) => there.has(where)).map(([where, text]) => entry(svg("path", { class: `mark ${where}`, d: markPath(where, 8, 6, 4) }), text));
    const fill = (kind: string) => svg("rect", { class: kind, width: 16, height: 12 });
    if (guard > 0 && limits) entries.push(entry(svg("path", { class: "bar-u", d: "M8 0V12" }), `± uncertainty, ${withUnit(sayError(guard, limitDecimals(limits)))}`));
    if (guard > 0 && limits) entries.push(entry(fill("band"), "undecided: closer to a limit than the uncertainty"));
    if (coverage?.stretches.length) entries.push(entry(fill("unmeasured"), `farther than ${sayAsGiven(coverage.reach_mm)} from any measured place`));
    return el("p", { class: "chart-key" }, ...entries);
  }

  private unmeasured(picture: SVGElement, { px }: Scale): void {
    for (const { from_mm: from, to_mm: to } of this.report.coverage?.stretches ?? []) {
      picture.append(svg("rect", { class: "unmeasured", x: px(from), width: Math.max(0, px(to) - px(from)), y: EDGE.top, height: HEIGHT - EDGE.top - EDGE.bottom }));
    }
  }

  private limitLines(picture: SVGElement, { px, py }: Scale, end: number, limits: Limits, guard: number): void {
    for (const value of [limits.upper, limits.lower]) {
      if (guard > 0) picture.append(svg("rect", { class: "band", x: px(0), width: px(end) - px(0), y: py(value + guard), height: py(value - guard) - py(value + guard) }));
      picture.append(svg("path", { class: "limit", d: `M${px(0)} ${py(value)}H${px(end)}` }));
      picture.append(svg("text", { class: "limit-text", x: px(end) + 5, y: py(value) + 4 }, sayDeviation(value, limitDecimals(limits))));
    }
  }

  private axes(picture: SVGElement, { px, py }: Scale, edge: Edge, width: number, [low, high]: [number, number], end: number): void {
    const { step, decimals } = stepping(high - low);
    for (let k = Math.ceil(low / step); k * step <= high; k++) {
      picture.append(svg("path", { class: k === 0 ? "nought" : "rule", d: `M${px(0)} ${py(k * step)}H${px(end)}` }));
      picture.append(svg("text", { x: px(0) - 6, y: py(k * step) + 4, "text-anchor": "end" }, sayError(k * step, decimals)));
    }
    const room = Math.max(90, 1.5 * widest([fixed(end, 0)]));
    const along = roundStep(end / Math.max(2, Math.min(Math.floor(width / 90), Math.floor((width - edge.left - edge.right) / room))));
    const bottom = HEIGHT - EDGE.bottom;
    for (let k = 0; k * along <= end; k++) {
      picture.append(svg("path", { class: "tick", d: `M${px(k * along)} ${bottom}v4` }));
      picture.append(svg("text", { x: px(k * along), y: bottom + 16, "text-anchor": "middle" }, sayError(k * along, stepDecimals(along))));
    }
    picture.append(svg("path", { class: "tick", d: `M${px(0)} ${EDGE.top}V${bottom}H${px(end)}` }));
  }
}

/** Spacing of the lines over such a span, and the decimals of their numbers. */
function stepping(span: number): { step: number; decimals: number } {
  const step = roundStep(span / 5);
  return { step, decimals: stepDecimals(step) };
}
