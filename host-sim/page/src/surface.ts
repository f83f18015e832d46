/** Errors of a pass over the face of its wall: samples and heights may lie unevenly; between them the error is linear in both. */

import type { Limits } from "./limits";
import type { Model, Pass } from "./model";

/** Errors of a pass over the face of its wall. */
export class Surface {
  /** Heights in rising order, mm, and the errors at each of them, a value for every sample. */
  readonly z: number[];
  readonly rows: Float64Array[];

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
