/** Colours of wall errors: blue is cut too deep, white nominal, orange material left; told apart with any kind of colour blindness. */

import { roundStep } from "./view";

/** Colours of the scale from too deep over nominal to left: red, green, blue. */
const DEEP = [8, 69, 148];
const DEEPER_HALF = [107, 160, 214];
const NOMINAL = [255, 255, 255];
const LEFT_HALF = [247, 164, 84];
const LEFT = [166, 54, 3];
export const SCALE = [DEEP, DEEPER_HALF, NOMINAL, LEFT_HALF, LEFT];

/** Colour of an error as a share of the scale, −1 … 1; beyond it that of its end. */
export function colourOf(share: number): [number, number, number] {
  const at = (Math.min(1, Math.max(-1, share)) + 1) * 2;
  const k = Math.min(3, Math.floor(at));
  return [0, 1, 2].map((c) => Math.round(SCALE[k][c] + (SCALE[k + 1][c] - SCALE[k][c]) * (at - k))) as [number, number, number];
}

/** Colours from end to end of the scale, as pixels of a little-endian machine; nominal is in their middle. */
const HALF = 512;
const TABLE = Uint32Array.from({ length: 2 * HALF + 1 }, (_, k) => {
  const [r, g, b] = colourOf(k / HALF - 1);
  return ((255 << 24) | (b << 16) | (g << 8) | r) >>> 0;
});

/** The pixel of an error as a share of the scale. */
export function pixelOf(share: number): number {
  return TABLE[Math.round((Math.min(1, Math.max(-1, share)) + 1) * HALF)];
}

/** A round scale that holds so large an error. */
export function roundScale(size: number): number {
  return size > 0 ? roundStep(size) : 0.01;
}
