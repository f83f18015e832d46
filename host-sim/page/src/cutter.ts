/** The moving layer of a scene: cutter, engaged arc, force, uncut stock, the place under the pointer. */

import { levelFor, strip, type Picture } from "./draw";
import type { Palette } from "./palette";
import type { View } from "./view";

type Context = CanvasRenderingContext2D;

/** Linear between two samples. */
export function between(values: ArrayLike<number>, place: number): number {
  const i = Math.floor(place);
  if (place === i) return values[i];
  const j = Math.min(i + 1, values.length - 1);
  return values[i] + (values[j] - values[i]) * (place - i);
}

export function drawMoving(c: Context, view: View, picture: Picture, colours: Palette, place: number, largestForce: number, hovered: number | null): void {
  const { model, pass } = picture;
  if (!model) return;
  if (picture.stock && picture.wall && !picture.hidden.has("stock")) {
    const ahead = pass ? levelFor(model, view).filter((i) => i >= place) : levelFor(model, view);
    strip(c, view, ahead, picture.stock, picture.wall, colours.stock);
  }
  if (hovered !== null) mark(c, view, picture, colours, hovered);
  if (!pass || picture.hidden.has("cutter")) return;
  const m = picture.magnify;
  // Where no deviation is known the cutter stands on its path.
  const deviation = pass.across ? (between(pass.across, place) || 0) * m : 0;
  const nx = between(model.nx, place);
  const ny = between(model.ny, place);
  const px = view.px(between(model.x.values, place) + deviation * nx);
  const py = view.py(between(model.y.values, place) + deviation * ny);
  const radius = model.radius * view.scale;
  const normal = Math.atan2(ny, nx);
  const round = (from: number, to: number) => turn(c, view, px, py, radius, from, to);
  c.beginPath();
  round(0, 2 * Math.PI);
  c.fillStyle = colours.cutter;
  c.fill();
  c.strokeStyle = colours.ink;
  c.lineWidth = 1.25;
  c.stroke();
  const arc = pass.series.arc_deg;
  if (arc) {
    const end = normal + model.turn * between(arc.values, place) * (Math.PI / 180);
    c.beginPath();
    c.moveTo(px, py);
    round(normal, end);
    c.closePath();
    c.fillStyle = colours.first;
    c.globalAlpha = 0.3;
    c.fill();
    c.globalAlpha = 1;
    c.beginPath();
    round(normal, end);
    c.strokeStyle = colours.first;
    c.lineWidth = 5;
    c.stroke();
  }
  cross(c, px, py, colours.ink);
  const { fx_n: fx, fy_n: fy } = pass.series;
  if (fx && fy && largestForce > 0 && !picture.hidden.has("force")) {
    const size = Math.max(50, Math.min(110, radius * 1.4)) / largestForce;
    arrow(c, px, py, px + between(fx.values, place) * size, py - between(fy.values, place) * size, colours.ink);
  }
}

/** Radius in pixels from which the canvas' own arcs leave their place by a visible part of a pixel. */
const LARGE = 20000;

/**
 * An arc from one angle to another, in radians counter-clockwise of X.
 *
 * A large one is drawn as a polygon with its corners at the rim where the window is: what lies about the window needs no more
 * than a chord, and within it a chord of a few pixels is not told from the arc.
 */
function turn(c: Context, view: View, px: number, py: number, radius: number, from: number, to: number): void {
  if (!(radius > LARGE)) {
    c.arc(px, py, radius, -from, -to, to > from);
    return;
  }
  const at = (angle: number) => c.lineTo(px + radius * Math.cos(angle), py - radius * Math.sin(angle));
  const [least, most] = [Math.min(from, to), Math.max(from, to)];
  const corners = [least, most];
  const coarse = (2 * Math.PI) / 360;
  for (let angle = least + coarse; angle < most; angle += coarse) corners.push(angle);
  // The window as seen from the centre, and a little about it.
  const [cx, cy] = [view.width / 2 - px, py - view.height / 2];
  const half = Math.hypot(view.width, view.height) / radius;
  const window = Math.atan2(cy, cx);
  for (const whole of [window - 2 * Math.PI, window, window + 2 * Math.PI]) {
    for (let k = -100; k <= 100; k++) {
      const angle = whole + (k / 100) * half;
      if (angle > least && angle < most) corners.push(angle);
    }
  }
  corners.sort((a, b) => (to > from ? a - b : b - a)).forEach(at);
}

function cross(c: Context, px: number, py: number, colour: string): void {
  c.beginPath();
  c.moveTo(px - 6, py);
  c.lineTo(px + 6, py);
  c.moveTo(px, py - 6);
  c.lineTo(px, py + 6);
  c.strokeStyle = colour;
  c.lineWidth = 1;
  c.stroke();
}

function arrow(c: Context, ax: number, ay: number, bx: number, by: number, colour: string): void {
  const size = Math.hypot(bx - ax, by - ay);
  if (size < 2) return;
  const ux = (bx - ax) / size;
  const uy = (by - ay) / size;
  const head = Math.min(9, size);
  c.strokeStyle = colour;
  c.fillStyle = colour;
  c.lineWidth = 2;
  c.beginPath();
  c.moveTo(ax, ay);
  c.lineTo(bx - ux * head * 0.8, by - uy * head * 0.8);
  c.stroke();
  c.beginPath();
  c.moveTo(bx, by);
  c.lineTo(bx - ux * head - uy * head * 0.4, by - uy * head + ux * head * 0.4);
  c.lineTo(bx - ux * head + uy * head * 0.4, by - uy * head - ux * head * 0.4);
  c.closePath();
  c.fill();
}

function mark(c: Context, view: View, picture: Picture, colours: Palette, index: number): void {
  const { model, wall } = picture;
  if (!model) return;
  const ax = view.px(model.x.values[index]);
  const ay = view.py(model.y.values[index]);
  c.strokeStyle = colours.ink;
  c.fillStyle = colours.ink;
  c.lineWidth = 1;
  c.beginPath();
  c.arc(ax, ay, 3.5, 0, 2 * Math.PI);
  c.fill();
  if (!wall) return;
  c.beginPath();
  c.moveTo(ax, ay);
  c.lineTo(view.px(wall.x[index]), view.py(wall.y[index]));
  c.stroke();
  c.beginPath();
  c.arc(view.px(wall.x[index]), view.py(wall.y[index]), 3.5, 0, 2 * Math.PI);
  c.fill();
}
