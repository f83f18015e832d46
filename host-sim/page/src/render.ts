/** The body drawn by the graphics processor: WebGL 2, one context for the page, off the screen; what it drew is copied into the picture. */

import type { Body, Faces, Frame } from "./body";
import type { Standing } from "./limits";
import { colourOf, SCALE } from "./shades";
import type { Orbit, Vector } from "./orbit";

/** What is drawn besides the body: colours as red, green, blue 0…1; lengths mm; widths in pixels. */
export interface Look {
  orbit: Orbit; size: number; ratio: number;
  ground: Vector; part: Vector; ink: Vector; quiet: Vector;
  /** Error that has the end of the colours, and those that have a line, the lower one dashed by pieces of this length. */
  full: number; levels: [number, number]; dash: number;
  tip: Vector | null; touches: boolean;
}
export type Shell = ReturnType<Frame["cutter"]>;

const FACE = [`#version 300 es
uniform mat4 view;
in vec3 place; in vec3 told; in vec2 into;
out vec3 at; out vec3 error; out vec2 inward;
void main() { at = place; error = told; inward = into; gl_Position = view * vec4(place, 1.0); }`, `#version 300 es
precision highp float;
uniform vec3 stops[5]; uniform vec3 light, eye, part, ink; uniform vec2 levels; uniform float full, dash, wide;
in vec3 at; in vec3 error; in vec2 inward;
out vec4 colour;
float line(float level) {
  float change = fwidth(error.x);
  return change > full * 1e-6 ? clamp(wide + 0.5 - abs(error.x - level) / change, 0.0, 1.0) : 0.0;
}
void main() {
  float share = (clamp(error.x / full, -1.0, 1.0) + 1.0) * 2.0;
  int k = min(3, int(share));
  vec3 seen = mix(stops[k], stops[k + 1], share - float(k));
  seen *= 0.86 + 0.14 * abs(dot(normalize(cross(dFdx(at), dFdy(at)) + 1e-12), light));
  float dashed = step(fract((error.y + error.z) / dash), 0.6);
  seen = mix(seen, ink, max(line(levels.y), line(levels.x) * dashed));
  // From behind, through the part, it is pale.
  if (dot(vec3(inward, 0.0), eye) > 0.0) seen = mix(seen, part, 0.45);
  colour = vec4(seen, 1.0);
}`];

const SHELL = [`#version 300 es
uniform mat4 view; uniform vec3 offset;
in vec3 place; in vec3 normal;
out vec3 across;
void main() { across = normal; gl_Position = view * vec4(place + offset, 1.0); }`, `#version 300 es
precision highp float;
uniform vec3 eye, paint; uniform vec2 cover;
in vec3 across;
out vec4 colour;
void main() { colour = vec4(paint, mix(cover.x, cover.y, pow(1.0 - abs(dot(normalize(across), eye)), 2.0))); }`];

const LINES = [`#version 300 es
uniform mat4 view; uniform vec3 offset; uniform vec2 size; uniform float wide, nearer;
in vec3 from; in vec3 to; in vec2 corner;
void main() {
  vec4 a = view * vec4(from + offset, 1.0);
  vec4 b = view * vec4(to + offset, 1.0);
  vec2 along = (b.xy - a.xy) * size;
  along = length(along) > 1e-6 ? normalize(along) : vec2(1.0, 0.0);
  vec4 p = mix(a, b, corner.x);
  p.xy += (vec2(-along.y, along.x) * corner.y + along * (corner.x - 0.5)) * wide / size;
  p.z -= nearer;
  gl_Position = p;
}`, `#version 300 es
precision highp float;
uniform vec4 paint;
out vec4 colour;
void main() { colour = paint; }`];

const MARKS = [`#version 300 es
uniform mat4 view; uniform float size, nearer;
in vec3 place; in vec3 paint; in float kind;
out vec3 fill; flat out int shape;
void main() { fill = paint; shape = int(kind); gl_Position = view * vec4(place, 1.0); gl_Position.z -= nearer; gl_PointSize = size; }`, `#version 300 es
precision highp float;
uniform vec3 ink;
in vec3 fill; flat in int shape;
out vec4 colour;
float triangle(vec2 q) { return max(q.y - 0.62, 0.878 * abs(q.x) - 0.479 * q.y - 0.43); }
void main() {
  vec2 q = gl_PointCoord * 2.0 - 1.0;
  float far = shape == 1 ? triangle(q) : shape == 2 ? triangle(vec2(q.x, -q.y)) : shape == 3 ? (abs(q.x) + abs(q.y) - 0.95) * 0.7071 : length(q) - 0.72;
  if (far > 0.0) discard;
  colour = vec4(far > -0.24 ? ink : fill, 1.0);
}`];
const SHAPES: Record<Standing, number> = { within: 0, plain: 0, aside: 0, left: 1, gouge: 2, open: 3 };
/** Diameter of a mark with its room, pixels; strokes. */
const MARK = 17;

/** A number for every value a shader names; those that are the same everywhere have the same number. */
const INPUTS = ["place", "told", "into", "normal", "from", "to", "corner", "paint", "kind"];

type Names = Record<string, number | readonly number[] | Float32Array>;

class Program {
  private readonly program: WebGLProgram;
  constructor(private readonly gl: WebGL2RenderingContext, sources: string[]) {
    this.program = gl.createProgram();
    [gl.VERTEX_SHADER, gl.FRAGMENT_SHADER].forEach((kind, k) => {
      const shader = gl.createShader(kind) as WebGLShader;
      gl.shaderSource(shader, sources[k]);
      gl.compileShader(shader);
      gl.attachShader(this.program, shader);
    });
    INPUTS.forEach((name, k) => gl.bindAttribLocation(this.program, k, name));
    gl.linkProgram(this.program);
    if (!gl.getProgramParameter(this.program, gl.LINK_STATUS) && !gl.isContextLost()) throw new Error(gl.getProgramInfoLog(this.program) ?? "no program");
  }

  /** Draws with this program from now on, with these values. */
  use(values: Names): void {
    const { gl } = this;
    gl.useProgram(this.program);
    for (const [name, value] of Object.entries(values)) {
      const at = gl.getUniformLocation(this.program, name);
      if (typeof value === "number") gl.uniform1f(at, value);
      else if (value.length === 16) gl.uniformMatrix4fv(at, false, value);
      else if (value.length === 15) gl.uniform3fv(at, value);
      else gl[`uniform${value.length as 2 | 3 | 4}fv`](at, value);
    }
  }
}

/** Arrays on the graphics processor, and how they are read. */
interface Kept { array: WebGLVertexArrayObject; buffers: WebGLBuffer[]; count: number }

export class Renderer {
  readonly canvas = document.createElement("canvas");
  private readonly gl: WebGL2RenderingContext;
  private readonly programs: { face: Program; shell: Program; lines: Program; marks: Program };
  private kept: Record<string, Kept> = {};
  private body: Body | null = null;
  private shell: Shell | null = null;

  /** Throws where the browser has no WebGL. */
  constructor(lost: () => void) {
    const gl = this.canvas.getContext("webgl2", { antialias: true, alpha: false, preserveDrawingBuffer: true });
    if (!gl) throw new Error("no WebGL");
    this.gl = gl;
    this.programs = { face: new Program(gl, FACE), shell: new Program(gl, SHELL), lines: new Program(gl, LINES), marks: new Program(gl, MARKS) };
    this.canvas.addEventListener("webglcontextlost", lost);
  }

  draw(body: Body, shell: Shell, look: Look): void {
    const { gl } = this;
    const { orbit, ratio } = look;
    [this.canvas.width, this.canvas.height] = [Math.round(orbit.width * ratio), Math.round(orbit.height * ratio)];
    if (this.body !== body) this.load(body);
    if (this.shell !== shell) this.loadShell(shell);
    gl.viewport(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight);
    gl.clearColor(...look.ground, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    const view = orbit.matrix(look.size * 2);
    const { eye, up, right } = orbit.axes();
    const light = [0, 1, 2].map((k) => (eye[k] + 0.5 * up[k] - 0.6 * right[k]) / Math.hypot(1, 0.5, 0.6));
    const flat = (name: string, paint: Vector) => {
      this.programs.shell.use({ view, eye, offset: [0, 0, 0], paint, cover: [1, 1] });
      this.triangles(name);
    };
    // The cutter stands on the floor.
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1, 4);
    flat("floor", mixed(look.ground, look.part, 0.4));
    gl.disable(gl.POLYGON_OFFSET_FILL);
    flat("land", look.part);
    this.programs.face.use({
      view, eye, light, part: look.part, ink: [0.07, 0.07, 0.07], stops: SCALE.flat().map((v) => v / 255),
      full: look.full, levels: look.levels, dash: look.dash, wide: 0.55 * ratio,
    });
    this.triangles("face");
    // Lines lie a little before what they lie on.
    const line = (name: string, paint: Vector, wide: number, nearer: number, offset: Vector = [0, 0, 0], cover = 1) => {
      this.programs.lines.use({ view, offset, size: [this.canvas.width, this.canvas.height], wide: wide * ratio * 2, nearer, paint: [...paint, cover] });
      this.pieces(name);
    };
    line("edges", look.quiet, 0.5, 0.0008);
    line("nominal", look.ink, 0.8, 0.001);
    if (look.touches && body.marks.standings.length > 0) {
      // A mark is flat towards the viewer: the wall under it, which may lie aslant, is behind all of it.
      const nearer = MARK / orbit.scale / (2 * look.size);
      line("strokes", look.ink, 0.5, nearer);
      this.programs.marks.use({ view, size: MARK * ratio, nearer, ink: [0.07, 0.07, 0.07] });
      this.paint(body, look.full);
      gl.bindVertexArray(this.kept.marks.array);
      gl.drawArrays(gl.POINTS, 0, this.kept.marks.count);
    }
    if (look.tip) {
      gl.enable(gl.BLEND);
      gl.depthMask(false);
      this.programs.shell.use({ view, eye, offset: look.tip, paint: look.ink, cover: [0.05, 0.32] });
      this.triangles("shell");
      line("rims", look.ink, 0.55, 0, look.tip, 0.75);
      gl.depthMask(true);
      gl.disable(gl.BLEND);
    }
    gl.bindVertexArray(null);
  }

  private triangles(name: string): void {
    const { array, count } = this.kept[name];
    this.gl.bindVertexArray(array);
    this.gl.drawElements(this.gl.TRIANGLES, count, this.gl.UNSIGNED_INT, 0);
  }

  private pieces(name: string): void {
    const { array, count } = this.kept[name];
    this.gl.bindVertexArray(array);
    this.gl.drawArraysInstanced(this.gl.TRIANGLE_STRIP, 0, 4, count);
  }

  /** Colours of the marks: what was measured, on the scale of the face. */
  private paint(body: Body, full: number): void {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.kept.marks.buffers[1]);
    gl.bufferData(gl.ARRAY_BUFFER, Float32Array.from(Array.from(body.marks.errors).flatMap((e) => colourOf(e / full).map((v) => v / 255))), gl.DYNAMIC_DRAW);
  }

  private load(body: Body): void {
    const faces = ({ places, indices }: Faces) => ({ indices, inputs: { place: [places, 3] } as Record<string, [Float32Array, number]> });
    const { face, land, floor, marks } = body;
    this.keep("face", { indices: face.indices, inputs: { place: [face.places, 3], told: [face.told, 3], into: [face.into, 2] } });
    this.keep("land", faces(land));
    this.keep("floor", faces(floor));
    for (const name of ["nominal", "edges", "strokes"] as const) this.keepPieces(name, body[name]);
    const kinds = Float32Array.from(marks.standings, (standing) => SHAPES[standing]);
    this.keep("marks", { inputs: { place: [marks.places, 3], paint: [new Float32Array(marks.places.length), 3], kind: [kinds, 1] } });
    this.body = body;
  }

  private loadShell(shell: Shell): void {
    this.keep("shell", { indices: shell.indices, inputs: { place: [shell.places, 3], normal: [shell.normals, 3] } });
    this.keepPieces("rims", shell.lines);
    this.shell = shell;
  }

  private keepPieces(name: string, pieces: Float32Array): void {
    const { gl } = this;
    const corners = Float32Array.from([0, -1, 0, 1, 1, -1, 1, 1]);
    const kept = this.keep(name, { inputs: { corner: [corners, 2] } });
    const buffer = gl.createBuffer();
    gl.bindVertexArray(kept.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, pieces, gl.STATIC_DRAW);
    ["from", "to"].forEach((input, k) => {
      const at = INPUTS.indexOf(input);
      gl.enableVertexAttribArray(at);
      gl.vertexAttribPointer(at, 3, gl.FLOAT, false, 24, 12 * k);
      gl.vertexAttribDivisor(at, 1);
    });
    kept.buffers.push(buffer);
    kept.count = pieces.length / 6;
  }

  /** Puts arrays on the graphics processor under a name, in place of those that were there. */
  private keep(name: string, { inputs, indices }: { inputs: Record<string, [Float32Array, number]>; indices?: Uint32Array }): Kept {
    const { gl } = this;
    const old = this.kept[name];
    if (old) {
      gl.deleteVertexArray(old.array);
      for (const buffer of old.buffers) gl.deleteBuffer(buffer);
    }
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    const buffers = Object.entries(inputs).map(([input, [values, width]]) => {
      const buffer = gl.createBuffer();
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
      const at = INPUTS.indexOf(input);
      gl.enableVertexAttribArray(at);
      gl.vertexAttribPointer(at, width, gl.FLOAT, false, 0, 0);
      return buffer;
    });
    if (indices) {
      const buffer = gl.createBuffer();
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, indices, gl.STATIC_DRAW);
      buffers.push(buffer);
    }
    const [values, width] = Object.values(inputs)[0];
    this.kept[name] = { array, buffers, count: indices?.length ?? values.length / width };
    return this.kept[name];
  }
}

function mixed(a: Vector, b: Vector, share: number): Vector {
  return [0, 1, 2].map((k) => a[k] + (b[k] - a[k]) * share) as Vector;
}
