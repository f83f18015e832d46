/** The oscilloscope: traces over arc length, in step with the cutter. */

import uPlot from "uplot";
import { between } from "./cutter";
import type { Series } from "./decode";
import { framedByFinger } from "./finger";
import { decimalsOf, LENGTH, per, sayError, sayLength, unitOf, withUnit } from "./format";
import { widest } from "./letters";
import { limitsOf, type Limits } from "./limits";
import type { Model, Quantity } from "./model";
import type { Palette } from "./palette";
import type { State } from "./state";
import { roundStep } from "./view";

interface Curve { name: string; series: Series; colour: string; dash?: number[]; width?: number }
interface Panel { quantity: string; title: string; unit: string; bound?: string; curves: Curve[]; sigma?: { error: Series; sigma: Series; colour: string }; limits?: Limits }

/** A trace on the page; folded it is a line with its figures. */
interface Shown { plot: uPlot | null; panel: Panel; values: HTMLElement[]; playhead: HTMLElement | null }

export interface TraceEvents {
  range(range: [number, number] | null): void;
  hover(index: number | null): void;
  pick(index: number): void;
  /** A trace was opened or folded: they are to be built anew. */
  folded(): void;
}

export class Traces {
  private shown: Shown[] = [];
  private quiet = false;
  private axis: HTMLElement | null = null;
  /** The arc length shown, mm. */
  private stretch: [number, number] = [0, 1];
  /** What of the traces is open, by quantity: the wall error until the reader opens others. */
  private readonly opened = new Set<string>(["Wall error"]);

  constructor(private readonly element: HTMLElement, private readonly model: Model, private readonly events: TraceEvents) {}

  /** Builds all panels anew: other colours, another pass, another height. */
  rebuild(state: State, colours: Palette, height: number): void {
    for (const { plot } of this.shown) plot?.destroy();
    this.element.replaceChildren();
    const panels = panelsOf(this.model, state, colours);
    const paper = document.documentElement.dataset.printing !== undefined;
    const open = panels.map(({ quantity }) => paper || this.opened.has(quantity));
    this.shown = panels.map((panel, index) => this.build(panel, state, colours, height, open[index], index === open.lastIndexOf(true)));
    const axis = document.createElement("p");
    axis.className = "axis";
    axis.textContent = `arc length s, ${unitOf()}`;
    this.axis = axis;
    // Below the last that is open, whose numbers it names.
    const last = this.element.children[open.lastIndexOf(true)];
    if (last) last.after(axis);
    this.place(state.place);
  }

  resize(height: number): void {
    const last = this.shown.map(({ plot }) => plot !== null).lastIndexOf(true);
    this.shown.forEach(({ plot }, i) => plot?.setSize({ width: this.width(), height: height + (i === last ? 26 : 0) }));
  }

  /** Moves the playheads and the figures beside the titles. */
  place(place: number, figures = true): void {
    const s = between(this.model.s.values, place);
    // Paper has no table of the figures at the cutter: what stands beside the traces says where it is of.
    if (figures && this.axis) this.axis.dataset.at = sayLength(this.model.s.values[Math.round(place)]);
    // As a share of the width: a plot just built or resized does not know its own yet.
    const [from, to] = this.stretch;
    const share = (s - from) / (to - from);
    for (const { panel, values, playhead } of this.shown) {
      if (playhead) {
        playhead.style.display = share >= 0 && share <= 1 ? "" : "none";
        playhead.style.transform = `translateX(${(100 * share).toFixed(3)}%)`;
      }
      if (figures) panel.curves.forEach((curve, i) => {
        const text = sayError(curve.series.values[Math.round(place)], decimalsOf(panel.unit, curve.series.decimals), panel.unit);
        if (values[i].textContent !== text) values[i].textContent = text;
      });
    }
  }

  zoom(range: [number, number] | null): void {
    const s = this.model.s.values;
    const [min, max] = range ?? [s[0], s[s.length - 1]];
    this.stretch = [min, max];
    this.quiet = true;
    for (const { plot } of this.shown) plot?.setScale("x", { min, max });
    this.quiet = false;
  }

  /** Ends what the plots have begun outside of their elements. */
  close(): void {
    for (const { plot } of this.shown) plot?.destroy();
    this.shown = [];
  }

  /** How many traces are open, and how many are folded. */
  get open(): number {
    return this.shown.filter(({ plot }) => plot).length;
  }

  get folded(): number {
    return this.shown.length - this.open;
  }

  private width(): number {
    return Math.max(200, this.element.clientWidth);
  }

  private build(panel: Panel, state: State, colours: Palette, height: number, open: boolean, last: boolean): Shown {
    const box = document.createElement("div");
    box.className = "trace";
    const head = document.createElement("div");
    head.className = "trace-head";
    const title = document.createElement("h2");
    const fold = document.createElement("button");
    fold.type = "button";
    fold.className = "fold";
    fold.textContent = panel.title;
    fold.setAttribute("aria-expanded", String(open));
    fold.addEventListener("click", () => {
      if (!this.opened.delete(panel.quantity)) this.opened.add(panel.quantity);
      this.events.folded();
      [...this.element.querySelectorAll<HTMLElement>(".fold")][this.shown.findIndex((one) => one.panel.quantity === panel.quantity)]?.focus();
    });
    title.append(fold);
    const unit = document.createElement("span");
    unit.className = "unit";
    unit.textContent = unitOf(panel.unit) + (panel.bound ?? "");
    head.append(title, unit);
    const values = panel.curves.map((curve) => {
      const entry = document.createElement("span");
      entry.className = "entry";
      const key = document.createElement("i");
      key.style.borderTopColor = curve.colour;
      if (curve.dash) key.style.borderTopStyle = "dashed";
      const name = document.createElement("span");
      name.textContent = curve.name;
      const value = document.createElement("b");
      entry.append(key, name, value);
      head.append(entry);
      return value;
    });
    box.append(head);
    this.element.append(box);
    if (!open) return { plot: null, panel, values, playhead: null };
    const plot = new uPlot(this.options(panel, state, colours, height, last), data(this.model, panel), box);
    plot.root.setAttribute("aria-hidden", "true");
    const playhead = document.createElement("div");
    playhead.className = "playhead";
    plot.over.append(playhead);
    this.pointer(plot);
    framedByFinger(plot, (range) => this.events.range(range));
    return { plot, panel, values, playhead };
  }

  private pointer(plot: uPlot): void {
    let down = 0;
    plot.over.addEventListener("mousedown", (event) => { down = event.clientX; });
    plot.over.addEventListener("mouseup", (event) => {
      if (Math.abs(event.clientX - down) < 3 && plot.cursor.idx != null) this.events.pick(plot.cursor.idx);
    });
    plot.over.addEventListener("mousemove", () => this.events.hover(plot.cursor.idx ?? null));
    plot.over.addEventListener("mouseleave", () => this.events.hover(null));
    plot.over.addEventListener("dblclick", () => this.events.range(null));
  }

  private options(panel: Panel, state: State, colours: Palette, height: number, last: boolean): uPlot.Options {
    const s = this.model.s.values;
    const [min, max] = state.range ?? [s[0], s[s.length - 1]];
    this.stretch = [min, max];
    const font = `11px ${colours.font}`;
    // Numbers as long as any tick's have room beside the axis, and beside each other below it.
    const number = widest(["−0.00025"]);
    const axis = { stroke: colours.quiet, font, grid: { stroke: colours.grid, width: 1 }, ticks: { show: false } };
    const series: uPlot.Series[] = [{}];
    for (const curve of panel.curves) {
      series.push({
        stroke: curve.colour, width: curve.width ?? 1.5, dash: curve.dash, points: { show: false },
      });
    }
    const bands: uPlot.Band[] = [];
    if (panel.sigma) {
      const n = series.length;
      series.push({ stroke: "transparent", width: 0, points: { show: false } }, { stroke: "transparent", width: 0, points: { show: false } });
      bands.push({ series: [n, n + 1], fill: `${panel.sigma.colour}40` });
    }
    return {
      width: this.width(),
      height: height + (last ? 26 : 0),
      padding: [7, 8, last ? 0 : 5, 0],
      series,
      bands,
      legend: { show: false },
      cursor: {
        sync: { key: "traces", setSeries: false },
        drag: { x: true, y: false, setScale: true },
        points: { show: false },
        y: false,
      },
      scales: { x: { time: false, min, max, range: (_plot, a, b) => [a, b] }, y: { range: (_plot, a, b) => around(a, b, panel.limits) } },
      axes: [
        { ...axis, show: last, size: 30, gap: 5, space: Math.max(50, number), ...ticks("mm") },
        { ...axis, size: Math.max(54, Math.ceil(number) + 8), gap: 4, space: 16, ...ticks(panel.unit) },
      ],
      hooks: {
        setScale: [(plot, key) => {
          if (key !== "x" || this.quiet) return;
          const { min: from, max: to } = plot.scales.x;
          if (from != null && to != null) this.events.range([from, to]);
        }],
        drawAxes: [(plot) => lines(plot, panel, colours)],
      },
    };
  }
}

/** Where an axis has numbers, and which: in millimetres where uPlot has them. */
function ticks(unit: string): Pick<uPlot.Axis, "values" | "splits"> {
  const one = per(unit);
  return {
    values: (_plot, all) => all.map((tick) => String(Number((tick / one).toPrecision(6))).replace("-", "−")),
    ...(one === 1 ? {} : { splits: (_plot, _axis, low, high, least) => {
      const step = roundStep(least, one);
      const first = Math.ceil(low / step);
      return Array.from({ length: Math.floor(high / step) - first + 1 }, (_, k) => (first + k) * step);
    } }),
  };
}

/** Zero and the tolerance. */
function lines(plot: uPlot, panel: Panel, colours: Palette): void {
  const levels = panel.limits ? [0, panel.limits.upper, panel.limits.lower] : [0];
  const { left, top, width, height } = plot.bbox;
  for (const level of levels) {
    const y = plot.valToPos(level, "y", true);
    if (!(y >= top && y <= top + height)) continue;
    plot.ctx.save();
    plot.ctx.strokeStyle = level === 0 ? colours.quiet : colours.within;
    plot.ctx.lineWidth = window.devicePixelRatio || 1;
    plot.ctx.setLineDash(level === 0 ? [] : [6, 4]);
    plot.ctx.beginPath();
    plot.ctx.moveTo(left, y);
    plot.ctx.lineTo(left + width, y);
    plot.ctx.stroke();
    plot.ctx.restore();
  }
}

function around(min: number | null, max: number | null, limits?: Limits): [number, number] {
  let low = Math.min(min ?? 0, 0, (limits?.lower ?? 0) * 1.3);
  let high = Math.max(max ?? 0, 0, (limits?.upper ?? 0) * 1.3);
  if (high - low < 1e-9) high = low + 1;
  const room = (high - low) * 0.06;
  if (high > 0) high += room;
  if (low < 0) low -= room;
  return [low, high];
}

function data(model: Model, panel: Panel): uPlot.AlignedData {
  const columns: (Float64Array | (number | null)[])[] = [model.s.values, ...panel.curves.map((curve) => gaps(curve.series.values))];
  if (panel.sigma) {
    const { error, sigma } = panel.sigma;
    columns.push(...[2, -2].map((times) => gaps(error.values.map((v, i) => v + times * sigma.values[i]))));
  }
  return columns as uPlot.AlignedData;
}

/** A place without a value is a gap for the plot, and does not count for its scale. */
function gaps(values: Float64Array): Float64Array | (number | null)[] {
  return values.some(Number.isNaN) ? Array.from(values, (v) => (Number.isNaN(v) ? null : v)) : values;
}

function panelsOf(model: Model, state: State, colours: Palette): Panel[] {
  const { passes, compared } = model;
  const selected = (state.shown === "both" ? undefined : model.pass(state.shown)) ?? passes.at(-1);
  const drawn = passes.filter((pass) => (state.shown === "both" ? compared.includes(pass) : pass === selected));
  const both = (quantity: Quantity, height: number | null = null): Curve[] => drawn.flatMap((pass) => {
    const series = pass.series[quantity];
    const error = height === null ? undefined : model.error(pass.name, height);
    if (!series && !error) return [];
    return [{
      name: passes.length > 1 ? pass.title : "", series: error ? { values: error, decimals: LENGTH } : (series as Series),
      colour: colours[model.colour(pass)],
    }];
  });
  const components = (x: Quantity, y: Quantity, names: [string, string]): Curve[] => {
    const [sx, sy] = [selected?.series[x], selected?.series[y]];
    return [
      ...(sx ? [{ name: names[0], series: sx, colour: colours.first, width: 1.25 }] : []),
      ...(sy ? [{ name: names[1], series: sy, colour: colours.second, width: 1.25 }] : []),
    ];
  };
  const suffix = passes.length > 1 ? ` (${selected?.title})` : "";
  const errors = both("error_mm", state.height);
  const bounded = selected?.series.sigma_mm && selected.series.error_mm && state.height === null
    ? { error: selected.series.error_mm, sigma: selected.series.sigma_mm, colour: colours[model.colour(selected)] } : undefined;
  const several = passes.filter((pass) => pass.correction).length > 1;
  const shown = selected?.correction;
  const correction = shown ? [{ name: "x", series: shown.x, colour: colours.first }, { name: "y", series: shown.y, colour: colours.second }] : [];
  const z = state.height === null ? "" : ` at ${withUnit(sayLength(model.report.heights?.z_mm[state.height], 2))} height`;
  const panels: Panel[] = [
    { quantity: "Wall error", title: `Wall error${z}`, unit: "mm", bound: bounded && ", ±2σ", curves: errors, sigma: bounded, limits: limitsOf(model.report) },
    { quantity: "Correction", title: `Correction${several ? ` (${selected?.title})` : ""}`, unit: "mm", curves: correction },
    { quantity: "Deflection", title: `Deflection${suffix}`, unit: "mm", curves: components("dx_mm", "dy_mm", ["x", "y"]) },
    { quantity: "Force", title: `Force${suffix}`, unit: "N", curves: force(selected?.series.force_n, components("fx_n", "fy_n", ["x", "y"]), colours) },
    { quantity: "Engagement arc", title: "Engagement arc", unit: "°", curves: both("arc_deg") },
    { quantity: "Chip area", title: "Chip area", unit: "mm²", curves: both("chip_area_mm2") },
    { quantity: "Feed", title: "Feed", unit: "mm/min", curves: both("feed_mm_per_min") },
  ];
  return panels.filter((panel) => panel.curves.length > 0);
}

function force(total: Series | undefined, parts: Curve[], colours: Palette): Curve[] {
  return total ? [{ name: "F", series: total, colour: colours.ink, width: 1.75 }, ...parts] : parts;
}
