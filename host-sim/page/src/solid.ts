/** The wall in 3D: what of it is shown from where, drawn into the picture of the card; what pointer and keys turn. */

import { Frame, type Body } from "./body";
import type { ProbePoint } from "./data";
import { fixed, sayError, stepDecimals, withUnit } from "./format";
import type { Limits } from "./limits";
import type { Model } from "./model";
import { Orbit, type Vector } from "./orbit";
import type { Palette } from "./palette";
import { Renderer, type Shell } from "./render";
import type { State } from "./state";
import type { Surface } from "./surface";
import type { Trimmed } from "./trim";
import { roundBelow } from "./view";

/** From how high above the ground it is seen at first, degrees; a key turns by so many, with Shift by more. */
const ELEVATION = 38;
const TURN = { key: 5, far: 30 };
/** Degrees a pixel that is dragged. */
const DRAG = 0.4;

/** What is drawn of a wall. */
export interface Scene {
  state: State;
  /** How much of the length shows the second pass, and the pass shown at an arc length. */
  share: number;
  surfaceAt: (s: number) => Surface;
  points: ProbePoint[];
  limits: Limits | undefined;
  /** Error at the end of the colours, and those with a line, mm. */
  scale: number;
  levels: [number, number];
}

/** A graphics context is dear: one for the page, and who has to know when it is gone. */
let renderer: Renderer | null = null;
let gone: () => void = () => undefined;

/** A colour of the style sheet, 0…1. */
function paint(colour: string): Vector {
  return [1, 3, 5].map((k) => parseInt(colour.slice(k, k + 2), 16) / 255) as Vector;
}

export class Solid {
  private readonly frame: Frame;
  private readonly orbit: Orbit;
  private readonly shell: Shell;
  private body: Body | null = null;
  /** What the body was built from. */
  private built = { magnify: NaN, share: NaN, scale: NaN };
  private places: { px: Float32Array; view: string } | null = null;

  /** Throws where the browser has no WebGL. `lost` is told when it has it no longer. */
  constructor(private readonly model: Model, wall: Trimmed, surfaces: Surface[], lost: () => void) {
    renderer ??= new Renderer(() => { renderer = null; gone(); });
    gone = lost;
    this.frame = new Frame(model, wall, surfaces);
    this.orbit = new Orbit(0, ELEVATION, this.frame.corners());
    this.orbit.look(this.frame.facing(surfaces[0]));
    const { teeth = 0, helix_deg: helix = 0 } = model.report.job?.tool ?? {};
    this.shell = this.frame.cutter(teeth, helix);
  }

  get fitted(): boolean { return this.orbit.fitted; }
  /** From where it is seen, degrees, how large, and where its middle is: pixels. */
  get view(): string { return this.orbit.view; }

  /** From where it is seen, in words. */
  get side(): string {
    const { azimuth, elevation } = this.orbit.from;
    const names = ["+X", "+X and +Y", "+Y", "−X and +Y", "−X", "−X and −Y", "−Y", "+X and −Y"];
    return elevation > 85 ? "from above" : `from ${names[Math.round(azimuth / 45) % 8]}, ${fixed(elevation, 0)}° above the floor`;
  }

  /** How many times as high as it is the wall is drawn. */
  get rise(): number { return this.frame.rise; }

  draw(c: CanvasRenderingContext2D, width: number, height: number, ratio: number, scene: Scene, colours: Palette): void {
    const { orbit, frame, model } = this;
    const { magnify, hidden, place } = scene.state;
    if (!renderer) return;
    if (width !== orbit.width || height !== orbit.height) orbit.resize(width, height);
    const body = this.bodyOf(scene);
    const surface = scene.surfaceAt(model.s.values[Math.round(place)]);
    const [ground, part, ink, quiet] = [colours.ground, colours.part, colours.ink, colours.quiet].map(paint);
    renderer.draw(body, this.shell, {
      orbit, size: frame.size, ratio, ground, part, ink, quiet, full: scene.scale, levels: scene.levels, dash: frame.size / 40,
      tip: hidden.has("cutter") || !(model.radius > 0) ? null : frame.tip(place, magnify, surface.pass.across), touches: !hidden.has("points"),
    });
    c.drawImage(renderer.canvas, 0, 0, width, height);
    c.font = `11px ${colours.font}`;
    c.textBaseline = "middle";
    this.directions(c, height, colours);
    this.ruler(c, width, height, colours);
  }

  private bodyOf({ state: { magnify }, share, scale, surfaceAt, points, limits }: Scene): Body {
    if (!this.body || this.built.magnify !== magnify || this.built.share !== share || this.built.scale !== scale) {
      this.body = this.frame.build(magnify, scale, surfaceAt, points, limits);
      this.built = { magnify, share, scale };
      this.places = null;
    }
    return this.body;
  }

  /** The axes of the program, in the corner. */
  private directions(c: CanvasRenderingContext2D, height: number, colours: Palette): void {
    const { right, up, eye } = this.orbit.axes();
    const [x, y, size] = [34, height - 34, 22];
    c.strokeStyle = c.fillStyle = colours.quiet;
    c.lineWidth = 1.5;
    c.textAlign = "center";
    [0, 1, 2].sort((a, b) => eye[a] - eye[b]).forEach((k) => {
      const [dx, dy] = [right[k], -up[k]];
      // An axis that points at the viewer has no length to be seen.
      if (Math.hypot(dx, dy) < 0.15) return;
      c.beginPath();
      c.moveTo(x, y);
      c.lineTo(x + size * dx, y + size * dy);
      c.stroke();
      c.fillText("XYZ"[k], x + (size + 8) * dx, y + (size + 8) * dy);
    });
    c.textAlign = "left";
  }

  /** A length across the view. */
  private ruler(c: CanvasRenderingContext2D, width: number, height: number, colours: Palette): void {
    const length = roundBelow(Math.max(60, width / 8) / this.orbit.scale);
    const wide = length * this.orbit.scale;
    const [right, y] = [width - 12, height - 14];
    c.strokeStyle = c.fillStyle = colours.quiet;
    c.lineWidth = 1;
    c.beginPath();
    c.moveTo(right - wide, y - 4);
    c.lineTo(right - wide, y);
    c.lineTo(right, y);
    c.lineTo(right, y - 4);
    c.stroke();
    c.textAlign = "right";
    c.fillText(withUnit(sayError(length, stepDecimals(length))), right, y - 10);
    c.textAlign = "left";
  }

  /** Pixels of a place of the wall, as it is drawn. */
  pixels(s: number, z: number, surface: Surface, factor: number): [number, number] {
    const i = this.model.nearest(s);
    const [px, py] = this.orbit.project(this.frame.onWall(i, z, surface.at(s, z), factor));
    return [px, py];
  }

  /** The place of the wall at a pixel, the nearest to the viewer; null beside the wall. */
  pick(px: number, py: number): { s: number; z: number } | null {
    if (!this.body) return null;
    const { places, told, indices } = this.body.face;
    const at = this.projected(places);
    let found: { s: number; z: number } | null = null;
    let nearest = -Infinity;
    for (let t = 0; t < indices.length; t += 3) {
      const [a, b, c] = [3 * indices[t], 3 * indices[t + 1], 3 * indices[t + 2]];
      const [ax, ay, bx, by, cx, cy] = [at[a], at[a + 1], at[b], at[b + 1], at[c], at[c + 1]];
      const whole = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay);
      if (whole === 0) continue;
      const u = ((px - ax) * (cy - ay) - (cx - ax) * (py - ay)) / whole;
      const v = ((bx - ax) * (py - ay) - (px - ax) * (by - ay)) / whole;
      if (u < 0 || v < 0 || u + v > 1) continue;
      const mean = (of: Float32Array, k: number) => of[a + k] * (1 - u - v) + of[b + k] * u + of[c + k] * v;
      if (mean(at, 2) <= nearest) continue;
      nearest = mean(at, 2);
      found = { s: mean(told, 1), z: mean(told, 2) };
    }
    return found;
  }

  /** Corners of the face in pixels, once for a view. */
  private projected(places: Float32Array): Float32Array {
    const { view } = this.orbit;
    if (this.places?.view === view) return this.places.px;
    const px = new Float32Array(places.length);
    for (let i = 0; i < places.length; i += 3) px.set(this.orbit.project(places, i), i);
    this.places = { px, view };
    return px;
  }

  drag(dx: number, dy: number): void { this.orbit.turn(-dx * DRAG, dy * DRAG); }
  turn(azimuth: number, elevation = 0): void { this.orbit.turn(azimuth, elevation); }
  pan(dx: number, dy: number): void { this.orbit.pan(dx, dy); }
  zoom(factor: number, px?: number, py?: number): void { this.orbit.zoom(factor, px, py); }
  fit(): void { this.orbit.fit(); }
  remember(): () => void { return this.orbit.remember(); }

  /** Turns the wall so that a place of it faces the viewer, in the middle of the picture. */
  face(place: number, z: number): void {
    const i = Math.round(place);
    this.orbit.look(this.frame.azimuth(i) + 20);
    if (!this.orbit.fitted) this.orbit.centre(this.frame.onWall(i, z, 0, 0));
  }

  /** What a key does with the view; whether it does anything. */
  key(event: KeyboardEvent): boolean {
    const by = event.shiftKey ? TURN.far : TURN.key;
    const moves: Record<string, () => void> = {
      ArrowLeft: () => this.turn(by), ArrowRight: () => this.turn(-by), ArrowUp: () => this.turn(0, by), ArrowDown: () => this.turn(0, -by),
      "+": () => this.zoom(1.25), "=": () => this.zoom(1.25), "-": () => this.zoom(0.8), "_": () => this.zoom(0.8), "0": () => this.fit(),
    };
    moves[event.key]?.();
    return event.key in moves;
  }
}
