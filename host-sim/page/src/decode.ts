/** Columns from their compact form, and the data element of the page. */

import type { Column, Report, Several } from "./data";

/** Values with the number of decimals with which they were written. */
export interface Series {
  values: Float64Array;
  decimals: number;
}

const NONE = -2147483648;

/** Throws an error that names the column when it does not hold `length` numbers. */
export function decode(column: Column, name: string, length?: number): Series {
  const { decimals, offset = 0, data } = column;
  if (!Number.isInteger(decimals) || decimals < 0 || decimals > 12) throw new Error(`${name}: decimals must be 0 to 12`);
  const text = atob(data);
  if (text.length % 4 !== 0) throw new Error(`${name}: not a whole number of 32-bit values`);
  const count = text.length / 4;
  if (length !== undefined && count !== length) throw new Error(`${name}: ${count} values, expected ${length}`);
  const bytes = new DataView(new ArrayBuffer(text.length));
  for (let i = 0; i < text.length; i++) bytes.setUint8(i, text.charCodeAt(i));
  const unit = 10 ** decimals;
  const values = new Float64Array(count);
  for (let i = 0; i < count; i++) {
    const bits = bytes.getInt32(4 * i, true);
    values[i] = bits === NONE ? NaN : (offset + bits) / unit;
  }
  return { values, decimals };
}

/** The report in the page, of one contour or of several; an error in plain words when there is none. */
export function readReport(element: Element | null): Report | Several {
  const report = JSON.parse(element?.textContent ?? "null") as Report | Several | null;
  if (report === null) throw new Error("This page holds no data yet. Truepath writes them when it makes a report.");
  if ("contours" in report && report.contours.length === 0) throw new Error("This page holds no contour.");
  for (const of of "contours" in report ? [report, ...report.contours.map(({ page }) => page)] : [report]) {
    if (of.version !== 1) throw new Error(`Data of version ${String(of.version)}; this page reads version 1.`);
  }
  return report;
}
