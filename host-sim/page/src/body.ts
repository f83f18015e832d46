/**
 * The wall as a body: its face with the errors on it, enlarged along the normal; the part behind it, the floor before it, lines of
 * the wall as it should be, touches, the cutter. Places are relative to the middle of the wall, Z up.
 */

import { between } from "./cutter";
import type { ProbePoint } from "./data";
import { standing, type Limits, type Standing } from "./limits";
import type { Model } from "./model";
import type { Surface } from "./surface";
import type { Trimmed } from "./trim";

/** Columns of the face at most: more than a screen has pixels. */
const COLUMNS = 4000;
/** A wall lower than this share of its extent is drawn higher, by one of these factors. */
const LOW = 1 / 9;
const RISES = [1, 2, 5, 10, 20, 50, 100];
/** How far the cutter is drawn above the wall, as a share of its radius. */
const ABOVE = 0.6;
/** Sides of the cutter. */
const SIDES = 96;

export interface Faces { places: Float32Array; indices: Uint32Array }
/** Beside every corner of the face: error, arc length, height, mm; and the direction into the wall. */
export interface Face extends Faces { told: Float32Array; into: Float32Array }
export interface Marks { places: Float32Array; errors: Float32Array; standings: Standing[] }
export interface Body {
  face: Face; land: Faces; floor: Faces;
  /** Pieces from a place to another: the wall as it should be; edges of the wall as it is; strokes to the marks. */
  nominal: Float32Array; edges: Float32Array; strokes: Float32Array;
  marks: Marks;
}

/** Everything of a wall that does not change while it is looked at. */
export class Frame {
  /** Samples that have a place of their own on the wall. */
  private readonly columns: number[];
  private readonly middle: [number, number];
  private readonly bottom: number;
  private readonly top: number;
  /** How many times as high as it is the wall is drawn. */
  readonly rise: number;
  /** Largest error that the colours tell, mm. */
  private full = Infinity;
  /** Half of the largest extent, mm. */
  readonly size: number;

  constructor(private readonly model: Model, private readonly wall: Trimmed, surfaces: Surface[]) {
    const every = Math.max(1, Math.ceil(model.count / COLUMNS));
    const last = model.count - 1;
    this.columns = Array.from({ length: model.count }, (_, i) => i).filter((i) => !wall.gone[i] && (i % every === 0 || i === last));
    const of = (line: Float64Array) => this.columns.reduce(([least, most], i) => [Math.min(least, line[i]), Math.max(most, line[i])], [Infinity, -Infinity]);
    const [[x0, x1], [y0, y1]] = [of(wall.x), of(wall.y)];
    this.middle = [(x0 + x1) / 2, (y0 + y1) / 2];
    [this.bottom, this.top] = [Math.min(...surfaces.map(({ z }) => z[0])), Math.max(...surfaces.map(({ z }) => z[z.length - 1]))];
    const [wide, high] = [Math.hypot(x1 - x0, y1 - y0), this.top - this.bottom];
    this.rise = RISES.find((factor) => factor * high >= LOW * wide) ?? RISES[RISES.length - 1];
    this.size = (wide + this.rise * high) / 2 + 2 * model.radius;
  }

  /** A place of the part. */
  place(x: number, y: number, z: number): [number, number, number] {
    return [x - this.middle[0], y - this.middle[1], (z - (this.bottom + this.top) / 2) * this.rise];
  }

  /** Where the wall stands at a sample and a height, with an error drawn so many times as large; of one beyond the colours as much as they tell. */
  onWall(i: number, z: number, error: number, factor: number): [number, number, number] {
    const away = Number.isNaN(error) ? 0 : factor * Math.min(this.full, Math.max(-this.full, error));
    return this.place(this.wall.x[i] - away * this.model.nx[i], this.wall.y[i] - away * this.model.ny[i], z);
  }

  /** Corners that hold the wall, and the middle of the cutter above it. */
  corners(): Float32Array {
    const { x, y, radius } = this.model;
    return Float32Array.from(this.columns.flatMap((i) => {
      const [px, py, pz] = this.place(x.values[i], y.values[i], this.top);
      return [...this.onWall(i, this.bottom, 0, 0), ...this.onWall(i, this.top, 0, 0), px, py, pz + ABOVE * radius];
    }));
  }

  /** From where the place with the largest error is seen a little aslant, degrees. */
  facing(surface: Surface): number {
    let [worst, most] = [0, -1];
    for (const i of this.columns) for (const row of surface.rows) if (Math.abs(row[i]) > most) [worst, most] = [i, Math.abs(row[i])];
    return this.azimuth(worst) + 35;
  }

  /** From where a sample of the wall is seen straight on, degrees. */
  azimuth(i: number): number {
    return (Math.atan2(-this.model.ny[i], -this.model.nx[i]) * 180) / Math.PI;
  }

  build(factor: number, full: number, surfaceAt: (s: number) => Surface, points: ProbePoint[], limits: Limits | undefined): Body {
    const { model, columns, wall } = this;
    this.full = full;
    const shown = columns.map((i) => surfaceAt(model.s.values[i]));
    const thick = Math.max(model.radius * 0.35, 1);
    const edge = (j: number, row: number) => shown[j].rows[row < 0 ? shown[j].z.length - 1 : row][columns[j]];
    const high = (j: number) => shown[j].z[shown[j].z.length - 1];
    // Behind what is cut too deep the part begins farther in.
    const outer = (i: number, z: number, error: number) => {
      const away = thick + factor * Math.min(full, Math.max(0, -error || 0));
      return this.place(wall.x[i] + away * model.nx[i], wall.y[i] + away * model.ny[i], z);
    };
    const joined = (j: number) => shown[j] === shown[j + 1];
    const nominal: number[] = [];
    const edges: number[] = [];
    for (let j = 0; j + 1 < columns.length; j++) {
      const [a, b] = [columns[j], columns[j + 1]];
      for (const z of [this.bottom, this.top]) nominal.push(...this.onWall(a, z, 0, 0), ...this.onWall(b, z, 0, 0));
      for (const row of [0, -1]) {
        const [e, f] = [edge(j, row), edge(j + 1, row)];
        const [y, z] = row < 0 ? [high(j), high(j + 1)] : [shown[j].z[0], shown[j + 1].z[0]];
        if (joined(j) && !Number.isNaN(e + f)) edges.push(...this.onWall(a, y, e, factor), ...this.onWall(b, z, f, factor));
      }
    }
    const ends = model.closed ? [] : [columns[0], columns[columns.length - 1]];
    for (const i of ends) nominal.push(...this.onWall(i, this.bottom, 0, 0), ...this.onWall(i, this.top, 0, 0));
    return {
      face: this.face(factor, shown),
      land: ribbon(columns.map((i, j) => [this.onWall(i, high(j), edge(j, -1), factor), outer(i, high(j), edge(j, -1))])),
      floor: ribbon(columns.map((i, j) => [this.onWall(i, this.bottom, edge(j, 0), factor), this.place(model.x.values[i], model.y.values[i], this.bottom)])),
      nominal: Float32Array.from(nominal), edges: Float32Array.from(edges), ...this.marks(factor, points, limits),
    };
  }

  private face(factor: number, shown: Surface[]): Face {
    const { model, columns } = this;
    const [places, told, into, indices]: number[][] = [[], [], [], []];
    let first = 0;
    columns.forEach((i, j) => {
      const { z, rows } = shown[j];
      z.forEach((height, k) => {
        places.push(...this.onWall(i, height, rows[k][i], factor));
        told.push(rows[k][i], model.s.values[i], height);
        into.push(model.nx[i], model.ny[i]);
      });
      const next = first + z.length;
      for (let k = 0; j + 1 < columns.length && shown[j + 1] === shown[j] && k + 1 < z.length; k++) {
        const corners = [rows[k][i], rows[k + 1][i], rows[k][columns[j + 1]], rows[k + 1][columns[j + 1]]];
        if (corners.every((e) => !Number.isNaN(e))) indices.push(first + k, next + k, next + k + 1, first + k, next + k + 1, first + k + 1);
      }
      first = next;
    });
    return { places: Float32Array.from(places), told: Float32Array.from(told), into: Float32Array.from(into), indices: Uint32Array.from(indices) };
  }

  private marks(factor: number, points: ProbePoint[], limits: Limits | undefined): { marks: Marks; strokes: Float32Array } {
    const { model } = this;
    const [places, strokes, errors]: number[][] = [[], [], []];
    for (const p of points) {
      const i = model.nearest(p.s_mm as number);
      const { nx = model.nx[i], ny = model.ny[i], error_mm: error = 0, z_mm: z = 0 } = p;
      const at = (times: number) => this.place(p.x_mm + (1 - times) * error * nx, p.y_mm + (1 - times) * error * ny, z);
      places.push(...at(factor));
      strokes.push(...at(0), ...at(factor));
      errors.push(error);
    }
    return { marks: { places: Float32Array.from(places), errors: Float32Array.from(errors), standings: points.map((p) => standing(p, limits)) }, strokes: Float32Array.from(strokes) };
  }

  /** Where the tip of the cutter is at a place of the contour: on the enlarged path, as in the plan view. */
  tip(place: number, factor: number, across: Float64Array | undefined): [number, number, number] {
    const { model } = this;
    const away = across ? factor * between(across, place) : 0;
    const [x, y] = [[model.x.values, model.nx], [model.y.values, model.ny]].map(([at, n]) => between(at, place) + away * between(n, place));
    return this.place(x, y, this.bottom);
  }

  /** The cutter about its tip: shell and, as pieces, its rims and edges. */
  cutter(teeth: number, helix: number): Faces & { normals: Float32Array; lines: Float32Array } {
    const { radius } = this.model;
    const high = (this.top - this.bottom) * this.rise + ABOVE * radius;
    const at = (turn: number, z: number): [number, number, number] => [radius * Math.cos(turn), radius * Math.sin(turn), z];
    const [places, normals, indices, lines]: number[][] = [[], [], [], []];
    const round = (k: number) => (2 * Math.PI * k) / SIDES;
    for (let k = 0; k < SIDES; k++) {
      for (const z of [0, high]) {
        places.push(...at(round(k), z));
        normals.push(Math.cos(round(k)), Math.sin(round(k)), 0);
        lines.push(...at(round(k), z), ...at(round(k + 1), z));
      }
      const [a, b] = [2 * k, 2 * ((k + 1) % SIDES)];
      indices.push(a, b, b + 1, a, b + 1, a + 1);
    }
    for (const z of [0, high]) {
      const centre = places.length / 3;
      places.push(0, 0, z);
      normals.push(0, 0, 1);
      for (let k = 0; k < SIDES; k++) {
        places.push(...at(round(k), z));
        normals.push(0, 0, 1);
        indices.push(centre, centre + 1 + k, centre + 1 + ((k + 1) % SIDES));
      }
    }
    const twist = Math.tan((helix * Math.PI) / 180) / Math.max(radius * this.rise, 1e-9);
    const steps = 24;
    for (let tooth = 0; tooth < teeth; tooth++) {
      const turn = (k: number) => (2 * Math.PI * tooth) / teeth + twist * ((high * k) / steps);
      for (let k = 0; k < steps; k++) lines.push(...at(turn(k), (high * k) / steps), ...at(turn(k + 1), (high * (k + 1)) / steps));
      lines.push(0, 0, 0, ...at(turn(0), 0));
    }
    return { places: Float32Array.from(places), normals: Float32Array.from(normals), indices: Uint32Array.from(indices), lines: Float32Array.from(lines) };
  }
}

/** Faces between two rows of places. */
function ribbon(pairs: number[][][]): Faces {
  const indices = pairs.slice(1).flatMap((_, j) => [2 * j, 2 * j + 1, 2 * j + 3, 2 * j, 2 * j + 3, 2 * j + 2]);
  return { places: Float32Array.from(pairs.flat(2)), indices: Uint32Array.from(indices) };
}
