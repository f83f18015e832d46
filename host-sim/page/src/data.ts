/**
 * The data of a report, as the program writes them into the page.
 *
 * Lengths in millimetres, angles in degrees, forces in newtons. Material left on the wall is a positive
 * error. Every column is optional: a command sends what it has, the page shows what it gets.
 */

/** Whole numbers, little-endian 32 bit in base64; value = (offset + number) / 10^decimals. −2^31: no value. */
export interface Column {
  decimals: number;
  /** Added to every number; for coordinates beyond 32 bit. */
  offset?: number;
  data: string;
}

export interface Polyline {
  x_mm: Column;
  y_mm: Column;
}

/** One pass along the contour, one entry per sample. */
export interface PassColumns {
  /** Its name in tables and buttons: "part 2"; otherwise "before" or "after". */
  name?: string;
  /** What this pass is: "uncorrected, cut by the virtual machine", "predicted". */
  label?: string;
  error_mm?: Column;
  sigma_mm?: Column;
  arc_deg?: Column;
  chip_area_mm2?: Column;
  force_n?: Column;
  fx_n?: Column;
  fy_n?: Column;
  dx_mm?: Column;
  dy_mm?: Column;
  feed_mm_per_min?: Column;
  /** The correction it was cut with; that of `after` is the contour's. */
  correction_x_mm?: Column;
  correction_y_mm?: Column;
}

export interface ContourColumns {
  s_mm: Column;
  /** Centre of the cutter as programmed. */
  x_mm: Column;
  y_mm: Column;
  /** Unit normal from the centre into the wall; otherwise from the direction of travel and `job.wall`. */
  nx?: Column;
  ny?: Column;
  correction_x_mm?: Column;
  correction_y_mm?: Column;
  /** Without the correction, or the only pass. */
  before?: PassColumns;
  /** A part that was cut with an earlier correction and measured. */
  milled?: PassColumns;
  /** With the correction of the contour. */
  after?: PassColumns;
}

/** Wall error over the height: node after node, in each every height. */
export interface Heights {
  /** Heights above the tip of the cutter. */
  z_mm: number[];
  /** A node is every `stride`-th sample of the contour; the last node holds until the end. */
  stride: number;
  before?: Column;
  milled?: Column;
  after?: Column;
}

export interface ProbePoint {
  line?: number;
  status: "used" | "aside";
  reason?: Told;
  s_mm?: number;
  /** The touched place of the wall, compensated for the ball. */
  x_mm: number;
  y_mm: number;
  /** Height above the tip of the cutter. */
  z_mm?: number;
  /** Of a reading set aside there may be no wall to tell normal and error of. */
  nx?: number;
  ny?: number;
  error_mm?: number;
  /** Judged by the program, with the uncertainty; otherwise the page compares with the tolerance. */
  verdict?: "pass" | "fail" | "open";
}

/** A sentence of the program; in millimetres and in inches where they differ. */
export type Told = string | [string, string];

/** What a part is called, for its customer. */
export interface Part {
  name?: string;
  drawing?: string;
  serial?: string;
  material_batch?: string;
  customer?: string;
  date?: string;
}

/** A file that the report rests on. */
export interface InputFile {
  /** "program", "probe file", "job". */
  what: string;
  name: string;
  crc32: string;
}

/** Limits of the wall error: material left is positive. */
export interface GivenLimits {
  lower_mm: number;
  upper_mm: number;
  /** Expanded uncertainty (k = 2) of a deviation. */
  uncertainty_mm?: number;
  /** Who gave them, where that is worth a word. */
  from?: string;
}

/** Stretches of the contour that lie farther than `reach_mm` from every measured place. */
export interface Coverage {
  reach_mm: number;
  length_mm: number;
  stretches: Stretch[];
  face?: Face;
}

/** Of the contour, or of the height of its wall. */
export interface Stretch { from_mm: number; to_mm: number }

/** The wall unrolled, contour by height above the tip of the cutter: in each layer the stretches that no point speaks for. */
export interface Face {
  depth_mm: number;
  /** How far up and down a point speaks for. */
  reach_mm: number;
  layers: (Stretch & { stretches: Stretch[] })[];
}

export interface Parameter {
  name: string;
  value: number;
  sigma: number;
  prior?: number;
  prior_sigma?: number;
  unit: string;
  observable: boolean;
}

/** A wall in figures: largest mean over the height, largest error at any height, each with its standard deviation; the sign aside. */
export interface WallFigures {
  mean_mm?: number;
  mean_sigma_mm?: number;
  worst_mm?: number;
  worst_sigma_mm?: number;
}

/** The wall without the correction, of the measured part or of the only pass; and with the correction. */
export interface Outlook {
  now: WallFigures;
  next?: WallFigures;
  /** What machine and probe repeat to, below which no correction brings the mean: one standard deviation. */
  floor_mm?: number;
  /** Both were cut; otherwise they are predicted. */
  cut?: boolean;
}

export interface Result {
  name: string;
  value: number;
  decimals: number;
  unit: string;
  note?: Told;
}

/** A run of cutting moves of the program. */
export interface ProgramCut {
  /** "finish", "spring", "semi", "rough", "other tool". */
  role: string;
  first_line: number;
  last_line: number;
  tool?: number | null;
  z_mm?: number | null;
  length_mm: number;
  closed: boolean;
  /** Why it has its role. */
  why: Told;
  /** Shown here; given the same correction; left as it is; not the business of this command. */
  became: "shown" | "corrected" | "unchanged" | "elsewhere";
}

/** The part program; of one with several cuts, which of them the page shows and what became of the others. */
export interface Program {
  name: string;
  crc32?: string;
  /** The cut that is shown, and why that one. */
  shown?: Told;
  why?: string;
  other_features?: string[];
  cuts?: ProgramCut[];
  cuts_left_out?: number;
}

/** The contour in a line, for a page of several. */
export interface Outcome {
  /** First and last line of the program. */
  lines?: [number, number];
  /** Height of the pass, in coordinates of the program. */
  z_mm?: number;
  length_mm?: number;
  /** Largest magnitude of the wall error: without the correction or of the only pass, at the probe points, with the correction. */
  before_mm?: number;
  measured_mm?: number;
  after_mm?: number;
  /** Largest error at any height of the wall that the page is about. */
  profile_mm?: number;
  /** Standard deviation where the error with the correction is largest. */
  sigma_mm?: number;
  /** Deepest cut below the wall, positive. */
  gouge_mm?: number;
}

/** Several contours of one program: each with all that a page of its own would hold. */
export interface Several {
  version: 1;
  kind: Report["kind"];
  title: string;
  by?: string;
  contours: { name: string; page: Report }[];
}

export interface Report {
  version: 1;
  kind: "simulate" | "correct" | "learn" | "inspect";
  title: string;
  /** In which unit lengths are said until the reader chooses: of the program; without it millimetres. */
  unit?: "in";
  /** Program of this page, such as "truepath 1.0.0". */
  by?: string;
  program?: Program;
  job?: {
    wall?: "left" | "right";
    milling?: "climb" | "conventional";
    material?: string;
    tool?: { number?: number; diameter_mm: number; teeth?: number; helix_deg?: number; stickout_mm?: number };
    cut?: { axial_depth_mm?: number; feed_mm_per_min?: number; spindle_rpm?: number };
    stock?: { allowance_mm?: number };
    /** Anything else worth a line. */
    facts?: { name: string; value: Told }[];
  };
  contour?: ContourColumns;
  /** Finished wall and surface before this pass; otherwise from the contour, tool and allowance. */
  outlines?: { wall?: Polyline[]; stock?: Polyline[] };
  heights?: Heights;
  points?: ProbePoint[];
  outcome?: Outcome;
  parameters?: Parameter[];
  outlook?: Outlook;
  /** What to do next: words up to the command, and the command. */
  next?: { what: string; command: string };
  /** How the wall comes out, in a sentence. */
  told?: Told;
  results?: Result[];
  tolerance_mm?: number;
  /** In place of `tolerance_mm`, for limits that need not lie evenly. */
  limits?: GivenLimits;
  verdict?: { state: "pass" | "fail" | "open"; text: Told };
  /** What the verdict rests on and what it does not cover, in sentences. */
  statements?: Told[];
  coverage?: Coverage;
  part?: Part;
  files?: InputFile[];
  warnings?: Told[];
}
