/** Colours of the drawings, read from the style sheet: Okabe and Ito, as in the program's other pictures. */

export interface Palette {
  ground: string; ink: string; quiet: string; grid: string; part: string; stock: string; cutter: string;
  before: string; after: string; within: string; left: string; gouge: string; first: string; second: string; font: string;
}

const NAMES: (keyof Palette)[] = [
  "ground", "ink", "quiet", "grid", "part", "stock", "cutter", "before", "after", "within", "left", "gouge", "first",
  "second", "font",
];

export function palette(): Palette {
  const style = getComputedStyle(document.documentElement);
  return Object.fromEntries(NAMES.map((name) => [name, style.getPropertyValue(`--${name}`).trim()])) as unknown as Palette;
}
