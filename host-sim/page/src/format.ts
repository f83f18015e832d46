/**
 * Numbers as text: fixed digits, a true minus sign, the unit after a narrow space.
 *
 * The page holds millimetres; here alone they become what is said, in millimetres or in inches, as `truepath_ground::length` does it.
 */

import type { Told } from "./data";

export const NO_VALUE = "–";

export function fixed(value: number | undefined, decimals: number): string {
  if (value === undefined || !Number.isFinite(value)) return NO_VALUE;
  const text = value.toFixed(decimals);
  const magnitude = text.startsWith("-") ? text.slice(1) : text;
  return text.startsWith("-") && Number(magnitude) !== 0 ? `−${magnitude}` : magnitude;
}

/** With its sign, for deviations. */
export function signed(value: number | undefined, decimals: number): string {
  const text = fixed(value, decimals);
  return text === NO_VALUE || text.startsWith("−") || Number(text) === 0 ? text : `+${text}`;
}

/** Decimals of a length in millimetres: micrometres. */
export const LENGTH = 3;

/** What is said of a unit in inches: its name, how many of it that is, and how many decimals more it takes to say it as finely. */
const INCHES: Record<string, [string, number, number]> = { mm: ["in", 25.4, 2], "mm²": ["in²", 645.16, 3], "mm/min": ["in/min", 25.4, 1] };
let inch = false;

export function sayInches(inches: boolean): void { inch = inches; }
export function saysInches(): boolean { return inch; }

/** A sentence of the program, in the unit in which lengths are said. */
export function say(told: Told): string {
  return typeof told === "string" ? told : told[Number(inch)];
}

/** What is said in place of a unit of the data. */
function spoken(unit: string): [string, number, number] {
  return (inch && INCHES[unit]) || [unit.replace("um", "µm"), 1, 0];
}

/** How many of a unit of the data are one of what is said. */
export function per(unit = "mm"): number { return spoken(unit)[1]; }
export function unitOf(unit = "mm"): string { return spoken(unit)[0]; }
/** Decimals of an error: micrometres, or hundredths of a thousandth. */
export function fine(decimals = LENGTH, unit = "mm"): number { return decimals + spoken(unit)[2]; }

export function withUnit(text: string, unit = "mm"): string {
  const name = unitOf(unit);
  return name === "°" ? text + name : name === "" || name === "1" ? text : `${text} ${name}`;
}

/** An error in mm, or another quantity, without its unit; `decimals` are those of what is said. */
export function sayError(value: number | undefined, decimals = fine(), unit = "mm"): string {
  return fixed(value && value / per(unit), decimals);
}

/** The same with its sign. */
export function sayDeviation(mm: number | undefined, decimals = fine()): string {
  return signed(mm && mm / per(), decimals);
}

/** A length without its unit; `decimals` are those of millimetres: inches have one more, a thousandth at least. */
export function sayLength(mm: number | undefined, decimals = LENGTH): string {
  return sayError(mm, inch ? Math.max(decimals + 1, 3) : decimals);
}

/** A length or a feed as it was given, with its unit. */
export function sayAsGiven(value: number, unit = "mm"): string {
  return withUnit(String(inch ? Number((value / per(unit)).toFixed(7)) : value), unit);
}

/** Decimals that a round step, in mm, is read with. */
export function stepDecimals(step: number): number {
  return Math.max(0, -Math.floor(Math.log10(step / per()) + 1e-9));
}

/** A standard deviation in mm or another unit, never nought where it is not. */
export function sigmaText(value: number | undefined, decimals = fine(), unit = "mm"): string {
  const text = sayError(value, decimals, unit);
  return value !== undefined && value > 0 && Number(text) === 0 ? `< ${fixed(10 ** -decimals, decimals)}` : text;
}

/** Decimals that a quantity of the contour is read with: a micrometre, a tenth of a degree, of a newton, of a millimetre a minute. */
export function decimalsOf(unit: string, given: number): number {
  return fine(Math.min(given, /^mm²?$/.test(unit) ? LENGTH : 1), unit);
}

/** As many decimals as a standard deviation deserves: two figures of it, a micrometre at most. */
export function decimalsFor(sigma: number, unit: string): number {
  const most = fine(LENGTH, unit);
  return sigma > 0 ? Math.min(most, Math.max(0, 1 - Math.floor(Math.log10(sigma / per(unit))))) : most;
}
