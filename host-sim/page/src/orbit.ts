/** Looking at a body from a side: parallel projection, turned about the vertical and tilted, so that lengths across the view stay to scale. */

export type Vector = [number, number, number];

/** Pixels kept free about the whole. */
const EDGE = { side: 26, top: 34, bottom: 26 };
/** How much larger and smaller than the whole it may be drawn. */
const ZOOM = { least: 0.25, most: 400 };

export class Orbit {
  width = 1;
  height = 1;
  /** Pixels per millimetre, and where the centre of the body lies in the picture. */
  scale = 1;
  private x = 0;
  private y = 0;
  private whole = 1;
  private follows = true;

  /** Where the viewer stands, seen from the body: degrees counter-clockwise from X, and above the ground. `all` are corners of the body. */
  constructor(private azimuth: number, private elevation: number, private readonly all: Float32Array) {}

  /** Whether everything is shown, and stays so when it is turned. */
  get fitted(): boolean { return this.follows; }

  get from(): { azimuth: number; elevation: number } {
    return { azimuth: this.azimuth, elevation: this.elevation };
  }

  /** What tells this view from another. */
  get view(): string {
    return [this.azimuth, this.elevation, this.scale, this.x, this.y].join(" ");
  }

  /** Directions of the view in the space of the body: to the right, up, towards the viewer. */
  axes(): { right: Vector; up: Vector; eye: Vector } {
    const [a, h] = [this.azimuth, this.elevation].map((degrees) => (degrees * Math.PI) / 180);
    const [ca, sa, ch, sh] = [Math.cos(a), Math.sin(a), Math.cos(h), Math.sin(h)];
    return { right: [-sa, ca, 0], up: [-ca * sh, -sa * sh, ch], eye: [ca * ch, sa * ch, sh] };
  }

  /** Pixels of a place, and how near it is to the viewer, mm. */
  project(p: ArrayLike<number>, at = 0): Vector {
    const { right, up, eye } = this.axes();
    const along = (v: Vector) => p[at] * v[0] + p[at + 1] * v[1] + p[at + 2] * v[2];
    return [this.x + this.scale * along(right), this.y - this.scale * along(up), along(eye)];
  }

  /** Places to the space of the graphics processor, −1 … 1; `radius` holds the body. */
  matrix(radius: number): Float32Array {
    const { right, up, eye } = this.axes();
    const [sx, sy] = [(2 * this.scale) / this.width, (2 * this.scale) / this.height];
    const rows = [right.map((v) => v * sx), up.map((v) => v * sy), eye.map((v) => -v / radius)];
    const moved = [(2 * this.x) / this.width - 1, 1 - (2 * this.y) / this.height, 0];
    return Float32Array.from([...[0, 1, 2].flatMap((k) => [rows[0][k], rows[1][k], rows[2][k], 0]), ...moved, 1]);
  }

  resize(width: number, height: number): void {
    const [kept, x, y] = [this.scale / this.whole, this.x / this.width, this.y / this.height];
    [this.width, this.height] = [Math.max(1, width), Math.max(1, height)];
    const box = this.box();
    this.whole = this.scaleOf(box);
    if (this.follows) this.fit();
    else [this.scale, this.x, this.y] = [this.whole * kept, x * this.width, y * this.height];
  }

  fit(): void {
    const box = this.box();
    this.whole = this.scale = this.scaleOf(box);
    this.x = this.width / 2 - (this.scale * (box.x0 + box.x1)) / 2;
    this.y = (this.height + EDGE.top - EDGE.bottom) / 2 + (this.scale * (box.y0 + box.y1)) / 2;
    this.follows = true;
  }

  turn(azimuth: number, elevation: number): void {
    const middle = this.middle();
    this.azimuth = (((this.azimuth + azimuth) % 360) + 360) % 360;
    this.elevation = Math.min(90, Math.max(0, this.elevation + elevation));
    if (this.follows) this.fit();
    else this.centre(middle);
  }

  /** Looks from so many degrees. */
  look(azimuth: number, elevation = this.elevation): void {
    this.turn(azimuth - this.azimuth, elevation - this.elevation);
  }

  zoom(factor: number, px = this.width / 2, py = this.height / 2): void {
    const scale = Math.min(this.whole * ZOOM.most, Math.max(this.whole * ZOOM.least, this.scale * factor));
    this.x = px + ((this.x - px) * scale) / this.scale;
    this.y = py + ((this.y - py) * scale) / this.scale;
    this.scale = scale;
    this.follows = false;
  }

  pan(dx: number, dy: number): void {
    this.x += dx;
    this.y += dy;
    this.follows = false;
  }

  /** Puts a place into the middle of the picture. */
  centre(place: ArrayLike<number>): void {
    const [px, py] = this.project(place);
    this.pan(this.width / 2 - px, this.height / 2 - py);
  }

  /** Remembers what is shown; what is returned shows it again. */
  remember(): () => void {
    const { azimuth, elevation, scale, x, y, follows } = this;
    return () => Object.assign(this, { azimuth, elevation, scale, x, y, follows });
  }

  /** The place in the middle of the picture, in the plane through the centre of the body. */
  private middle(): Vector {
    const { right, up } = this.axes();
    const [a, b] = [(this.width / 2 - this.x) / this.scale, (this.y - this.height / 2) / this.scale];
    return [0, 1, 2].map((k) => a * right[k] + b * up[k]) as Vector;
  }

  /** How far the body reaches to the right and up, mm. */
  private box(): { x0: number; x1: number; y0: number; y1: number } {
    const { right, up } = this.axes();
    const box = { x0: Infinity, x1: -Infinity, y0: Infinity, y1: -Infinity };
    for (let i = 0; i < this.all.length; i += 3) {
      const [x, y] = [right, up].map((v) => this.all[i] * v[0] + this.all[i + 1] * v[1] + this.all[i + 2] * v[2]);
      box.x0 = Math.min(box.x0, x);
      box.x1 = Math.max(box.x1, x);
      box.y0 = Math.min(box.y0, y);
      box.y1 = Math.max(box.y1, y);
    }
    return box;
  }

  private scaleOf({ x0, x1, y0, y1 }: { x0: number; x1: number; y0: number; y1: number }): number {
    const room = (size: number, edges: number) => Math.max(size * 0.4, size - edges);
    return Math.min(room(this.width, 2 * EDGE.side) / Math.max(x1 - x0, 1e-3), room(this.height, EDGE.top + EDGE.bottom) / Math.max(y1 - y0, 1e-3));
  }
}
