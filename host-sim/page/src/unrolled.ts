/**
 * The wall with its error in colour, limits as lines on it, touches, two passes by a slider: unrolled over arc length and height,
 * or in 3D where the browser can.
 */

import type { ProbePoint, Report } from "./data";
import { factorField } from "./controls";
import { card, el } from "./dom";
import { fixed, sayDeviation, sayError, sayLength, stepDecimals, unitOf, withUnit } from "./format";
import { limitsOf, standing, type Limits } from "./limits";
import { drawMark } from "./marks";
import type { Model } from "./model";
import type { Palette } from "./palette";
import { colourOf, pixelOf, roundScale } from "./shades";
import { Solid } from "./solid";
import type { Stage } from "./stage";
import type { Store } from "./state";
import { Surface } from "./surface";
import type { Trimmed } from "./trim";
import { roundStep } from "./view";

/** Edges of the drawing, pixels of the style sheet. */
const EDGE = { left: 46, right: 12, top: 10, bottom: 24 };
/** Steps of the keys along the contour, as shares of it; with Shift ten of them. */
const STEP = 1 / 400;

type Way = "map" | "3D";

/** How the reader looks at walls, from one contour to the next. */
let chosen: Way = "map";

const TITLES: Record<Way, string> = { map: "The wall unrolled", "3D": "The wall in 3D" };
const KEYS: Record<Way, string> = {
  map: "Arrows move over the wall, with Shift ten times as far; Home and End lead to its ends, Page Up and Page Down to its top and its tip; Enter puts the cutter there.",
  "3D": "Arrows turn and tilt the wall, with Shift farther; plus and minus zoom, 0 shows all of it; comma and full stop step the cutter, with Shift ten samples; Page Up and Page Down read the error at the cutter higher and lower.",
};
/** What it says where it cannot draw in 3D. */
const NONE = "This browser cannot draw in 3D (it has no WebGL); the map shows the same errors.";
const LOST = "The 3D view was taken away by the graphics of this computer; the map shows the same errors.";

export class Unrolled {
  readonly element: HTMLElement;
  private readonly stage = el("div", { class: "unrolled", tabindex: "0", role: "application", "aria-describedby": "unrolled-keys" });
  private readonly keys = el("p", { class: "hidden", id: "unrolled-keys" });
  /** Why there is no 3D view. */
  private readonly problem = el("p", { class: "unrolled-problem", role: "status" });
  private readonly ways = new Map<Way, HTMLInputElement>();
  /** Buttons and choices of the 3D view. */
  private readonly turns = el("div", { class: "unrolled-turns", role: "group", "aria-label": "3D view" });
  private readonly touched: string;
  private solid: Solid | null = null;
  private due = false;
  private readonly canvas = el("canvas", { "aria-hidden": "true" });
  private readonly cross = el("div", { class: "cross", hidden: "" });
  private readonly told = el("p", { class: "unrolled-told", role: "status" });
  private readonly words = el("p", { class: "unrolled-words" });
  private readonly bar = el("canvas", { width: "160", height: "12", "aria-hidden": "true" });
  private readonly ends = [el("span", {}), el("span", {})];
  private readonly lines = el("span", {});
  private readonly points: ProbePoint[];
  private readonly limits: Limits | undefined;
  private readonly faces: Surface[];
  private readonly depth: number;
  /** Largest error that the colours tell, mm. */
  private scale = 0;
  rescale: () => void = () => undefined;
  /** How much of the length shows the second pass, 0…1. */
  private share = 0;
  private at: { s: number; z: number };
  private ratio = 1;

  /** Where the error over the height is known; otherwise there is nothing to unroll. */
  static of(report: Report, model: Model | null, store: Store, stage: Stage, colours: () => Palette): Unrolled | null {
    const faces = (model?.compared ?? []).map((pass) => new Surface(model as Model, pass)).filter((face) => face.known);
    return model && stage.wall && faces.length > 0 ? new Unrolled(report, model, store, faces, stage.wall, stage.touched, colours) : null;
  }

  private constructor(report: Report, private readonly model: Model, private readonly store: Store, faces: Surface[], private readonly wall: Trimmed, touched: string, private readonly colours: () => Palette) {
    this.faces = faces;
    this.touched = touched;
    this.limits = limitsOf(report);
    this.points = (report.points ?? []).filter((p) => p.s_mm !== undefined && p.z_mm !== undefined && p.error_mm !== undefined);
    this.depth = Math.max(...(report.heights?.z_mm ?? [1]));
    const largest = Math.max(...faces.map((face) => face.largest()));
    this.at = { s: model.s.values[0], z: this.depth / 2 };
    const key = el("p", { class: "chart-key unrolled-key" }, el("span", {}, this.ends[0], this.bar, this.ends[1]), this.lines,
      this.points.length ? el("span", {}, "marks: touched places, in the colour of what was measured") : null);
    this.stage.append(this.canvas, this.cross);
    this.element = card("unrolled", TITLES.map, el("div", { class: "unrolled-bar" }, this.choice(), ...this.controls(largest), this.turns), this.problem, this.stage, key, this.told, this.words, this.keys);
    this.turning();
    this.listen();
    this.store.onChange((changed) => {
      if (changed.has("place") || changed.has("height")) this.follow();
      if (this.solid && ["place", "magnify", "hidden"].some((key) => changed.has(key as "place"))) this.soon();
    });
    this.look(chosen);
  }

  private choice(): HTMLElement {
    const group = el("div", { class: "segments", role: "radiogroup", "aria-label": "The wall as" });
    for (const way of ["map", "3D"] as const) {
      const input = el("input", { type: "radio", name: "wall-as", id: `wall-${way}`, value: way });
      input.addEventListener("change", () => { this.look(way); this.draw(); });
      this.ways.set(way, input);
      group.append(input, el("label", { for: input.id }, way));
    }
    return group;
  }

  /** Shows the wall as a map or in 3D; as a map where it cannot be the other. */
  private look(way: Way, problem = ""): void {
    this.solid = null;
    this.problem.textContent = problem;
    if (way === "3D") {
      try {
        this.solid = new Solid(this.model, this.wall, this.faces, () => { this.look("map", LOST); this.draw(); });
      } catch {
        this.problem.textContent = NONE;
      }
    }
    chosen = this.solid ? "3D" : "map";
    for (const [name, input] of this.ways) input.checked = name === chosen;
    this.turns.hidden = !this.solid;
    this.stage.style.touchAction = "";
    this.stage.classList.toggle("solid", this.solid !== null);
    this.keys.textContent = KEYS[chosen];
    const title = this.element.querySelector("h2");
    if (title) title.textContent = TITLES[chosen];
  }

  /** The 3D view for who does not drag. */
  private turning(): void {
    const button = (text: string, name: string, run: (solid: Solid) => void) => {
      const element = el("button", { type: "button", title: name, ...(/^[a-z]/.test(text) ? {} : { "aria-label": name }) }, text);
      element.addEventListener("click", () => { if (this.solid) run(this.solid); this.draw(); });
      return element;
    };
    this.turns.append(factorField(this.store, "wall-magnify"), el("div", { class: "buttons" },
      button("←", "Turn the wall to the left", (solid) => solid.turn(15)), button("→", "Turn the wall to the right", (solid) => solid.turn(-15)),
      button("↑", "Look from higher up", (solid) => solid.turn(0, 10)), button("↓", "Look from lower down", (solid) => solid.turn(0, -10)),
      button("+", "Zoom the wall in", (solid) => solid.zoom(1.5)), button("−", "Zoom the wall out", (solid) => solid.zoom(1 / 1.5)),
      button("whole", "Show all of the wall", (solid) => solid.fit()), button("cutter", "Turn the wall so that the place of the cutter faces you", (solid) => solid.face(this.store.state.place, this.at.z))));
  }

  /** Draws once before the next picture of the screen, however often it is asked for. */
  private soon(): void {
    if (this.due) return;
    this.due = true;
    requestAnimationFrame(() => { this.due = false; if (document.documentElement.dataset.printing === undefined) this.draw(); });
  }

  private controls(largest: number): HTMLElement[] {
    const select = el("select", { id: "colour-scale" });
    select.addEventListener("change", () => { this.scale = Number(select.value); this.draw(); });
    // Round scales of the unit in which lengths are said; the one chosen stays the one as large a part of the largest error.
    this.rescale = () => {
      const scales = [...new Set([1, 2, 5, 10, 20, 50].map((part) => roundScale(largest / part)))];
      const chosen = Math.max(0, select.selectedIndex);
      select.replaceChildren(...scales.map((v) => el("option", { value: String(v) }, `± ${withUnit(sayError(v))}`)));
      select.selectedIndex = Math.min(chosen, scales.length - 1);
      this.scale = Number(select.value);
    };
    this.rescale();
    const controls: HTMLElement[] = [el("label", { class: "field" }, "colours up to", select)];
    if (this.faces.length > 1) {
      const [one, other] = this.faces.map((face) => face.pass.title);
      const input = el("input", { type: "range", id: "wipe", min: "0", max: "100", step: "1", value: "0", "aria-label": `From ${one} to ${other}` });
      const said = () => input.setAttribute("aria-valuetext", input.value === "0" ? one : input.value === "100" ? other : `${other} on the first ${input.value} % of the contour, ${one} on the rest`);
      input.addEventListener("input", () => { this.share = Number(input.value) / 100; said(); this.draw(); });
      said();
      controls.unshift(el("div", { class: "wipe" }, el("span", {}, one), input, el("span", {}, other)));
    }
    return controls;
  }

  private get box(): { left: number; top: number; width: number; height: number } {
    const { clientWidth, clientHeight } = this.stage;
    return { left: EDGE.left, top: EDGE.top, width: Math.max(20, clientWidth - EDGE.left - EDGE.right), height: clientHeight - EDGE.top - EDGE.bottom };
  }

  private px(s: number): number {
    const { left, width } = this.box;
    return left + ((s - this.model.s.values[0]) / (this.model.length || 1)) * width;
  }

  private py(z: number): number {
    const { top, height } = this.box;
    return top + (1 - z / this.depth) * height;
  }

  private place(px: number, py: number): { s: number; z: number } {
    const { left, top, width, height } = this.box;
    const clip = (v: number) => Math.min(1, Math.max(0, v));
    return { s: this.model.s.values[0] + clip((px - left) / width) * this.model.length, z: (1 - clip((py - top) / height)) * this.depth };
  }

  /** The pass that is shown at an arc length. */
  private faceAt(s: number): Surface {
    const along = (s - this.model.s.values[0]) / (this.model.length || 1);
    return this.faces.length > 1 && along < this.share ? this.faces[1] : this.faces[0];
  }

  draw(paper?: number): void {
    const { clientWidth, clientHeight } = this.stage;
    if (clientWidth < 1) return;
    this.ratio = paper ?? (window.devicePixelRatio || 1);
    this.canvas.width = Math.round(clientWidth * this.ratio);
    this.canvas.height = Math.round(clientHeight * this.ratio);
    const c = this.canvas.getContext("2d");
    if (!c) return;
    const colours = this.colours();
    c.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    c.fillStyle = colours.ground;
    c.fillRect(0, 0, clientWidth, clientHeight);
    if (this.solid) {
      const { state } = this.store;
      const points = this.points.filter((p) => this.marked(p));
      this.solid.draw(c, clientWidth, clientHeight, this.ratio, { state, share: this.share, surfaceAt: (s) => this.faceAt(s), points, limits: this.limits, scale: this.scale, levels: this.levels() }, colours);
      // On a screen that is touched the page scrolls over a wall that is seen whole.
      this.stage.style.touchAction = this.solid.fitted ? "pan-y" : "none";
      this.stage.dataset.view = this.solid.view;
    } else {
      this.fill(c, colours);
      this.isolines(c);
      this.axes(c, colours);
      this.touches(c);
    }
    this.legend();
    this.tell();
    this.follow();
  }

  private fill(c: CanvasRenderingContext2D, colours: Palette): void {
    const { left, top, width, height } = this.box;
    const [wide, high] = [Math.max(1, Math.round(width)), Math.round(height)];
    const image = new ImageData(wide, high);
    const pixels = new Uint32Array(image.data.buffer);
    const heights = Float64Array.from({ length: high }, (_, y) => (1 - (y + 0.5) / high) * this.depth);
    for (let x = 0; x < wide; x++) {
      const s = this.model.s.values[0] + ((x + 0.5) / wide) * this.model.length;
      const errors = this.faceAt(s).column(s, heights);
      for (let y = 0; y < high; y++) {
        if (!Number.isNaN(errors[y])) pixels[y * wide + x] = pixelOf(errors[y] / this.scale);
      }
    }
    const map = document.createElement("canvas");
    [map.width, map.height] = [wide, high];
    map.getContext("2d")?.putImageData(image, 0, 0);
    // Where no wall stands there is no colour.
    c.fillStyle = colours.part;
    c.fillRect(left, top, width, height);
    c.imageSmoothingEnabled = false;
    c.drawImage(map, left, top, width, height);
  }

  /** The errors that have a line: the limits, or half of the scale to both sides. */
  private levels(): [number, number] {
    return this.limits ? [this.limits.lower, this.limits.upper] : [-this.scale / 2, this.scale / 2];
  }

  /** Lines of one error, by marching squares over cells of a few pixels. */
  private isolines(c: CanvasRenderingContext2D): void {
    const { left, top, width, height } = this.box;
    const cell = 3;
    const [nx, ny] = [Math.ceil(width / cell), Math.ceil(height / cell)];
    const px = (i: number) => left + (i / nx) * width;
    const py = (k: number) => top + (k / ny) * height;
    const heights = Float64Array.from({ length: ny + 1 }, (_, k) => (1 - k / ny) * this.depth);
    const along = Array.from({ length: nx + 1 }, (_, i) => this.model.s.values[0] + (i / nx) * this.model.length);
    const grid = along.map((s) => this.faceAt(s).column(s, heights));
    c.strokeStyle = "#111";
    c.lineWidth = 1.1;
    for (const level of this.levels()) {
      c.setLineDash(level < 0 ? [4, 3] : []);
      c.beginPath();
      for (let i = 0; i < nx; i++) {
        // Where one pass ends and the other begins there is no wall between.
        if (this.faceAt(along[i]) !== this.faceAt(along[i + 1])) continue;
        for (let k = 0; k < ny; k++) {
          const corners: [number, number, number][] = [[i, k, grid[i][k]], [i + 1, k, grid[i + 1][k]], [i + 1, k + 1, grid[i + 1][k + 1]], [i, k + 1, grid[i][k + 1]]];
          const crossed: [number, number][] = [];
          corners.forEach(([x0, y0, a], n) => {
            const [x1, y1, b] = corners[(n + 1) % 4];
            if (Number.isNaN(a) || Number.isNaN(b) || (a < level) === (b < level)) return;
            const t = (level - a) / (b - a);
            crossed.push([px(x0 + (x1 - x0) * t), py(y0 + (y1 - y0) * t)]);
          });
          for (let n = 0; n + 1 < crossed.length; n += 2) {
            c.moveTo(...crossed[n]);
            c.lineTo(...crossed[n + 1]);
          }
        }
      }
      c.stroke();
    }
    c.setLineDash([]);
  }

  private axes(c: CanvasRenderingContext2D, colours: Palette): void {
    const { left, top, width, height } = this.box;
    c.font = `11px ${colours.font}`;
    c.fillStyle = colours.quiet;
    c.strokeStyle = colours.quiet;
    c.lineWidth = 1;
    c.strokeRect(left - 0.5, top - 0.5, width + 1, height + 1);
    const first = this.model.s.values[0];
    const step = roundStep(this.model.length / Math.max(2, Math.floor(width / 110)));
    c.textBaseline = "top";
    const name = `s ${unitOf()}`;
    const end = left + width - c.measureText(name).width;
    c.fillText(name, end, top + height + 6);
    for (let k = Math.ceil(first / step); k * step <= first + this.model.length + 1e-9; k++) {
      const x = this.px(k * step);
      const text = sayError(k * step, stepDecimals(step));
      const wide = c.measureText(text).width;
      c.fillRect(x - 0.5, top + height, 1, 4);
      const at = Math.max(2, x - wide / 2);
      if (at + wide < end - 8) c.fillText(text, at, top + height + 6);
    }
    const up = roundStep(this.depth / 4);
    c.textAlign = "right";
    c.textBaseline = "middle";
    for (let k = 0; k * up <= this.depth * (1 + 1e-9); k++) c.fillText(sayError(k * up, stepDecimals(up)), left - 6, this.py(k * up));
    c.textAlign = "left";
    c.textBaseline = "alphabetic";
    if (this.faces.length > 1 && this.share > 0 && this.share < 1) {
      c.fillStyle = colours.ink;
      c.fillRect(left + this.share * width - 1, top - 4, 2, height + 8);
    }
  }

  /** Touches are of one of the passes, and stand where that is shown. */
  private marked(p: ProbePoint): boolean {
    return p.status === "used" && this.faceAt(p.s_mm as number).pass.name === this.touched;
  }

  private touches(c: CanvasRenderingContext2D): void {
    for (const p of this.points.filter((point) => this.marked(point))) {
      const [r, g, b] = colourOf((p.error_mm as number) / this.scale);
      c.fillStyle = `rgb(${r}, ${g}, ${b})`;
      c.strokeStyle = "#111";
      c.lineWidth = 1.4;
      drawMark(c, standing(p, this.limits), this.px(p.s_mm as number), this.py(p.z_mm as number), 4);
    }
  }

  private legend(): void {
    const c = this.bar.getContext("2d");
    const { width, height } = this.bar;
    for (let x = 0; c && x < width; x++) {
      const [r, g, b] = colourOf((2 * (x + 0.5)) / width - 1);
      c.fillStyle = `rgb(${r}, ${g}, ${b})`;
      c.fillRect(x, 0, 1, height);
    }
    const beyond = this.faces.some((face) => face.largest() > this.scale);
    this.ends[0].textContent = `too deep ${sayDeviation(-this.scale)}${beyond ? " and more" : ""}`;
    this.ends[1].textContent = `${withUnit(sayDeviation(this.scale))}${beyond ? " and more" : ""}, left`;
    const [lower, upper] = this.levels();
    this.lines.textContent = `lines: ${this.limits ? "tolerance, " : ""}${withUnit(sayDeviation(upper))} full, ${withUnit(sayDeviation(lower))} dashed`;
  }

  /** What the picture shows, for who does not see it. */
  private tell(): void {
    const said = this.faces.map((face) => {
      const share = this.limits ? `, ${fixed(100 * face.within(this.limits), 0)} % of it within tolerance` : "";
      return `${this.model.passes.length > 1 ? `${face.pass.title}: ` : ""}largest error at ${face.heights} heights ${withUnit(sayError(face.largest()))}${share}`;
    });
    const { solid } = this;
    const drawn = `errors ${this.store.state.magnify}\u00a0×${solid && solid.rise > 1 ? `, height ${solid.rise}\u00a0×` : ""}`;
    const what = solid ? `What is left stands out from the black line of the wall as it should be, what is too deep lies behind it; seen from behind, through the part, the wall is pale; ${drawn}.` : `Height above the tip of the cutter, ${unitOf()}, over arc length.`;
    this.words.textContent = `${what} ${said.join("; ")}.`;
    const seen = solid ? ` Seen ${solid.side}; ${drawn}.` : "";
    this.stage.setAttribute("aria-label", `${TITLES[chosen]}, ${withUnit(sayLength(this.model.length, 1))} long, ${withUnit(sayLength(this.depth, 1))} high. ${said.join("; ")}.${seen}`);
  }

  /** Puts the cross where the cutter is, at the height shown. */
  private follow(): void {
    const { place, height } = this.store.state;
    if (height !== null) this.at.z = this.model.report.heights?.z_mm[height] ?? this.at.z;
    this.at.s = this.model.s.values[Math.round(place)];
    this.point();
  }

  /** Says what is at the cross. */
  private point(): void {
    const { s, z } = this.at;
    this.cross.hidden = false;
    const face = this.faceAt(s);
    const [px, py] = this.solid ? this.solid.pixels(s, z, face, this.store.state.magnify) : [this.px(s), this.py(z)];
    this.cross.style.transform = `translate(${px.toFixed(1)}px, ${py.toFixed(1)}px)`;
    const e = face.at(s, z);
    const name = this.model.passes.length > 1 ? `${face.pass.title} ` : "";
    this.told.textContent = `s ${withUnit(sayLength(s, 1))}, ${withUnit(sayLength(z, 1))} above the tip: ${name}${Number.isNaN(e) ? "no wall" : withUnit(sayDeviation(e))}`;
  }

  private go(): void {
    this.store.set({ place: this.model.nearest(this.at.s), playing: false });
  }

  private listen(): void {
    const on = (event: MouseEvent): [number, number] => {
      const { left, top } = this.stage.getBoundingClientRect();
      return [event.clientX - left, event.clientY - top];
    };
    const at = (event: MouseEvent) => (this.solid ? this.solid.pick(...on(event)) : this.place(...on(event)));
    const { stage } = this;
    stage.addEventListener("pointermove", (event) => {
      const place = this.hands.size > 0 ? null : at(event);
      if (place) { this.at = place; this.point(); }
    });
    stage.addEventListener("pointerleave", () => this.follow());
    stage.addEventListener("click", (event) => {
      const place = this.dragged ? null : at(event);
      if (place) { this.at = place; this.go(); }
    });
    stage.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      if (!(this.solid ? this.keyInSpace(event, this.solid) : this.keyOnMap(event))) return;
      event.preventDefault();
    });
    this.turnedByHand();
  }

  /** Fingers, or the mouse while it is held down, on the 3D view; whether they have moved. */
  private readonly hands = new Map<number, [number, number]>();
  private dragged = false;

  private turnedByHand(): void {
    const { stage, hands } = this;
    let from: [number, number] = [0, 0];
    let back = () => {};
    const on = (event: PointerEvent | WheelEvent): [number, number] => {
      const { left, top } = stage.getBoundingClientRect();
      return [event.clientX - left, event.clientY - top];
    };
    stage.addEventListener("wheel", (event) => {
      // As over the picture: a wheel that passes by scrolls the page; a pinch of a touchpad comes with Ctrl.
      if (!this.solid || (!event.ctrlKey && !event.metaKey && document.activeElement !== stage)) return;
      event.preventDefault();
      const lines = event.deltaMode === 1 ? 30 : 1;
      this.solid.zoom(Math.exp(-Math.max(-300, Math.min(300, event.deltaY * lines)) * 0.0018), ...on(event));
      this.soon();
    }, { passive: false });
    stage.addEventListener("pointerdown", (event) => {
      this.dragged = hands.size > 0;
      if (!this.solid || event.button !== 0) return;
      stage.setPointerCapture(event.pointerId);
      hands.set(event.pointerId, on(event));
      from = on(event);
      if (hands.size === 1) back = this.solid.remember();
    });
    stage.addEventListener("pointermove", (event) => {
      const before = hands.get(event.pointerId);
      if (!this.solid || !before) return;
      const now = on(event);
      if (Math.hypot(now[0] - from[0], now[1] - from[1]) > 4) this.dragged = true;
      if (!this.dragged) return;
      const [dx, dy] = [now[0] - before[0], now[1] - before[1]];
      const other = [...hands].find(([id]) => id !== event.pointerId)?.[1];
      if (other) {
        const [was, is] = [before, now].map((hand) => Math.hypot(hand[0] - other[0], hand[1] - other[1]));
        this.solid.pan(dx / 2, dy / 2);
        if (was > 0 && is > 0) this.solid.zoom(is / was, (now[0] + other[0]) / 2, (now[1] + other[1]) / 2);
      } else if (event.shiftKey) {
        this.solid.pan(dx, dy);
      } else {
        this.solid.drag(dx, dy);
      }
      hands.set(event.pointerId, now);
      this.soon();
    });
    const release = (event: PointerEvent) => {
      if (!hands.delete(event.pointerId)) return;
      // The browser has taken the finger to scroll the page: what it turned before that is taken back.
      if (event.type === "pointercancel") {
        back();
        this.soon();
      }
    };
    stage.addEventListener("pointerup", release);
    stage.addEventListener("pointercancel", release);
    stage.addEventListener("dblclick", () => {
      this.solid?.fit();
      this.soon();
    });
  }

  private keyInSpace(event: KeyboardEvent, solid: Solid): boolean {
    const { place } = this.store.state;
    const far = event.shiftKey ? 10 : 1;
    const step: Record<string, number> = { ",": -far, ".": far, "<": -10, ">": 10 };
    const up: Record<string, number> = { PageUp: this.depth / 20, PageDown: -this.depth / 20 };
    if (event.key in step) this.store.set({ place: Math.min(this.model.count - 1, Math.max(0, Math.round(place) + step[event.key])), playing: false });
    else if (event.key in up) this.at.z = Math.min(this.depth, Math.max(0, this.at.z + up[event.key]));
    else if (solid.key(event)) this.draw();
    else return false;
    this.point();
    return true;
  }

  private keyOnMap(event: KeyboardEvent): boolean {
    const far = event.shiftKey ? 10 : 1;
    const [first, last] = [this.model.s.values[0], this.model.s.values[this.model.count - 1]];
    const along = far * STEP * this.model.length;
    const up = far * (this.depth / 20);
    const keys: Record<string, () => void> = {
      ArrowLeft: () => { this.at.s -= along; }, ArrowRight: () => { this.at.s += along; },
      ArrowUp: () => { this.at.z += up; }, ArrowDown: () => { this.at.z -= up; },
      Home: () => { this.at.s = first; }, End: () => { this.at.s = last; },
      PageUp: () => { this.at.z = this.depth; }, PageDown: () => { this.at.z = 0; },
      Enter: () => this.go(),
    };
    if (!keys[event.key]) return false;
    keys[event.key]();
    this.at = { s: Math.min(last, Math.max(first, this.at.s)), z: Math.min(this.depth, Math.max(0, this.at.z)) };
    this.point();
    return true;
  }
}
