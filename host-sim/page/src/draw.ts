/** The still layer of a scene: grid, part, stock, paths, error band, probe points. */

import type { ProbePoint } from "./data";
import { sayDeviation } from "./format";
import { decimalsTelling, standing, type Limits } from "./limits";
import { drawMark, fillOf } from "./marks";
import type { Model, Pass } from "./model";
import type { Line } from "./outline";
import type { Palette } from "./palette";
import { errorScale, gridLines, gridNumbers } from "./rulers";
import type { Trimmed } from "./trim";
import type { View } from "./view";

export interface Picture {
  model: Model | null;
  pass: Pass | null;
  error: Float64Array | undefined;
  wall: Trimmed | null;
  stock: Line | null;
  outlines: { wall: Line[]; stock: Line[] };
  points: ProbePoint[];
  magnify: number;
  limits: Limits | undefined;
  hidden: Set<string>;
  picked: number | null;
}

type Context = CanvasRenderingContext2D;
const MARGIN = 60;

export function drawStill(c: Context, view: View, picture: Picture, colours: Palette): void {
  gridLines(c, view, colours);
  const { model } = picture;
  c.lineJoin = "round";
  if (model && picture.wall) {
    const indices = levelFor(model, view);
    const wall = picture.wall;
    const depth = Math.max(model.radius * 0.35, 1);
    const beyond = shifted(wall, model, depth);
    strip(c, view, indices, wall, beyond, colours.part);
    if (!picture.hidden.has("stock") && picture.stock) {
      path(c, view, indices, picture.stock, colours.quiet, 1, [5, 4]);
    }
    if (!picture.hidden.has("band") && picture.error) band(c, view, indices, model, wall, picture, colours);
    path(c, view, indices, wall, colours.ink, 1.75);
    if (!picture.hidden.has("nominal")) path(c, view, indices, { x: model.x.values, y: model.y.values }, colours.quiet, 1, [8, 3, 2, 3]);
    const correction = picture.pass?.correction;
    if (!picture.hidden.has("commanded") && correction) {
      path(c, view, indices, moved(model, correction.across, picture.magnify), colours.second, 1.5, [4, 3]);
    }
    const across = picture.pass?.across;
    if (!picture.hidden.has("actual") && across && picture.pass) {
      path(c, view, indices, moved(model, across, picture.magnify), colours[model.colour(picture.pass)], 1.5);
    }
  }
  for (const line of picture.outlines.stock) path(c, view, allOf(line), line, colours.quiet, 1, [5, 4]);
  for (const line of picture.outlines.wall) path(c, view, allOf(line), line, colours.ink, 1.75);
  gridNumbers(c, view, colours);
  if (!picture.hidden.has("points")) points(c, view, picture, colours);
  if (picture.error || picture.pass?.across || picture.points.length) errorScale(c, view, picture.magnify, colours);
}

/** The coarsest level whose samples lie no more than a pixel apart. */
export function levelFor(model: Model, view: View): Uint32Array {
  let level = 0;
  const spacing = (view.scale * model.length) / model.count;
  while (level + 1 < model.levels.length && spacing * 4 ** (level + 1) <= 1) level++;
  return model.levels[level];
}

function allOf(line: Line): Uint32Array {
  return Uint32Array.from({ length: line.x.length }, (_, i) => i);
}

function shifted(line: Line, model: Model, distance: number): Line {
  return { x: line.x.map((v, i) => v + distance * model.nx[i]), y: line.y.map((v, i) => v + distance * model.ny[i]) };
}

/** The path moved towards the wall. */
function moved(model: Model, across: Float64Array, factor: number): Line {
  const by = (path: Float64Array, normal: Float64Array) => path.map((v, i) => v + factor * across[i] * normal[i]);
  return { x: by(model.x.values, model.nx), y: by(model.y.values, model.ny) };
}

function near(view: View, px: number, py: number): boolean {
  return px > -MARGIN && py > -MARGIN && px < view.width + MARGIN && py < view.height + MARGIN;
}

/** Whether a straight piece may be seen. */
function touches(view: View, ax: number, ay: number, bx: number, by: number): boolean {
  return Math.max(ax, bx) > -MARGIN && Math.max(ay, by) > -MARGIN && Math.min(ax, bx) < view.width + MARGIN
    && Math.min(ay, by) < view.height + MARGIN;
}

export function path(c: Context, view: View, indices: Uint32Array, line: Line, colour: string, width: number, dash: number[] = [], holds: (i: number) => boolean = () => true): void {
  c.beginPath();
  let open = false;
  let ax = NaN;
  let ay = NaN;
  for (const i of indices) {
    const bx = view.px(line.x[i]);
    const by = view.py(line.y[i]);
    if (holds(i) && Number.isFinite(ax) && Number.isFinite(bx) && touches(view, ax, ay, bx, by)) {
      if (!open) c.moveTo(ax, ay);
      c.lineTo(bx, by);
      open = true;
    } else {
      open = false;
    }
    ax = bx;
    ay = by;
  }
  c.strokeStyle = colour;
  c.lineWidth = width;
  c.setLineDash(dash);
  c.stroke();
  c.setLineDash([]);
}

export function strip(c: Context, view: View, indices: Uint32Array, one: Line, other: Line, colour: string): void {
  c.fillStyle = colour;
  ribbon(c, view, indices, one, other, () => true);
}

/** Fills between two lines, in pieces of so many samples: one outline of thousands is slow to fill. */
const PIECE = 4096;

function ribbon(c: Context, view: View, indices: Uint32Array, one: Line, other: Line, holds: (i: number) => boolean): void {
  let run: number[] = [];
  const fill = () => {
    if (run.length > 1) {
      c.beginPath();
      for (const i of run) c.lineTo(view.px(one.x[i]), view.py(one.y[i]));
      for (const i of run.reverse()) c.lineTo(view.px(other.x[i]), view.py(other.y[i]));
      c.fill("nonzero");
    }
    run = [];
  };
  for (let k = 1; k < indices.length; k++) {
    const i = indices[k - 1];
    const j = indices[k];
    const seen = touches(view, view.px(one.x[i]), view.py(one.y[i]), view.px(one.x[j]), view.py(one.y[j]))
      || near(view, view.px(other.x[i]), view.py(other.y[i]));
    if (!seen || !holds(j) || run.length > PIECE) fill();
    if (!seen || !holds(j)) continue;
    if (run.length === 0) run.push(i);
    run.push(j);
  }
  fill();
}

function band(c: Context, view: View, indices: Uint32Array, model: Model, wall: Trimmed, picture: Picture, colours: Palette): void {
  const error = picture.error as Float64Array;
  const edge = {
    x: wall.x.map((v, i) => v - picture.magnify * error[i] * model.nx[i]),
    y: wall.y.map((v, i) => v - picture.magnify * error[i] * model.ny[i]),
  };
  const { lower, upper } = picture.limits ?? { lower: 0, upper: 0 };
  const kinds: [string, (e: number) => boolean][] = [
    [colours.within, (e) => e >= lower && e <= upper],
    [colours.left, (e) => e > upper],
    [colours.gouge, (e) => e < lower],
  ];
  for (const [colour, holds] of kinds) {
    c.fillStyle = colour;
    c.globalAlpha = 0.5;
    const shown = (i: number) => holds(error[i]) && !wall.gone[i];
    ribbon(c, view, indices, wall, edge, shown);
    c.globalAlpha = 1;
    path(c, view, indices, edge, colour, 1.75, [], shown);
  }
}

/** Points over each other: what fails lies above what is undecided, that above what passes; so do larger deviations. */
const RANK = { aside: 0, plain: 1, within: 1, open: 2, left: 3, gouge: 3 };

/** More points than this are a crowd. */
const CROWD = 60;
/** Places that are tried for the deviation of a point, and pixels from which on a line leads to it. */
const FARTHER = 16;
const FAR = 30;

function points(c: Context, view: View, picture: Picture, colours: Palette): void {
  const seen = picture.points.flatMap((point, index) => {
    const { nx = 0, ny = 0, error_mm: error = 0 } = point;
    const x = point.x_mm + error * nx;
    const y = point.y_mm + error * ny;
    const where = standing(point, picture.limits);
    const wall = { x: view.px(x), y: view.py(y) };
    if (!near(view, wall.x, wall.y)) return [];
    return [{ point, index, nx, ny, where, wall, x: view.px(x - picture.magnify * error * nx), y: view.py(y - picture.magnify * error * ny) }];
  });
  const worth = (p: ProbePoint) => Math.abs(p.error_mm ?? 0);
  seen.sort((a, b) => RANK[a.where] - RANK[b.where] || worth(a.point) - worth(b.point));
  const outward = 14;
  for (const { index, nx, ny, where, wall, x, y } of seen) {
    c.strokeStyle = where === "aside" ? colours.quiet : colours.ink;
    // A scan has its normals side by side: thin ones, so that the wall stays to be seen.
    c.lineWidth = seen.length > CROWD ? 0.3 : 1;
    c.beginPath();
    c.moveTo(wall.x + nx * outward, wall.y - ny * outward);
    c.lineTo(x, y);
    c.stroke();
    c.fillStyle = fillOf(where, colours);
    c.lineWidth = index === picture.picked ? 3 : 1.5;
    drawMark(c, where, x, y, 4);
  }
  const labels: Label[] = [];
  const decimals = decimalsTelling(picture.points, picture.limits);
  c.font = `11px ${colours.font}`;
  for (const { point, wall } of seen.reverse()) {
    if (point.error_mm === undefined) continue;
    const text = sayDeviation(point.error_mm, decimals);
    const wide = c.measureText(text).width;
    // Beside the stroke; where there is no room, farther out along it, then on the other side of the wall.
    for (let k = 0; k < (seen.length > CROWD ? 1 : FARTHER); k++) {
      const away = k % 2 ? -(outward + 10 + 7 * k) : outward + 4 + 7 * k;
      const label = labelAt(point, text, wide, wall, away);
      if (!free(view, labels, label)) continue;
      labels.push(label);
      break;
    }
  }
  write(c, labels, colours);
}

/** A deviation beside its point: its box, the place of the wall, and how far from that it stands. */
interface Label { text: string; used: boolean; left: number; top: number; wide: number; wall: { x: number; y: number }; at: { x: number; y: number }; away: number }

function labelAt(point: ProbePoint, text: string, wide: number, wall: { x: number; y: number }, away: number): Label {
  const { nx = 0, ny = 0 } = point;
  const at = { x: wall.x + nx * away, y: wall.y - ny * away };
  const [right, up] = [nx * Math.sign(away), ny * Math.sign(away)];
  const left = Math.abs(nx) < 0.5 ? at.x - wide / 2 : right > 0 ? at.x : at.x - wide;
  const top = Math.abs(nx) < 0.5 ? (up > 0 ? at.y - 12 : at.y) : at.y - 6;
  return { text, used: point.status === "used", left, top, wide, wall, at, away };
}

function free(view: View, labels: Label[], { left, top, wide }: Label): boolean {
  if (left < 2 || top < 2 || left + wide > view.width - 2 || top + 12 > view.height - 2) return false;
  return !labels.some((l) => left < l.left + l.wide + 3 && l.left < left + wide + 3 && top < l.top + 12 && l.top < top + 12);
}

/** The lines to what stands far from its point lie below all labels. */
function write(c: Context, labels: Label[], colours: Palette): void {
  c.strokeStyle = colours.quiet;
  c.lineWidth = 0.6;
  c.beginPath();
  for (const { wall, at, away } of labels) {
    if (Math.abs(away) <= FAR) continue;
    c.moveTo(wall.x, wall.y);
    c.lineTo(at.x, at.y);
  }
  c.stroke();
  c.fillStyle = colours.ground;
  c.globalAlpha = 0.85;
  for (const { left, top, wide } of labels) c.fillRect(left - 2, top - 1, wide + 4, 14);
  c.globalAlpha = 1;
  c.textBaseline = "top";
  for (const { text, used, left, top } of labels) {
    c.fillStyle = used ? colours.ink : colours.quiet;
    c.fillText(text, left, top + 1);
  }
}
