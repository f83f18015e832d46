/** All contours of the part in one picture at true scale; a click, a tap or a key chooses one. */

import { el, svg } from "./dom";
import { worstFirst, type Entry, type Figure } from "./entries";
import { widest } from "./letters";
import { boxOf, type Line } from "./outline";
import { lengthText } from "./rulers";
import { roundBelow, View } from "./view";

/** Points of a line that are nearer to each other than this are one, pixels. */
const POINT = 0.5;
/** Samples of a line that are looked at, at most: a picture has no more places. */
const SAMPLES = 4000;
/** How far from a line a click or a finger may be, pixels. */
const REACH = 24;
/** A contour smaller than this has a ring around it, pixels. */
const SMALL = 14;
/** Letters of a name in the picture, at most; the table has all of it. */
const LETTERS = 22;
/** Room beside and above a label, pixels. */
const LABEL = { high: 14, beside: 4 };

interface Corner { x: number; y: number }
/** Left, top, right, bottom. */
type Box = [number, number, number, number];
interface Drawn { entry: Entry; link: SVGElement; walls: Corner[][]; ways: Corner[][]; box: Box }

export class Overview {
  readonly element: HTMLElement;
  private readonly box = el("div", { class: "map" });
  private readonly flag = el("div", { class: "flag", "aria-hidden": "true" });
  private readonly key = el("p", { class: "map-key" });
  private readonly view: View;
  private worst = 0;
  private order: Entry[] = [];
  private drawn: Drawn[] = [];
  private chosen = -1;
  private readonly seen = new ResizeObserver(() => { if (!document.documentElement.dataset.printing) this.draw(); });

  /** `choose` is called with a contour that was clicked or stepped to. */
  constructor(private readonly entries: Entry[], private figure: Figure, private readonly read: (size: number | undefined) => string,
    private readonly href: (entry: Entry) => string, private readonly choose: (entry: Entry, stepped: boolean) => void,
    private readonly hovered: (entry: Entry | null) => void) {
    this.view = new View(boxOf(entries.flatMap(({ wall, path }) => [...wall, ...path]), 0));
    this.element = el("div", { class: "map-frame" }, this.box, this.flag, this.key);
    this.box.addEventListener("click", (event) => this.click(event));
    this.box.addEventListener("pointermove", (event) => { if (event.pointerType !== "touch") this.hover(event); });
    this.box.addEventListener("pointerleave", () => this.near(null));
    this.box.addEventListener("keydown", (event) => this.press(event));
    this.seen.observe(this.box);
    this.rank(figure);
  }

  /** Colours, weights and the room for names go by a figure. */
  rank(figure: Figure): void {
    this.figure = figure;
    this.order = worstFirst(this.entries, figure);
    this.worst = Math.max(0, this.order[0]?.outcome[figure.key] ?? 0);
    this.explain();
    this.draw();
  }

  /** Marks a contour as the one that is shown. */
  mark(index: number): void {
    this.chosen = index;
    for (const { entry, link } of this.drawn) this.state(entry, link);
  }

  /** Marks what is pointed at, here or in the table. */
  point(entry: Entry | null): void {
    for (const drawn of this.drawn) drawn.link.classList.toggle("near", drawn.entry === entry);
  }

  private state(entry: Entry, link: SVGElement): void {
    const here = entry.index === this.chosen;
    link.classList.toggle("chosen", here);
    link.setAttribute("tabindex", here ? "0" : "-1");
    if (here) link.setAttribute("aria-current", "true");
    else link.removeAttribute("aria-current");
  }

  draw(): void {
    const { clientWidth: width, clientHeight: height } = this.box;
    if (width < 2 || height < 2) return;
    const focused = this.drawn.find(({ link }) => link === document.activeElement)?.entry;
    this.view.resize(width, height);
    this.view.fit();
    const picture = svg("svg", { width, height, viewBox: `0 0 ${width} ${height}`, role: "group", "aria-label": "Contours of the part, to scale", "aria-describedby": "keys" });
    this.drawn = this.entries.map((entry) => this.contour(entry));
    // The worst lies over the others.
    for (const entry of [...this.order].reverse()) picture.append(this.drawn[entry.index].link);
    this.names();
    picture.append(...this.scale());
    this.box.replaceChildren(picture);
    this.drawn.find(({ entry }) => entry === focused)?.link.focus();
  }

  private contour(entry: Entry): Drawn {
    const { view } = this;
    const place = (line: Line) => thinned(line, view);
    const walls = entry.wall.map(place);
    const size = entry.outcome[this.figure.key];
    const share = this.worst > 0 ? Math.max(0, size ?? 0) / this.worst : 0;
    const wide = 1.25 + 2.75 * share;
    const value = size === undefined ? "" : `, ${this.figure.name} ${this.read(size)}`;
    const link = svg("a", { href: this.href(entry), "aria-label": `${entry.name}${value}` });
    const d = walls.map(outlined).join("");
    const ways = entry.path.map(place);
    const all = walls.flat();
    const box = all.reduce<Box>(([l, t, r, b], { x, y }) => [Math.min(l, x), Math.min(t, y), Math.max(r, x), Math.max(b, y)],
      [Infinity, Infinity, -Infinity, -Infinity]);
    if (all.length) {
      link.append(svg("path", { class: "halo", d, "stroke-width": wide + 7 }), svg("path", { class: "way", d: ways.map(outlined).join("") }));
      const wall = svg("path", { class: "wall", d, "stroke-width": wide });
      wall.style.stroke = `color-mix(in srgb, var(--left) ${Math.round(100 * share)}%, var(--quiet))`;
      link.append(wall);
      if (Math.max(box[2] - box[0], box[3] - box[1]) < SMALL) link.append(svg("circle", { class: "ring", cx: (box[0] + box[2]) / 2, cy: (box[1] + box[3]) / 2, r: SMALL }));
    }
    this.state(entry, link);
    return { entry, link, walls, ways, box };
  }

  /** Names beside the contours, the worst first: in full, or else the number of the table, rather over a path of the cutter than not at all. */
  private names(): void {
    const taken: Box[] = [];
    const walls = this.drawn.flatMap((drawn) => drawn.walls.flatMap(dense));
    const all = [...walls, ...this.drawn.flatMap((drawn) => drawn.ways.flatMap(dense))];
    for (const { index, name } of this.order) {
      const { box, link } = this.drawn[index];
      if (!(box[2] >= box[0])) continue;
      const short = name.length > LETTERS ? `${name.slice(0, LETTERS - 1)}…` : name;
      for (const [text, corners] of [[short, all], [short, walls], [String(index + 1), all], [String(index + 1), walls]] as const) {
        // Bold letters, as those of the chosen one, are a little wider.
        const free = this.room(box, 1.08 * widest([text]) + 2 * LABEL.beside, taken, corners);
        if (!free) continue;
        taken.push(free);
        link.append(svg("text", { x: (free[0] + free[2]) / 2, y: free[3] - 3, "text-anchor": "middle" }, text));
        break;
      }
    }
  }

  /** A place for a label about a contour: within the picture, over no other label and no line. */
  private room([l, t, r, b]: Box, wide: number, taken: Box[], corners: Corner[]): Box | undefined {
    const { width, height } = this.view;
    const { high } = LABEL;
    const [cx, cy] = [(l + r) / 2, (t + b) / 2];
    const places = [[cx - wide / 2, t - high - 5], [cx - wide / 2, cy - high / 2], [r + 6, cy - high / 2], [cx - wide / 2, b + 5], [l - wide - 6, cy - high / 2],
      [cx - wide / 2, t + 6]];
    // At a corner a long name would seem to belong to a neighbour.
    if (r - l > wide) places.push([r + 4, t - high], [l - wide - 4, t - high], [r + 4, b], [l - wide - 4, b]);
    const boxes = places.map(([x, y]): Box => [x, y, x + wide, y + high]);
    return boxes.find(([x0, y0, x1, y1]) => x0 >= 2 && y0 >= 2 && x1 <= width - 2 && y1 <= height - 26
      && !taken.some((other) => x0 < other[2] && x1 > other[0] && y0 < other[3] && y1 > other[1])
      && !corners.some(({ x, y }) => x > x0 - 2 && x < x1 + 2 && y > y0 - 1 && y < y1 + 1));
  }

  /** A bar of a round length. */
  private scale(): SVGElement[] {
    const { scale, height } = this.view;
    const size = roundBelow(110 / scale);
    const [left, right, y] = [10, 10 + size * scale, height - 8];
    return [svg("path", { class: "scale", d: `M${left} ${y - 4}v8m0 -4H${right}m0 -4v8` }), svg("text", { class: "scale-text", x: left, y: y - 8 }, lengthText(size))];
  }

  private explain(): void {
    this.key.hidden = !(this.worst > 0);
    const bar = svg("svg", { width: 72, height: 10, "aria-hidden": "true" });
    const shade = svg("linearGradient", { id: "shade" });
    for (const [offset, name] of [["0", "quiet"], ["1", "left"]]) {
      const stop = svg("stop", { offset });
      stop.style.stopColor = `var(--${name})`;
      shade.append(stop);
    }
    bar.append(shade, svg("path", { d: "M0 4.4V5.6L72 8V2Z", fill: "url(#shade)" }));
    this.key.replaceChildren(el("span", {}, `colour and weight: ${this.figure.name},`), el("span", {}, "0", bar, this.read(this.worst)));
  }

  private place(event: MouseEvent): Corner {
    const box = this.box.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  }

  /** The contour whose wall is nearest, within reach; otherwise the smallest one around the place. */
  at({ x, y }: Corner): Entry | null {
    let best: Entry | null = null;
    let least = REACH;
    for (const { entry, walls } of this.drawn) {
      for (const line of walls) {
        for (let k = 1; k < line.length; k++) {
          const distance = apart(x, y, line[k - 1], line[k]);
          if (distance < least) [least, best] = [distance, entry];
        }
      }
    }
    if (best) return best;
    const size = ({ box: [l, t, r, b] }: Drawn) => (r - l) * (b - t);
    const around = this.drawn.filter(({ entry, walls }) => entry.closed && walls.some((line) => inside(x, y, line)));
    return around.sort((a, b) => size(a) - size(b))[0]?.entry ?? null;
  }

  private click(event: MouseEvent): void {
    if (event.ctrlKey || event.metaKey || event.shiftKey || event.altKey) return;
    // A key on a link is a click without a place.
    const link = event.detail === 0 ? this.drawn.find((drawn) => drawn.link.contains(event.target as Node)) : undefined;
    const entry = link?.entry ?? this.at(this.place(event));
    event.preventDefault();
    if (entry) this.choose(entry, false);
  }

  private hover(event: PointerEvent): void {
    const place = this.place(event);
    const entry = this.at(place);
    this.box.style.cursor = entry ? "pointer" : "";
    this.near(entry);
    if (!entry) return;
    const { lines } = entry.outcome;
    const size = entry.outcome[this.figure.key];
    const told: [string, string][] = [["contour", entry.name], ...(lines ? [["lines", `${lines[0]}–${lines[1]}`] as [string, string]] : []),
      ...(size === undefined ? [] : [[this.figure.name, this.read(size)] as [string, string]])];
    this.flag.replaceChildren(...told.flatMap(([name, value]) => [el("span", {}, name), el("b", {}, value)]));
    this.flag.classList.add("shown");
    const { offsetWidth: wide, offsetHeight: high } = this.flag;
    const x = place.x + 16 + wide > this.box.clientWidth ? Math.max(0, place.x - wide - 16) : place.x + 16;
    const y = place.y + 16 + high > this.box.clientHeight ? Math.max(0, place.y - high - 16) : place.y + 16;
    this.flag.style.transform = `translate(${x}px, ${y}px)`;
  }

  private near(entry: Entry | null): void {
    this.flag.classList.remove("shown");
    this.point(entry);
    this.hovered(entry);
  }

  private press(event: KeyboardEvent): void {
    const to = stepped(event, this.chosen, this.entries.length);
    if (to === null) return;
    event.preventDefault();
    this.choose(this.entries[to], true);
    this.drawn[to]?.link.focus();
  }
}

/** The place in a list of so many after a key, round and round; null for other keys. */
export function stepped({ key, ctrlKey, metaKey, altKey }: KeyboardEvent, from: number, count: number): number | null {
  if (ctrlKey || metaKey || altKey) return null;
  const to: Record<string, number> = {
    ArrowLeft: from - 1, ArrowUp: from - 1, ArrowRight: from + 1, ArrowDown: from + 1, Home: 0, End: count - 1,
  };
  return key in to ? (to[key] + count) % count : null;
}

/** A line in pixels, without the points that nobody can tell apart. */
function thinned(line: Line, view: View): Corner[] {
  const every = Math.max(1, Math.floor(line.x.length / SAMPLES));
  const corners: Corner[] = [];
  const last = line.x.length - 1;
  for (let i = 0; i <= last; i = i < last ? Math.min(last, i + every) : last + 1) {
    const corner = { x: view.px(line.x[i]), y: view.py(line.y[i]) };
    const before = corners[corners.length - 1];
    if (!Number.isFinite(corner.x + corner.y)) continue;
    if (!before || i === last || Math.hypot(corner.x - before.x, corner.y - before.y) >= POINT) corners.push(corner);
  }
  return corners;
}

function outlined(line: Corner[]): string {
  return line.length ? `M${line.map(({ x, y }) => `${x.toFixed(1)} ${y.toFixed(1)}`).join("L")}` : "";
}

/** Places along a line, close enough for a label not to lie between them. */
function dense(line: Corner[]): Corner[] {
  return line.flatMap((corner, k) => {
    const before = line[k - 1] ?? corner;
    const pieces = Math.max(1, Math.ceil(Math.hypot(corner.x - before.x, corner.y - before.y) / 8));
    return Array.from({ length: pieces }, (_, i) => ({ x: before.x + ((corner.x - before.x) * (i + 1)) / pieces, y: before.y + ((corner.y - before.y) * (i + 1)) / pieces }));
  });
}

function apart(x: number, y: number, a: Corner, b: Corner): number {
  const [dx, dy] = [b.x - a.x, b.y - a.y];
  const along = Math.min(1, Math.max(0, ((x - a.x) * dx + (y - a.y) * dy) / (dx * dx + dy * dy || 1)));
  return Math.hypot(a.x + along * dx - x, a.y + along * dy - y);
}

function inside(x: number, y: number, line: Corner[]): boolean {
  let within = false;
  line.forEach((b, k) => {
    const a = line[k - 1] ?? line[line.length - 1];
    if (a.y > y !== b.y > y && x < a.x + ((y - a.y) / (b.y - a.y)) * (b.x - a.x)) within = !within;
  });
  return within;
}
