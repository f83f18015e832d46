/** What lengths are read from: the grid, its numbers over everything that is filled, the bar of the error. */

import { fixed, per, sayError, stepDecimals, unitOf, withUnit } from "./format";
import type { Palette } from "./palette";
import { roundBelow, roundStep, type View } from "./view";

type Context = CanvasRenderingContext2D;

/** Lines of the grid: multiples of a round step, across and up. */
interface Grid { step: number; x: [number, number]; y: [number, number] }

function gridOf(view: View): Grid {
  const step = roundStep(70 / view.scale);
  return {
    step, x: [Math.ceil(view.mmX(0) / step), Math.floor(view.mmX(view.width) / step)],
    y: [Math.ceil(view.mmY(view.height) / step), Math.floor(view.mmY(0) / step)],
  };
}

export function gridLines(c: Context, view: View, colours: Palette): void {
  const { step, x, y } = gridOf(view);
  c.strokeStyle = colours.grid;
  c.lineWidth = 1;
  c.beginPath();
  for (let k = x[0]; k <= x[1]; k++) {
    const px = Math.round(view.px(k * step)) + 0.5;
    c.moveTo(px, 0);
    c.lineTo(px, view.height);
  }
  for (let k = y[0]; k <= y[1]; k++) {
    const py = Math.round(view.py(k * step)) + 0.5;
    c.moveTo(0, py);
    c.lineTo(view.width, py);
  }
  c.stroke();
}

/** Numbers of the grid; a rim in the colour of the ground keeps them readable on whatever they lie. */
export function gridNumbers(c: Context, view: View, colours: Palette): void {
  const { step, x, y } = gridOf(view);
  c.font = `11px ${colours.font}`;
  c.fillStyle = colours.quiet;
  c.strokeStyle = colours.ground;
  c.lineWidth = 4;
  c.lineJoin = "round";
  const write = (text: string, px: number, py: number) => {
    c.strokeText(text, px, py);
    c.fillText(text, px, py);
  };
  const name = `X ${unitOf()}`;
  const right = view.width - 5 - c.measureText(name).width;
  const number = (v: number) => sayError(v, stepDecimals(step));
  c.textBaseline = "bottom";
  for (let k = x[0]; k <= x[1]; k++) {
    const px = view.px(k * step);
    const text = number(k * step);
    if (px > 46 && px + 3 + c.measureText(text).width < right - 8) write(text, px + 3, view.height - 2);
  }
  for (let k = y[0]; k <= y[1]; k++) {
    const py = view.py(k * step);
    if (py < view.height - 22 && py > 26) write(number(k * step), 3, py - 1);
  }
  write(name, right, view.height - 2);
  c.textBaseline = "top";
  write(`Y ${unitOf()}`, 3, 3);
}

/** A round length as it is spoken of: micrometres below a hundredth of a millimetre. */
export function lengthText(mm: number): string {
  if (mm < 0.0099 && per() === 1) return `${fixed(mm * 1000, stepDecimals(mm * 1000))} µm`;
  return withUnit(sayError(mm, stepDecimals(mm)));
}

/** How large an error is drawn: a bar of a round length. */
export function errorScale(c: Context, view: View, magnify: number, colours: Palette): void {
  const pixels = view.scale * magnify;
  const size = roundBelow(90 / pixels);
  const text = `error ${lengthText(size)}`;
  c.font = `11px ${colours.font}`;
  const wide = Math.max(size * pixels, c.measureText(text).width);
  const right = view.width - 10;
  c.fillStyle = colours.ground;
  c.globalAlpha = 0.85;
  c.fillRect(right - wide - 5, 5, wide + 10, 29);
  c.globalAlpha = 1;
  c.fillStyle = colours.ink;
  c.textBaseline = "top";
  c.textAlign = "right";
  c.fillText(text, right, 8);
  c.textAlign = "left";
  const left = right - size * pixels;
  c.beginPath();
  for (const [x, y] of [[left, 22], [left, 30], [left, 26], [right, 26], [right, 22], [right, 30]]) {
    if (x === left && y === 22) c.moveTo(x, y);
    else c.lineTo(x, y);
  }
  c.strokeStyle = colours.ink;
  c.lineWidth = 1.5;
  c.stroke();
}
