/** The scenes together: one or two of them in one view, what is hovered, the legend. */

import { between } from "./cutter";
import type { ProbePoint, Report } from "./data";
import { el } from "./dom";
import type { Picture } from "./draw";
import { fixed, sayDeviation, sayLength, withUnit } from "./format";
import { decimalsTelling, limitsOf, verdictWord, type Limits } from "./limits";
import type { Model, Pass, PassName } from "./model";
import { nearestSample } from "./nearest";
import { boxOf, offsetOf, outline, type Line } from "./outline";
import type { Palette } from "./palette";
import { statusOf } from "./panels";
import { flagLines } from "./readout";
import { Scene } from "./scene";
import type { Store } from "./state";
import { trimmed, type Trimmed } from "./trim";
import { View, type Box } from "./view";

export class Stage {
  readonly element = el("div", { class: "scenes" });
  readonly view: View;
  private readonly scenes: { name: PassName; scene: Scene }[];
  private readonly flag = el("div", { class: "flag", "aria-hidden": "true" });
  /** The wall as it should be. */
  readonly wall: Trimmed | null;
  private readonly stock: Line | null;
  private readonly outlines: { wall: Line[]; stock: Line[] };
  private readonly points: ProbePoint[];
  private readonly limits: Limits | undefined;
  private readonly largestForce: number;
  private hovered: number | null = null;
  private picked: number | null = null;
  readonly whole: Box;
  /** The pass that the probe points stand beside: that of the part which was touched. */
  readonly touched: PassName;

  constructor(private readonly report: Report, readonly model: Model | null, private readonly store: Store, private colours: Palette,
    private readonly hoverChanged: (index: number | null) => void) {
    const given = { wall: outline(report.outlines?.wall, "wall") ?? [], stock: outline(report.outlines?.stock, "stock") ?? [] };
    this.outlines = given;
    this.wall = model ? trimmed(model, offsetOf(model, model.radius), model.radius) : null;
    const allowance = report.job?.stock?.allowance_mm;
    this.stock = model && allowance !== undefined && given.stock.length === 0 ? trimmed(model, offsetOf(model, model.radius - allowance), model.radius - allowance) : null;
    if (model) this.outlines = { wall: [], stock: given.stock };
    this.limits = limitsOf(report);
    this.points = report.points ?? [];
    this.touched = (model?.pass("milled") ?? model?.passes[0])?.name ?? "before";
    // A reading set aside may lie anywhere: where there is something else to see, the view does not reach out for it.
    const known = this.points.filter((p) => p.error_mm !== undefined);
    const framed = model || given.wall.length > 0 || known.length > 0 ? known : this.points;
    const touched = { x: Float64Array.from(framed, (p) => p.x_mm), y: Float64Array.from(framed, (p) => p.y_mm) };
    const path = model ? [{ x: model.x.values, y: model.y.values }, this.wall as Line] : [];
    this.whole = boxOf([...path, ...given.wall, ...given.stock, touched], Math.max(1, (model?.radius ?? 0) * 0.4));
    this.view = new View(this.whole);
    const forces = (model?.passes ?? []).map((pass) => pass.series.force_n?.values).filter((v) => v !== undefined);
    this.largestForce = forces.reduce((most, values) => values.reduce((m, v) => (v > m ? v : m), most), 0);
    const names: PassName[] = model?.passes.map((pass) => pass.name) ?? [];
    this.scenes = (names.length ? names : (["before"] as PassName[])).map((name) => ({ name, scene: this.scene(name) }));
    this.element.append(...this.scenes.map(({ scene }) => scene.element), this.flag);
  }

  private scene(name: PassName): Scene {
    const pass = this.model?.pass(name);
    const label = pass ? `Contour, ${this.model?.called(pass)}, to scale, errors enlarged` : "Wall and probe points";
    return new Scene(this.view, {
      view: () => this.still(),
      hover: (scene, px, py) => this.hover(scene, px, py),
      leave: () => this.hoverAt(null),
      pick: (px, py) => { const index = this.nearest(px, py); if (index !== null) this.store.set({ place: index, playing: false }); },
      step: (samples) => this.step(samples),
      toggle: () => this.onToggle(),
    }, label);
  }

  onToggle: () => void = () => undefined;

  private step(samples: number): void {
    if (!this.model) return;
    const last = this.model.count - 1;
    const place = Number.isNaN(samples) ? 0 : Math.min(last, Math.max(0, Math.round(this.store.state.place) + samples));
    this.store.set({ place, playing: false });
  }

  recolour(colours: Palette): void {
    this.colours = colours;
    this.still();
  }

  /** After a change of size or of what is shown. */
  layout(paper?: number): void {
    const { shown } = this.store.state;
    const compared = this.model?.compared.map((pass) => pass.name) ?? [];
    for (const { name, scene } of this.scenes) {
      scene.element.hidden = this.scenes.length > 1 && (shown === "both" ? !compared.includes(name) : name !== shown);
    }
    this.element.classList.toggle("double", shown === "both" && this.scenes.length > 1);
    for (const { scene } of this.visible()) scene.measure(paper);
    this.still();
  }

  /** Everything that does not move. */
  still(): void {
    for (const { name, scene } of this.visible()) {
      const picture = this.picture(name);
      scene.caption.textContent = this.caption(name);
      scene.drawStill(picture, this.colours);
      this.moveOne(name, scene);
    }
  }

  /** The cutter and the place hovered over; everything when the picture follows the cutter. */
  moving(): void {
    if (this.store.state.follow && this.model) {
      const { place } = this.store.state;
      this.view.centre(between(this.model.x.values, place), between(this.model.y.values, place));
      this.still();
      return;
    }
    for (const { name, scene } of this.visible()) this.moveOne(name, scene);
  }

  /** Marks a sample from elsewhere. */
  mark(index: number | null): void {
    this.hovered = index;
    this.moving();
  }

  /** Shows a place of the wall in the middle of the picture, no smaller than it was: zooming then goes to it. */
  showPlace(index: number): void {
    if (!this.model || !this.wall) return;
    const { view } = this;
    const [x, y] = [this.wall.x[index], this.wall.y[index]];
    const half = Math.max(3, this.model.radius * 1.2);
    const { scale } = view;
    view.show({ x0: x - half, x1: x + half, y0: y - half, y1: y + half });
    if (view.scale < scale) view.zoom(scale / view.scale);
    this.still();
  }

  /** Shows a probe point large. */
  showPoint(index: number): void {
    const point = this.points[index];
    this.picked = index;
    const half = Math.max(3, (this.model?.radius ?? 5) * 0.8);
    this.view.show({ x0: point.x_mm - half, x1: point.x_mm + half, y0: point.y_mm - half, y1: point.y_mm + half });
    this.still();
  }

  /** Shows a stretch of the contour as large as it goes. */
  showRange([from, to]: [number, number]): void {
    if (!this.model || !this.wall) return;
    const first = this.model.indexAt(from);
    const last = this.model.nearest(to) + 1;
    const cut = (line: Line): Line => ({ x: line.x.slice(first, last), y: line.y.slice(first, last) });
    this.view.show(boxOf([cut(this.wall), cut({ x: this.model.x.values, y: this.model.y.values })], 0));
    this.still();
  }

  private moveOne(name: PassName, scene: Scene): void {
    scene.drawMoving(this.picture(name), this.colours, this.store.state.place, this.largestForce, this.hovered);
  }

  private visible(): { name: PassName; scene: Scene }[] {
    return this.scenes.filter(({ scene }) => !scene.element.hidden);
  }

  private caption(name: PassName): string {
    const { magnify, height } = this.store.state;
    const pass = this.model?.pass(name);
    const z = height === null ? "" : `, ${withUnit(sayLength(this.report.heights?.z_mm[height], 2))} above the tip`;
    return `${pass ? this.model?.called(pass) : "wall and probe points"}${z}; errors ${magnify}\u00a0×`;
  }

  /** The passes that are to be seen. */
  private passesShown(): Pass[] {
    const seen = this.visible().map(({ name }) => name);
    return this.model?.passes.filter((pass) => seen.includes(pass.name)) ?? [];
  }

  private picture(name: PassName): Picture {
    const { magnify, height, hidden } = this.store.state;
    return {
      model: this.model, pass: this.model?.pass(name) ?? null, error: this.model?.error(name, height),
      wall: this.wall, stock: this.stock, outlines: this.outlines,
      points: name === this.touched || this.scenes.length === 1 ? this.points : [],
      magnify, limits: this.limits, hidden, picked: this.picked,
    };
  }

  nearest(px: number, py: number): number | null {
    return this.model && this.wall ? nearestSample(this.model, this.wall, this.view, px, py) : null;
  }

  private hover(scene: Scene, px: number, py: number): void {
    const point = this.pointAt(px, py, scene);
    if (point !== null) {
      const p = this.points[point];
      this.hoverAt(null);
      this.show(scene, px, py, [
        ["probe point", String(p.line ?? point + 1)], ["deviation", withUnit(sayDeviation(p.error_mm, decimalsTelling(this.points, this.limits)))],
        ["X, Y", withUnit(`${sayLength(p.x_mm)}, ${sayLength(p.y_mm)}`)], ["normal", `${fixed(p.nx, 3)}, ${fixed(p.ny, 3)}`],
        ...(p.verdict ? [["verdict", verdictWord(p, this.limits)] as [string, string]] : []),
        ...(p.z_mm === undefined ? [] : [["height", withUnit(sayLength(p.z_mm, 2))] as [string, string]]),
        ["status", statusOf(p)],
      ]);
      return;
    }
    const index = this.nearest(px, py);
    this.hoverAt(index);
    if (index !== null && this.model) this.show(scene, px, py, flagLines(this.model, this.passesShown(), index, this.store.state.height));
  }

  private pointAt(px: number, py: number, scene: Scene): number | null {
    const name = this.scenes.find((s) => s.scene === scene)?.name;
    if (this.scenes.length > 1 && name !== this.touched || this.store.state.hidden.has("points")) return null;
    const { magnify } = this.store.state;
    let best: number | null = null;
    let least = 9;
    this.points.forEach((p, i) => {
      const { nx = 0, ny = 0, error_mm: error = 0 } = p;
      const x = this.view.px(p.x_mm + (1 - magnify) * error * nx);
      const y = this.view.py(p.y_mm + (1 - magnify) * error * ny);
      const distance = Math.hypot(x - px, y - py);
      if (distance < least) [least, best] = [distance, i];
    });
    return best;
  }

  private hoverAt(index: number | null): void {
    this.flag.classList.remove("shown");
    if (index === this.hovered) return;
    this.hovered = index;
    this.moving();
    this.hoverChanged(index);
  }

  private show(scene: Scene, px: number, py: number, lines: [string, string][]): void {
    this.flag.replaceChildren(...lines.flatMap(([name, value]) => [el("span", {}, name), el("b", {}, value)]));
    this.flag.classList.add("shown");
    const left = scene.stage.offsetLeft + px;
    const top = scene.stage.offsetTop + py;
    const { offsetWidth: wide, offsetHeight: high } = this.flag;
    const x = left + 16 + wide > this.element.clientWidth ? Math.max(0, left - wide - 16) : left + 16;
    const y = top + 16 + high > this.element.clientHeight ? Math.max(0, top - high - 16) : top + 16;
    this.flag.style.transform = `translate(${x}px, ${y}px)`;
  }
}
