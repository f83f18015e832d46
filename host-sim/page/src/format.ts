/** Numbers as text: fixed digits, a true minus sign, the unit after a narrow space. */

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

/** A standard deviation, never nought where it is not. */
export function sigmaText(value: number | undefined, decimals = LENGTH): string {
  const text = fixed(value, decimals);
  return value !== undefined && value > 0 && Number(text) === 0 ? `< ${fixed(10 ** -decimals, decimals)}` : text;
}

export function withUnit(text: string, unit: string): string {
  if (unit === "°") return text + unit;
  return unit === "" || unit === "1" ? text : `${text} ${unit.replace("um", "µm")}`;
}

/** Decimals that a quantity of the contour is read with: a micrometre, a tenth of a degree, of a newton, of a millimetre a minute. */
export function decimalsOf(quantity: string, given: number): number {
  const most = quantity.endsWith("_mm") || quantity.endsWith("_mm2") ? LENGTH : 1;
  return Math.min(given, most);
}

/** As many decimals as the standard deviation deserves: two figures of it, a micrometre at most. */
export function decimalsFor(sigma: number): number {
  if (!(sigma > 0)) return LENGTH;
  return Math.min(LENGTH, Math.max(0, 1 - Math.floor(Math.log10(sigma))));
}
