/** The contours of a page of several: their names, where they lie, how they came out, and which is the worst. */

import { checked, drawn } from "./contour";
import { fine } from "./format";
import type { Outcome, Report, Several } from "./data";
import { decimalsTelling, limitsOf } from "./limits";
import { Path } from "./model";
import { offsetOf, outline, type Line } from "./outline";
import { trimmed } from "./trim";

/** A contour of the page. */
export interface Entry {
  /** Place in the order of the program, from 0. */
  index: number;
  name: string;
  report: Report;
  outcome: Outcome;
  /** Its nominal wall, and the path of the cutter's centre. */
  wall: Line[];
  path: Line[];
  /** Whether the wall ends where it starts. */
  closed: boolean;
}

type Size = "before_mm" | "measured_mm" | "after_mm" | "profile_mm" | "sigma_mm" | "gouge_mm";

/** A figure of every contour: head of its column, name among the head figures. */
export interface Figure { key: Size; head: string; name: string }

const FIGURES: Record<Report["kind"], Figure[]> = {
  simulate: [{ key: "before_mm", head: "largest error", name: "largest wall error" }],
  correct: [
    { key: "before_mm", head: "before", name: "largest error without correction" },
    { key: "after_mm", head: "after", name: "largest error with it" },
  ],
  learn: [
    { key: "before_mm", head: "uncorrected", name: "uncorrected, largest error" },
    { key: "measured_mm", head: "measured", name: "measured part, largest error" },
    { key: "after_mm", head: "next", name: "next part, largest error" },
  ],
  inspect: [{ key: "measured_mm", head: "measured", name: "largest deviation" }],
};
const OTHERS: Figure[] = [
  { key: "profile_mm", head: "any height", name: "worst at any height" },
  { key: "sigma_mm", head: "σ", name: "standard deviation there" },
  { key: "gouge_mm", head: "deepest cut", name: "deepest cut" },
];

/** The figures that some contour has; where the error at any height is known, the deepest cut is part of it. */
export function figuresOf({ kind }: Several, entries: Entry[]): Figure[] {
  const has = (key: Size) => entries.some(({ outcome }) => outcome[key] !== undefined);
  return [...FIGURES[kind], ...OTHERS].filter(({ key }) => has(key) && !(key === "gouge_mm" && has("profile_mm")));
}

/** The figure that contours are ranked by until the reader chooses another: the worst at any height of what the page is about, or its largest error. */
export function ranking({ kind }: Several, entries: Entry[]): Figure {
  const any = OTHERS[0];
  return kind !== "inspect" && entries.some(({ outcome }) => outcome[any.key] !== undefined) ? any : FIGURES[kind][FIGURES[kind].length - 1];
}

export function entriesOf(several: Several): Entry[] {
  const taken = new Set<string>();
  return several.contours.map(({ name: given, page }, index) => {
    let name = given;
    for (let k = 2; taken.has(name); k++) name = `${given} (${k})`;
    taken.add(name);
    return { index, name, outcome: page.outcome ?? {}, ...read(page) };
  });
}

/** A contour that cannot be read is not drawn here; where it is shown it is said why. */
function read(page: Report): Pick<Entry, "report" | "wall" | "path" | "closed"> {
  try {
    const report = checked(page);
    return { report, ...lines(report) };
  } catch {
    return { report: page, wall: [], path: [], closed: false };
  }
}

/** Worst first, those of which nothing is known last. */
export function worstFirst(entries: Entry[], { key }: Figure): Entry[] {
  const size = ({ outcome }: Entry) => outcome[key] ?? -1;
  return [...entries].sort((a, b) => size(b) - size(a) || a.index - b.index);
}

/** Decimals that tell every deviation from the limits it is held against. */
export function decimalsOf(entries: Entry[]): number {
  return Math.max(fine(), ...entries.filter(({ report }) => report.kind === "inspect").map(({ report }) => decimalsTelling(report.points ?? [], limitsOf(report))));
}

function lines(report: Report): Pick<Entry, "wall" | "path" | "closed"> {
  const given = outline(report.outlines?.wall, "wall") ?? [];
  if (!report.contour || !drawn(report)) return { wall: given, path: [], closed: false };
  const path = new Path(report, report.contour);
  const [x, y] = [path.x.values, path.y.values];
  const wall = trimmed(path, offsetOf(path, path.radius), path.radius);
  return { wall: [wall], path: [{ x, y }], closed: path.closed };
}
