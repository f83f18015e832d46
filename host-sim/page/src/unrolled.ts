/**
 * The wall unrolled: error in colour over arc length and height, limits as lines on it, touches, two passes by a slider.
 *
 * Blue is cut too deep, white is nominal, orange is material left: told apart with any kind of colour blindness. Samples may lie
 * unevenly along the contour and over the height: between them the error is linear in both.
 */

import type { ProbePoint, Report } from "./data";
import { card, el } from "./dom";
import { fixed, LENGTH, signed } from "./format";
import { limitsOf, standing, type Limits } from "./limits";
import { drawMark } from "./marks";
import type { Model, Pass } from "./model";
import type { Palette } from "./palette";
import type { Store } from "./state";
import { roundStep } from "./view";

/** Edges of the drawing, pixels of the style sheet. */
const EDGE = { left: 46, right: 12, top: 10, bottom: 24 };
/** Colours of the scale from too deep over nominal to left: red, green, blue. */
const DEEP = [8, 69, 148];
const DEEPER_HALF = [107, 160, 214];
const NOMINAL = [255, 255, 255];
const LEFT_HALF = [247, 164, 84];
const LEFT = [166, 54, 3];
const SCALE = [DEEP, DEEPER_HALF, NOMINAL, LEFT_HALF, LEFT];
/** Steps of the keys along the contour, as shares of it; with Shift ten of them. */
const STEP = 1 / 400;

/** Colour of an error as a share of the scale, −1 … 1; beyond it that of its end. */
export function colourOf(share: number): [number, number, number] {
  const at = (Math.min(1, Math.max(-1, share)) + 1) * 2;
  const k = Math.min(3, Math.floor(at));
  return [0, 1, 2].map((c) => Math.round(SCALE[k][c] + (SCALE[k + 1][c] - SCALE[k][c]) * (at - k))) as [number, number, number];
}

/** Colours from end to end of the scale, as pixels of a little-endian machine; nominal is in their middle. */
const HALF = 512;
const TABLE = Uint32Array.from({ length: 2 * HALF + 1 }, (_, k) => {
  const [r, g, b] = colourOf(k / HALF - 1);
  return ((255 << 24) | (b << 16) | (g << 8) | r) >>> 0;
});

/** Errors of a pass over the face of its wall. */
export class Face {
  /** Heights in rising order, mm, and the errors at each of them, a value for every sample. */
  private readonly z: number[];
  private readonly rows: Float64Array[];

  constructor(private readonly model: Model, readonly pass: Pass) {
    const heights = (model.report.heights?.z_mm ?? []).flatMap((z, k) => {
      const row = model.error(pass.name, k);
      return row ? [{ z, row }] : [];
    }).sort((a, b) => a.z - b.z);
    this.z = heights.map(({ z }) => z);
    this.rows = heights.map(({ row }) => row);
  }

  get known(): boolean {
    return this.rows.length > 1;
  }

  /** At how many heights the error is known. */
  get heights(): number {
    return this.rows.length;
  }

  /** The largest size of an error, mm. */
  largest(): number {
    return this.rows.reduce((most, row) => row.reduce((m, e) => (Math.abs(e) > m ? Math.abs(e) : m), most), 0);
  }

  /** Share of the face within the limits, by length and height. */
  within(limits: Limits): number {
    let [inside, all] = [0, 0];
    const s = this.model.s.values;
    for (let k = 0; k < this.z.length; k++) {
      const high = (this.z[Math.min(k + 1, this.z.length - 1)] - this.z[Math.max(0, k - 1)]) / 2;
      for (let i = 0; i < s.length; i++) {
        const e = this.rows[k][i];
        if (Number.isNaN(e)) continue;
        const area = high * (s[Math.min(i + 1, s.length - 1)] - s[Math.max(0, i - 1)]) / 2;
        all += area;
        if (e <= limits.upper && e >= limits.lower) inside += area;
      }
    }
    return all > 0 ? inside / all : NaN;
  }

  /** The row below a height and how far it is to the next, 0…1. */
  private level(z: number): [number, number] {
    let k = 0;
    while (k < this.z.length - 2 && this.z[k + 1] <= z) k++;
    return [k, Math.min(1, Math.max(0, (z - this.z[k]) / (this.z[k + 1] - this.z[k])))];
  }

  /** The error at an arc length and a height; NaN where none is known. */
  at(s: number, z: number): number {
    return this.column(s, [z])[0];
  }

  /** The errors at an arc length and each of some heights. */
  column(s: number, heights: ArrayLike<number>): Float64Array {
    const values = this.model.s.values;
    const i = this.model.indexAt(s);
    const j = Math.min(i + 1, values.length - 1);
    const step = values[j] - values[i];
    const along = step > 0 ? Math.min(1, Math.max(0, (s - values[i]) / step)) : 0;
    const here = this.rows.map((r) => (along === 0 ? r[i] : r[i] * (1 - along) + r[j] * along));
    const errors = new Float64Array(heights.length);
    for (let n = 0; n < heights.length; n++) {
      const [k, up] = this.level(heights[n]);
      errors[n] = up === 0 ? here[k] : here[k] * (1 - up) + here[k + 1] * up;
    }
    return errors;
  }
}

/** A round scale that holds so large an error. */
function roundScale(size: number): number {
  return size > 0 ? roundStep(size) : 0.01;
}

export class Unrolled {
  readonly element: HTMLElement;
  private readonly stage = el("div", { class: "unrolled", tabindex: "0", role: "application", "aria-describedby": "unrolled-keys" });
  private readonly canvas = el("canvas", { "aria-hidden": "true" });
  private readonly cross = el("div", { class: "cross", hidden: "" });
  private readonly told = el("p", { class: "unrolled-told", role: "status" });
  private readonly words = el("p", { class: "unrolled-words" });
  private readonly bar = el("canvas", { width: "160", height: "12", "aria-hidden": "true" });
  private readonly ends = [el("span", {}), el("span", {})];
  private readonly lines = el("span", {});
  private readonly points: ProbePoint[];
  private readonly limits: Limits | undefined;
  private readonly faces: Face[];
  private readonly depth: number;
  /** Largest error that the colours tell, mm. */
  private scale: number;
  /** How much of the length shows the second pass, 0…1. */
  private share = 0;
  private at: { s: number; z: number };
  private ratio = 1;

  /** Where the error over the height is known; otherwise there is nothing to unroll. */
  static of(report: Report, model: Model | null, store: Store, touched: string, colours: () => Palette): Unrolled | null {
    const faces = (model?.compared ?? []).map((pass) => new Face(model as Model, pass)).filter((face) => face.known);
    return model && faces.length > 0 ? new Unrolled(report, model, store, faces, touched, colours) : null;
  }

  private constructor(report: Report, private readonly model: Model, private readonly store: Store, faces: Face[], private readonly touched: string, private readonly colours: () => Palette) {
    this.faces = faces;
    this.limits = limitsOf(report);
    this.points = (report.points ?? []).filter((p) => p.s_mm !== undefined && p.z_mm !== undefined && p.error_mm !== undefined);
    this.depth = Math.max(...(report.heights?.z_mm ?? [1]));
    const largest = Math.max(...faces.map((face) => face.largest()));
    this.scale = roundScale(largest);
    this.at = { s: model.s.values[0], z: this.depth / 2 };
    const key = el("p", { class: "chart-key unrolled-key" }, el("span", {}, this.ends[0], this.bar, this.ends[1]), this.lines,
      this.points.length ? el("span", {}, "marks: touched places, in the colour of what was measured") : null);
    this.stage.append(this.canvas, this.cross);
    this.element = card("unrolled", "The wall unrolled", el("div", { class: "unrolled-bar" }, ...this.controls(largest)), this.stage, key, this.told, this.words,
      el("p", { class: "hidden", id: "unrolled-keys" }, "Arrows move over the wall, with Shift ten times as far; Home and End lead to its ends, Page Up and Page Down to its top and its tip; Enter puts the cutter there."));
    this.listen();
    this.store.onChange((changed) => { if (changed.has("place") || changed.has("height")) this.follow(); });
  }

  private controls(largest: number): HTMLElement[] {
    const scales = [...new Set([1, 2, 5, 10, 20, 50].map((part) => roundScale(largest / part)))];
    const select = el("select", { id: "colour-scale" }, ...scales.map((v) => el("option", { value: String(v) }, `± ${fixed(v, LENGTH)} mm`)));
    select.addEventListener("change", () => { this.scale = Number(select.value); this.draw(); });
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
  private faceAt(s: number): Face {
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
    this.fill(c, colours);
    this.isolines(c);
    this.axes(c, colours);
    this.touches(c);
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
        if (!Number.isNaN(errors[y])) pixels[y * wide + x] = TABLE[Math.round((Math.min(1, Math.max(-1, errors[y] / this.scale)) + 1) * HALF)];
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
  private levels(): number[] {
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
    const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    c.textBaseline = "top";
    const name = "s mm";
    const end = left + width - c.measureText(name).width;
    c.fillText(name, end, top + height + 6);
    for (let k = Math.ceil(first / step); k * step <= first + this.model.length + 1e-9; k++) {
      const x = this.px(k * step);
      const text = fixed(k * step, decimals);
      const wide = c.measureText(text).width;
      c.fillRect(x - 0.5, top + height, 1, 4);
      const at = Math.max(2, x - wide / 2);
      if (at + wide < end - 8) c.fillText(text, at, top + height + 6);
    }
    const up = roundStep(this.depth / 4);
    const places = Math.max(0, -Math.floor(Math.log10(up) + 1e-9));
    c.textAlign = "right";
    c.textBaseline = "middle";
    for (let k = 0; k * up <= this.depth * (1 + 1e-9); k++) c.fillText(fixed(k * up, places), left - 6, this.py(k * up));
    c.textAlign = "left";
    c.textBaseline = "alphabetic";
    if (this.faces.length > 1 && this.share > 0 && this.share < 1) {
      c.fillStyle = colours.ink;
      c.fillRect(left + this.share * width - 1, top - 4, 2, height + 8);
    }
  }

  private touches(c: CanvasRenderingContext2D): void {
    for (const p of this.points) {
      const s = p.s_mm as number;
      // They are of one of the passes, and stand where that is shown.
      if (p.status !== "used" || this.faceAt(s).pass.name !== this.touched) continue;
      const [r, g, b] = colourOf((p.error_mm as number) / this.scale);
      c.fillStyle = `rgb(${r}, ${g}, ${b})`;
      c.strokeStyle = "#111";
      c.lineWidth = 1.4;
      drawMark(c, standing(p, this.limits), this.px(s), this.py(p.z_mm as number), 4);
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
    this.ends[0].textContent = `too deep ${signed(-this.scale, LENGTH)}${beyond ? " and more" : ""}`;
    this.ends[1].textContent = `${signed(this.scale, LENGTH)} mm${beyond ? " and more" : ""}, left`;
    const [lower, upper] = this.levels();
    this.lines.textContent = `lines: ${this.limits ? "tolerance, " : ""}${signed(upper, LENGTH)} mm full, ${signed(lower, LENGTH)} mm dashed`;
  }

  /** What the picture shows, for who does not see it. */
  private tell(): void {
    const said = this.faces.map((face) => {
      const share = this.limits ? `, ${fixed(100 * face.within(this.limits), 0)} % of it within tolerance` : "";
      return `${this.model.passes.length > 1 ? `${face.pass.title}: ` : ""}largest error at ${face.heights} heights ${fixed(face.largest(), LENGTH)} mm${share}`;
    });
    this.words.textContent = `Height above the tip of the cutter, mm, over arc length. ${said.join("; ")}.`;
    this.stage.setAttribute("aria-label", `The wall unrolled, ${fixed(this.model.length, 1)} mm long, ${fixed(this.depth, 1)} mm high. ${said.join("; ")}.`);
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
    this.cross.style.transform = `translate(${this.px(s).toFixed(1)}px, ${this.py(z).toFixed(1)}px)`;
    const face = this.faceAt(s);
    const e = face.at(s, z);
    const name = this.model.passes.length > 1 ? `${face.pass.title} ` : "";
    this.told.textContent = `s ${fixed(s, 1)} mm, ${fixed(z, 1)} mm above the tip: ${name}${Number.isNaN(e) ? "no wall" : `${signed(e, LENGTH)} mm`}`;
  }

  private go(): void {
    this.store.set({ place: this.model.nearest(this.at.s), playing: false });
  }

  private listen(): void {
    const at = (event: PointerEvent) => {
      const { left, top } = this.stage.getBoundingClientRect();
      return this.place(event.clientX - left, event.clientY - top);
    };
    this.stage.addEventListener("pointermove", (event) => { this.at = at(event); this.point(); });
    this.stage.addEventListener("pointerleave", () => this.follow());
    this.stage.addEventListener("click", (event) => { this.at = at(event as PointerEvent); this.go(); });
    this.stage.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
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
      if (!keys[event.key]) return;
      event.preventDefault();
      keys[event.key]();
      this.at = { s: Math.min(last, Math.max(first, this.at.s)), z: Math.min(this.depth, Math.max(0, this.at.z)) };
      this.point();
    });
  }
}
