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

export function withUnit(text: string, unit: string): string {
  if (unit === "°") return text + unit;
  return unit === "" || unit === "1" ? text : `${text} ${unit.replace("um", "µm")}`;
}

/** As many decimals as the standard deviation deserves: two figures of it. */
export function decimalsFor(sigma: number): number {
  if (!(sigma > 0)) return 4;
  return Math.min(6, Math.max(0, 1 - Math.floor(Math.log10(sigma))));
}
