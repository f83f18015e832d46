/**
 * The contour as arrays: what the scene and the traces draw.
 *
 * Normals point from the centre of the cutter into the wall. Deviations are those of the centre from the
 * programmed path, so that wall error = −(deviation · normal) where the model is exact.
 */

import type { ContourColumns, PassColumns, Report } from "./data";
import { decode, type Series } from "./decode";

/** Passes in the order in which they are cut. */
const NAMES = ["before", "milled", "after"] as const;
export type PassName = (typeof NAMES)[number];

/** A correction along the contour, and its part towards the wall. */
export interface Correction { x: Series; y: Series; across: Float64Array }

export type Quantity =
  | "error_mm" | "sigma_mm" | "arc_deg" | "chip_area_mm2" | "force_n" | "fx_n" | "fy_n" | "dx_mm" | "dy_mm"
  | "feed_mm_per_min";

const QUANTITIES: Quantity[] = [
  "error_mm", "sigma_mm", "arc_deg", "chip_area_mm2", "force_n", "fx_n", "fy_n", "dx_mm", "dy_mm", "feed_mm_per_min",
];

export class Pass {
  readonly series: Partial<Record<Quantity, Series>> = {};
  /** What it is called in tables and buttons, and at length. */
  readonly title: string;
  readonly label: string;
  /** Deviation of the centre from the programmed path, towards the wall; absent without deflections. */
  readonly across?: Float64Array;

  constructor(readonly name: PassName, columns: PassColumns, normals: Normals, readonly correction?: Correction) {
    const { length } = normals[0];
    this.title = columns.name ?? name;
    this.label = columns.label ?? (columns.name ? "" : `${name} the correction`);
    for (const quantity of QUANTITIES) {
      const column = columns[quantity];
      if (column) this.series[quantity] = decode(column, `${name}.${quantity}`, length);
    }
    const { dx_mm: dx, dy_mm: dy } = this.series;
    if (dx && dy) {
      const deflection = across(dx, dy, normals);
      this.across = correction ? deflection.map((v, i) => v + correction.across[i]) : deflection;
    }
  }
}

/** How near to its start a path ends that is closed: mm, or as a share of the radius of the cutter. */
const CLOSED = 0.01;

type Normals = [Float64Array, Float64Array];

/** The part of a vector towards the wall. What lies along the path moves no wall. */
function across(x: Series, y: Series, [nx, ny]: Normals): Float64Array {
  return x.values.map((v, i) => v * nx[i] + y.values[i] * ny[i]);
}

/** The path alone: what walls beside it are drawn from. */
export class Path {
  readonly count: number;
  readonly s: Series;
  readonly x: Series;
  readonly y: Series;
  readonly nx: Float64Array;
  readonly ny: Float64Array;
  readonly radius: number;
  /** +1: the wall is right of the direction of travel; then the engaged arc lies counter-clockwise of the normal. */
  readonly turn: number;

  /** Of a contour of two samples or more. */
  constructor(readonly report: Report, columns: ContourColumns) {
    this.s = decode(columns.s_mm, "s_mm");
    const count = this.s.values.length;
    this.count = count;
    this.x = decode(columns.x_mm, "x_mm", count);
    this.y = decode(columns.y_mm, "y_mm", count);
    this.radius = (report.job?.tool?.diameter_mm ?? 0) / 2;
    this.turn = report.job?.wall === "left" ? -1 : 1;
    if (columns.nx && columns.ny) {
      this.nx = decode(columns.nx, "nx", count).values;
      this.ny = decode(columns.ny, "ny", count).values;
    } else {
      [this.nx, this.ny] = this.normals();
    }
  }

  /** Whether the path ends where it starts. */
  get closed(): boolean {
    const last = this.count - 1;
    const [x, y] = [this.x.values, this.y.values];
    return Math.hypot(x[last] - x[0], y[last] - y[0]) < Math.max(CLOSED, this.radius * CLOSED);
  }

  get length(): number {
    return this.s.values[this.count - 1] - this.s.values[0];
  }

  /** The sample at or before an arc length. */
  indexAt(s: number): number {
    const values = this.s.values;
    let low = 0;
    let high = this.count - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (values[middle] <= s) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  /** The sample nearest to an arc length. */
  nearest(s: number): number {
    const i = this.indexAt(s);
    const next = Math.min(i + 1, this.count - 1);
    return Math.abs(this.s.values[next] - s) < Math.abs(this.s.values[i] - s) ? next : i;
  }

  private normals(): [Float64Array, Float64Array] {
    const nx = new Float64Array(this.count);
    const ny = new Float64Array(this.count);
    const { values: x } = this.x;
    const { values: y } = this.y;
    for (let i = 0; i < this.count; i++) {
      let a = Math.max(0, i - 1);
      let b = Math.min(this.count - 1, i + 1);
      // Several samples may stand on one spot.
      while (x[a] === x[b] && y[a] === y[b] && (a > 0 || b < this.count - 1)) [a, b] = [Math.max(0, a - 1), Math.min(this.count - 1, b + 1)];
      const tx = x[b] - x[a];
      const ty = y[b] - y[a];
      const size = Math.hypot(tx, ty) || 1;
      nx[i] = (this.turn * ty) / size;
      ny[i] = (-this.turn * tx) / size;
    }
    return [nx, ny];
  }
}

export class Model extends Path {
  /** The correction that the report is about. */
  readonly correction?: Correction;
  /** The passes there are, in the order in which they are cut. */
  readonly passes: Pass[] = [];
  /** Those that stand side by side: the last two. */
  readonly compared: Pass[];
  /** Seconds from the start of the contour, at the feed of the pass, else of the job, else 20 s in all. */
  readonly time: Float64Array;
  /** Indices of samples, coarser from level to level; each keeps the largest error of its block of four. */
  readonly levels: Uint32Array[];
  private readonly heightErrors: Partial<Record<PassName, Float64Array[]>> = {};

  /** Of a contour of two samples or more. */
  constructor(report: Report, columns: ContourColumns) {
    super(report, columns);
    const { count } = this;
    const normals: Normals = [this.nx, this.ny];
    const correction = (of: ContourColumns | PassColumns): Correction | undefined => {
      const { correction_x_mm: cx, correction_y_mm: cy } = of;
      if (!cx || !cy) return undefined;
      const [x, y] = [decode(cx, "correction_x_mm", count), decode(cy, "correction_y_mm", count)];
      return { x, y, across: across(x, y, normals) };
    };
    this.correction = correction(columns);
    for (const name of NAMES) {
      const pass = columns[name];
      if (pass) this.passes.push(new Pass(name, pass, normals, name === "after" ? this.correction : correction(pass)));
    }
    this.compared = this.passes.slice(-2);
    this.time = this.times();
    this.levels = this.coarser();
    this.readHeights();
  }

  pass(name: PassName): Pass | undefined {
    return this.passes.find((pass) => pass.name === name);
  }

  /** "what before", "what after", "what, part 2"; of a pass that stands alone "what". */
  of(what: string, pass: Pass): string {
    if (this.passes.length < 2) return what;
    return pass.title === pass.name ? `${what} ${pass.title}` : `${what}, ${pass.title}`;
  }

  /** A pass in full: its name, where there are others, and what it is. */
  called(pass: Pass): string {
    return [this.passes.length > 1 ? pass.title : "", pass.label].filter(Boolean).join(": ");
  }

  /** Its colour: of three passes the one without any correction is in the background. */
  colour(pass: Pass): "quiet" | "before" | "after" {
    if (pass.name === "after") return "after";
    return this.compared.length < 2 || this.compared.includes(pass) ? "before" : "quiet";
  }

  /** Error of a pass: the mean over the height, or at one height. */
  error(name: PassName, height: number | null): Float64Array | undefined {
    const pass = this.pass(name);
    if (height === null) return pass?.series.error_mm?.values;
    return this.heightErrors[name]?.[height];
  }

  private times(): Float64Array {
    const feeds = this.passes.at(-1)?.series.feed_mm_per_min?.values;
    const overall = this.report.job?.cut?.feed_mm_per_min ?? (this.length / 20) * 60;
    const time = new Float64Array(this.count);
    for (let i = 1; i < this.count; i++) {
      const feed = feeds && feeds[i] > 0 ? feeds[i] : overall;
      time[i] = time[i - 1] + ((this.s.values[i] - this.s.values[i - 1]) / feed) * 60;
    }
    return time;
  }

  private coarser(): Uint32Array[] {
    const errors = this.passes.map((pass) => pass.series.error_mm?.values);
    const size = (i: number) => Math.max(...errors.map((e) => (e && Number.isFinite(e[i]) ? Math.abs(e[i]) : 0)));
    const sizes = Float64Array.from({ length: this.count }, (_, i) => size(i));
    const levels = [Uint32Array.from({ length: this.count }, (_, i) => i)];
    while (levels[levels.length - 1].length > 512) {
      const fine = levels[levels.length - 1];
      const picked = [0];
      for (let start = 1; start < fine.length - 1; start += 4) {
        let best = start;
        for (let k = start + 1; k < Math.min(start + 4, fine.length - 1); k++) if (sizes[fine[k]] > sizes[fine[best]]) best = k;
        picked.push(fine[best]);
      }
      picked.push(fine[fine.length - 1]);
      levels.push(Uint32Array.from(picked));
    }
    return levels;
  }

  private readHeights(): void {
    const heights = this.report.heights;
    if (!heights || heights.z_mm.length === 0 || !(heights.stride >= 1)) return;
    const rows = heights.z_mm.length;
    for (const name of NAMES) {
      const column = heights[name];
      if (!column) continue;
      const { values } = decode(column, `heights.${name}`);
      const nodes = Math.floor(values.length / rows);
      this.heightErrors[name] = heights.z_mm.map((_, row) => {
        const error = new Float64Array(this.count);
        for (let i = 0; i < this.count; i++) {
          const place = Math.min(i / heights.stride, nodes - 1);
          const node = Math.floor(place);
          const next = Math.min(node + 1, nodes - 1);
          error[i] = values[node * rows + row] * (1 - place + node) + values[next * rows + row] * (place - node);
        }
        return error;
      });
    }
  }
}
