/** One contour with everything there is to see of it: figures, picture, traces, tables; made, and taken away again. */

import { Chart } from "./chart";
import { fittingFactor, legend, sceneBar, transport, type Layer } from "./controls";
import { decode } from "./decode";
import type { Report } from "./data";
import { el } from "./dom";
import { sayError, unitOf, withUnit } from "./format";
import { part, signature, statements } from "./inspection";
import { limitsOf } from "./limits";
import { Model, type PassName } from "./model";
import { palette } from "./palette";
import { job, parameters, points, program, results } from "./panels";
import { Player } from "./player";
import { placeText, Readout } from "./readout";
import { Stage } from "./stage";
import { Store, type Shown, type State } from "./state";
import { stretched, turned } from "./stretch";
import { Traces } from "./traces";
import { Unrolled } from "./unrolled";
import { worstList } from "./worst";

export interface ContourView {
  /** What to put on the page. */
  readonly nodes: HTMLElement[];
  readonly stage: Stage;
  readonly store: Store;
  readonly traces: Traces | null;
  /** Whether it has passes that stand side by side. */
  readonly several: boolean;
  /** Draws, once it is on the page. */
  begin(): void;
  recolour(): void;
  /** Says in another unit what is drawn or follows the cutter. */
  resay(): void;
  /** Ends the clock and all that looks after the window; then it can be taken off the page. */
  close(): void;
}

/** Of several contours on one page: their names. On paper each has its figures and its picture, of an inspection the points. */
export interface Among { names: string[]; paper: boolean }

/** Whether there is a line to draw. */
export function drawn(report: Report): boolean {
  return report.contour !== undefined && decode(report.contour.s_mm, "s_mm").values.length > 1;
}

/** Says on the page what of its data cannot be drawn; once. */
export function checked(report: Report): Report {
  if (!report.contour || drawn(report)) return report;
  return { ...report, warnings: [...(report.warnings ?? []), "a contour of fewer than two samples is not drawn"] };
}

/** Pixels of a canvas for one of the style sheet, on paper. */
const PAPER = 3;
/** Pixels of a folded trace, and of an open one at most. */
const FOLDED = 28;
const TALLEST = 360;

function largest(values: ArrayLike<number> | undefined): number {
  let most = 0;
  for (let i = 0; values && i < values.length; i++) if (Math.abs(values[i]) > most) most = Math.abs(values[i]);
  return most;
}

function layersOf(report: Report, model: Model | null): Layer[] {
  const passes = model?.passes ?? [];
  const errors: Layer["keys"] = [["left", "material left"], ["gouge", "cut too deep"]];
  if (limitsOf(report)) errors.push(["within", "within tolerance"]);
  const paths = passes.flatMap((pass): Layer["keys"] => (model && pass.across ? [[model.colour(pass), model.of("actual path", pass), pass.name]] : []));
  const corrected = passes.filter((pass) => pass.correction);
  const commanded: Layer["keys"] = corrected.map((pass) => ["commanded", corrected.length > 1 ? model?.of("commanded path", pass) ?? "" : "commanded path", pass.name]);
  const all: [Layer, unknown][] = [
    [{ id: "band", keys: errors }, passes.length],
    [{ id: "nominal", keys: [["nominal", "nominal path"]] }, model],
    [{ id: "commanded", keys: commanded }, commanded.length],
    [{ id: "actual", keys: paths }, paths.length],
    [{ id: "stock", keys: [["stock", "stock"]] }, report.job?.stock?.allowance_mm ?? report.outlines?.stock],
    [{ id: "points", keys: [["points", () => `probe point, normal, deviation ${unitOf()}`]] }, report.points?.length],
    [{ id: "cutter", keys: [["cutter", "cutter, engaged arc"]] }, passes.length],
    [{ id: "force", keys: [["force", "force"]] }, passes.find((pass) => pass.series.fx_n)],
  ];
  return all.filter(([, there]) => there !== undefined && there !== null && there !== 0).map(([layer]) => layer);
}

export function contourView(report: Report, among?: Among): ContourView {
  const brief = among?.paper ?? false;
  const model = report.contour && drawn(report) ? new Model(report, report.contour) : null;
  const passes = model?.passes ?? [];
  const compared = model?.compared ?? [];
  const store = new Store({
    shown: compared[0]?.name ?? "before", magnify: 1, height: null, place: 0, playing: false, speed: 1, follow: false, range: null, hidden: new Set(),
  });
  let colours = palette();
  const stage = new Stage(report, model, store, colours, (index) => readout?.show(index ?? Math.round(store.state.place), index !== null));
  const { x0, x1, y0, y1 } = stage.whole;
  // Passes that are compared have one factor; one beside them with far larger errors has its own.
  const factor = (shown: Shown): number => {
    const seen = passes.filter((pass) => compared.includes(pass) || pass.name === shown);
    const errors = seen.map((pass) => largest(pass.series.error_mm?.values));
    const size = Math.min(x1 - x0, y1 - y0);
    // The commanded path stays near the part, also where little is left of a large correction.
    const room = Math.max(...seen.map((pass) => largest(pass.correction?.across)), 0) / 4;
    return fittingFactor(Math.max(...errors, largest(report.points?.map((p) => p.error_mm ?? 0)), room), size);
  };
  let fitting = factor(store.state.shown);
  store.state.magnify = fitting;

  const player = model && passes.length > 0 ? new Player(model, store) : null;
  const readout = player && model ? new Readout(model) : null;
  const tracesBox = el("section", { class: "traces", tabindex: "0", "aria-label": "Traces over arc length", "aria-describedby": "keys" });
  const traces = model && player && !brief ? new Traces(tracesBox, model, {
    range: (range) => {
      const [first, last] = [model.s.values[0], model.s.values[model.count - 1]];
      const part = range && (range[0] > first + 1e-6 || range[1] < last - 1e-6) ? range : null;
      if (part?.join() !== store.state.range?.join()) store.set({ range: part });
    },
    hover: (index) => { stage.mark(index); readout?.show(index ?? Math.round(store.state.place), index !== null); },
    pick: (index) => store.set({ place: index, playing: false }),
    folded: () => { traces?.rebuild(store.state, colours, traceHeight()); traces?.resize(traceHeight()); traces?.place(store.state.place); },
  }) : null;

  const recolour = () => {
    colours = palette();
    stage.recolour(colours);
    chart?.draw();
    unrolled?.draw(document.documentElement.dataset.printing === undefined ? undefined : PAPER);
    traces?.rebuild(store.state, colours, traceHeight());
  };
  const resay = () => {
    unrolled?.rescale();
    store.again("shown", "height", "place");
    recolour();
  };

  const bar = sceneBar(model, store, {
    zoomIn: () => { stage.view.zoom(1.5); stage.still(); },
    zoomOut: () => { stage.view.zoom(1 / 1.5); stage.still(); },
    fragment: () => { if (store.state.range) stage.showRange(store.state.range); },
    whole: () => { stage.view.fit(); stage.still(); store.set({ range: null }); },
  });
  const seen = model || report.points?.length || report.outlines?.wall?.length || report.outlines?.stock?.length;
  const picture = el("section", { class: "picture", "aria-label": "Contour" }, bar, stage.element,
    legend(store, layersOf(report, model), () => seenPasses(model, store.state.shown)), player && model ? transport(model, store, player, (index) => stage.showPlace(index)) : null,
    player && model && !brief ? worstList(model, store, ({ index, height }) => {
      store.set({ place: index, height, playing: false });
      stage.showPlace(index);
      picture.scrollIntoView({ block: "nearest" });
    }) : null);
  const unrolled = brief ? null : Unrolled.of(report, model, store, stage, () => colours);
  const chart = Chart.of(report);
  const rests = statements(report);
  const facts = brief ? null : job(report);
  const beside = traces ? tracesBox : rests || chart ? el("div", { class: "beside" }, rests, chart?.element, facts) : null;
  const work = el("div", { class: beside ? "work" : "work alone" }, picture, beside);
  const wide = [report.parameters?.length && !brief ? parameters(report.parameters) : null,
    report.points?.length && !(brief && report.kind !== "inspect") ? points(report, (index) => {
      if (passes.length > 1 && store.state.shown !== "both") store.set({ shown: stage.touched });
      stage.showPoint(index);
      picture.scrollIntoView({ block: "nearest" });
    }) : null, report.program && !brief ? program(report.program, among?.names) : null].filter((block) => block !== null);
  const side = brief ? [] : [readout?.element, beside?.contains(facts) ? null : facts].filter((block) => block);
  const below = el("div", { class: side.length && wide.length ? "below" : "below alone" },
    side.length ? el("div", { class: "side" }, ...side) : null, wide.length ? el("div", { class: "wide" }, ...wide) : null);
  picture.hidden = !seen;
  // Nothing is said of keys for what is not there.
  if (!brief && cutterKeys && !model) cutterKeys.remove();
  else if (!brief && cutterKeys) document.getElementById("keys")?.append(cutterKeys);
  const figures = results(report, model, brief);
  // Part and signature are those of the whole page.
  const [named, signed] = among ? [null, null] : [part(report), signature(report)];

  // Those that are open share the room beside the picture; below it they have a height of their own.
  const traceHeight = () => {
    const beside = picture.clientHeight - 47 - FOLDED * (traces?.folded ?? 0);
    const room = work.clientWidth > 900 ? beside / Math.max(1, traces?.open || 1) - 20 : 110;
    return Math.max(72, Math.min(TALLEST, Math.floor(room)));
  };
  let written = 0;
  tracesBox.addEventListener("keydown", (event) => {
    const moved = model ? stretched(event.key, store.state.range, model, store.state.place) : undefined;
    if (moved === undefined || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    store.set({ range: moved });
  });
  stage.onToggle = () => player?.toggle();
  store.onChange((changed) => {
    if (changed.has("shown")) {
      readout?.only(seenPasses(model, store.state.shown));
      const chosen = store.state.magnify !== fitting;
      fitting = factor(store.state.shown);
      if (!chosen) store.set({ magnify: fitting });
      stage.layout();
    }
    if (changed.has("magnify") || changed.has("hidden") || changed.has("height")) stage.still();
    if (changed.has("shown") || changed.has("height")) traces?.rebuild(store.state, colours, traceHeight());
    if (changed.has("range")) traces?.zoom(store.state.range);
    // Nobody reads figures that change sixty times a second.
    const figures = !store.state.playing || performance.now() - written > 100;
    if (figures) written = performance.now();
    if (model && changed.has("place") && store.state.playing) store.set({ range: turned(store.state.range, model, store.state.place) });
    if (changed.has("range") || changed.has("place") || changed.has("playing")) traces?.place(store.state.place, figures);
    if (changed.has("place") || changed.has("playing") || changed.has("follow")) {
      stage.moving();
      if (figures) readout?.show(Math.round(store.state.place));
    }
    if (model && (changed.has("place") || changed.has("playing")) && !store.state.playing) announce(model, store.state);
  });
  let width = 0;
  const seenWidth = new ResizeObserver(() => {
    if (document.documentElement.dataset.printing || Math.abs(work.clientWidth - width) < 1) return;
    width = work.clientWidth;
    stage.layout();
    unrolled?.draw();
    traces?.resize(traceHeight());
    traces?.place(store.state.place);
  });
  const begin = () => {
    chart?.draw();
    stage.layout();
    unrolled?.draw();
    traces?.rebuild(store.state, colours, traceHeight());
    readout?.only(seenPasses(model, store.state.shown));
    readout?.show(0);
    seenWidth.observe(work);
  };
  const close = () => {
    store.set({ playing: false });
    seenWidth.disconnect();
    chart?.close();
    traces?.close();
  };
  const nodes = [...figures, named, work, unrolled?.element ?? null, below, signed].filter((node) => node !== null);
  return { nodes, stage, store, traces, several: passes.length > 1, begin, recolour, resay, close };
}

/** The passes that are to be seen: one, or both that are compared. */
export function seenPasses(model: Model | null, shown: Shown): PassName[] {
  return shown === "both" ? model?.compared.map((pass) => pass.name) ?? [] : [shown];
}

const cutterKeys = document.getElementById("keys-cutter");

let pending = 0;

/** Tells a reader of the screen, once what is told has come to rest. */
export function tell(text: () => string): void {
  clearTimeout(pending);
  pending = window.setTimeout(() => { (document.getElementById("live") as HTMLElement).textContent = text(); }, 400);
}

function announce(model: Model, { place, shown }: State): void {
  tell(() => {
    const index = Math.round(place);
    const errors = model.passes.filter((pass) => seenPasses(model, shown).includes(pass.name)).flatMap((pass) => {
      const error = pass.series.error_mm;
      return error ? [`${model.of("error", pass)} ${withUnit(sayError(error.values[index]))}`] : [];
    });
    return [placeText(model, index), ...errors].join("; ");
  });
}

