/** Millimetres to pixels and back, Y up; both scenes of a comparison share one view. */

import { per } from "./format";

export interface Box { x0: number; y0: number; x1: number; y1: number }

/** Pixels kept free at every side of the whole: room for figures. */
const EDGE = 54;

export class View {
  width = 1;
  height = 1;
  cx = 0;
  cy = 0;
  scale = 1;
  /** Pixels per millimetre at which everything is to be seen. */
  private whole = 1;
  private follows = true;

  /** Whether everything is shown, and stays so when the size changes. */
  get fitted(): boolean { return this.follows; }

  constructor(private readonly all: Box) {}

  px(x: number): number { return (x - this.cx) * this.scale + this.width / 2; }
  py(y: number): number { return this.height / 2 - (y - this.cy) * this.scale; }
  mmX(px: number): number { return (px - this.width / 2) / this.scale + this.cx; }
  mmY(py: number): number { return (this.height / 2 - py) / this.scale + this.cy; }

  resize(width: number, height: number): void {
    const kept = this.scale / this.whole;
    this.width = Math.max(1, width);
    this.height = Math.max(1, height);
    this.whole = this.scaleFor(this.all);
    if (this.follows) this.fit();
    else this.scale = this.whole * kept;
  }

  fit(): void {
    this.show(this.all);
    this.follows = true;
  }

  show(box: Box): void {
    this.cx = (box.x0 + box.x1) / 2;
    this.cy = (box.y0 + box.y1) / 2;
    this.scale = this.limited(this.scaleFor(box));
    this.follows = false;
  }

  zoom(factor: number, px = this.width / 2, py = this.height / 2): void {
    const x = this.mmX(px);
    const y = this.mmY(py);
    this.scale = this.limited(this.scale * factor);
    this.cx = x - (px - this.width / 2) / this.scale;
    this.cy = y - (this.height / 2 - py) / this.scale;
    this.follows = false;
  }

  pan(dx: number, dy: number): void {
    this.cx -= dx / this.scale;
    this.cy += dy / this.scale;
    this.follows = false;
  }

  centre(x: number, y: number): void {
    this.cx = x;
    this.cy = y;
    this.follows = false;
  }

  /** Remembers what is shown; what is returned shows it again. */
  remember(): () => void {
    const { cx, cy, scale, follows } = this;
    return () => Object.assign(this, { cx, cy, scale, follows });
  }

  private scaleFor(box: Box): number {
    const room = (size: number) => size - 2 * Math.min(EDGE, size * 0.15);
    const wide = Math.max(box.x1 - box.x0, 1e-3);
    const high = Math.max(box.y1 - box.y0, 1e-3);
    return Math.min(room(this.width) / wide, room(this.height) / high);
  }

  /** From a quarter of the whole to a pixel a hundredth of a micrometre. */
  private limited(scale: number): number {
    return Math.min(1e5, Math.max(this.whole / 4, scale));
  }
}

/** A length in mm that is 1, 2, 5, 10, … of its unit: the next that is not larger. */
export function roundBelow(wanted: number): number {
  const power = 10 ** Math.floor(Math.log10(wanted / per()));
  const lead = wanted / per() / power;
  return per() * power * (lead >= 5 ? 5 : lead >= 2 ? 2 : 1);
}

/** The next that is not smaller; of an error, a length, or `one` other unit. */
export function roundStep(wanted: number, one = per()): number {
  const power = 10 ** Math.floor(Math.log10(wanted / one));
  const lead = wanted / one / power;
  return one * power * (lead <= 1 ? 1 : lead <= 2 ? 2 : lead <= 5 ? 5 : 10);
}
