/** One scene: a still and a moving canvas, and what pointer and keyboard do with them. */

import { drawMoving } from "./cutter";
import { drawStill, type Picture } from "./draw";
import type { Palette } from "./palette";
import type { View } from "./view";

export interface SceneEvents {
  /** The view has changed. */
  view(): void;
  hover(scene: Scene, px: number, py: number): void;
  leave(): void;
  /** A place was clicked. */
  pick(px: number, py: number): void;
  /** Samples to step the cutter by; NaN: to the start, Infinity: to the end. */
  step(samples: number): void;
  toggle(): void;
}

/** Two scenes share one view and may differ by a pixel in size: so many more are cleared. */
const BESIDE = 2;

export class Scene {
  readonly element: HTMLElement;
  readonly caption: HTMLElement;
  readonly still = document.createElement("canvas");
  private readonly moving = document.createElement("canvas");
  readonly stage = document.createElement("div");
  private readonly frame = document.createElement("div");
  private readonly fingers = new Map<number, { x: number; y: number }>();
  private ratio = 1;
  private paper = false;

  constructor(readonly view: View, private readonly events: SceneEvents, name: string) {
    this.element = document.createElement("figure");
    this.element.className = "scene";
    this.caption = document.createElement("figcaption");
    this.stage.className = "stage";
    this.stage.tabIndex = 0;
    this.stage.setAttribute("role", "application");
    this.stage.setAttribute("aria-label", name);
    this.stage.setAttribute("aria-describedby", "keys");
    this.still.setAttribute("aria-hidden", "true");
    this.moving.setAttribute("aria-hidden", "true");
    this.frame.className = "frame";
    this.frame.hidden = true;
    this.stage.append(this.still, this.moving, this.frame);
    this.element.append(this.caption, this.stage);
    this.listen();
  }

  /** Matches the canvases to their place on the page; a given ratio is for paper. */
  measure(paper?: number): void {
    const { clientWidth, clientHeight } = this.stage;
    const ratio = paper ?? (window.devicePixelRatio || 1);
    this.ratio = ratio;
    this.paper = paper !== undefined;
    for (const canvas of [this.still, this.moving]) {
      canvas.width = Math.max(1, Math.round(clientWidth * ratio));
      canvas.height = Math.max(1, Math.round(clientHeight * ratio));
    }
    this.view.resize(clientWidth, clientHeight);
  }

  drawStill(picture: Picture, colours: Palette): void {
    const context = this.context(this.still);
    context.fillStyle = colours.ground;
    context.fillRect(0, 0, this.view.width + BESIDE, this.view.height + BESIDE);
    drawStill(context, this.view, picture, colours);
    // On a screen that is touched the page scrolls over a picture that is seen whole; a part of it moves under the finger.
    this.stage.style.touchAction = this.view.fitted ? "pan-y" : "none";
    this.stage.dataset.view = [this.view.cx, this.view.cy, this.view.scale].join(" ");
  }

  drawMoving(picture: Picture, colours: Palette, place: number, largestForce: number, hovered: number | null): void {
    // On paper canvases are replayed as strokes, and clearing one would take away what lies below it.
    const context = this.context(this.paper ? this.still : this.moving);
    if (!this.paper) context.clearRect(0, 0, this.view.width + BESIDE, this.view.height + BESIDE);
    drawMoving(context, this.view, picture, colours, place, largestForce, hovered);
  }

  private context(canvas: HTMLCanvasElement): CanvasRenderingContext2D {
    const context = canvas.getContext("2d");
    if (!context) throw new Error("this browser cannot draw");
    context.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    return context;
  }

  private at(event: PointerEvent | WheelEvent): { x: number; y: number } {
    const box = this.stage.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  }

  private listen(): void {
    const { stage, view, events } = this;
    let start: { x: number; y: number; shift: boolean } | null = null;
    let dragged = false;
    let back = () => {};
    stage.addEventListener("wheel", (event) => {
      // A wheel that passes by scrolls the page; a pinch of a touchpad comes with Ctrl.
      if (!event.ctrlKey && !event.metaKey && document.activeElement !== stage) return;
      event.preventDefault();
      const { x, y } = this.at(event);
      const lines = event.deltaMode === 1 ? 30 : 1;
      view.zoom(Math.exp(-Math.max(-300, Math.min(300, event.deltaY * lines)) * 0.0018), x, y);
      events.view();
    }, { passive: false });
    stage.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      stage.setPointerCapture(event.pointerId);
      this.fingers.set(event.pointerId, this.at(event));
      start = { ...this.at(event), shift: event.shiftKey };
      dragged = this.fingers.size > 1;
      if (!dragged) back = view.remember();
      events.leave();
    });
    stage.addEventListener("pointermove", (event) => {
      const now = this.at(event);
      const before = this.fingers.get(event.pointerId);
      if (!before) {
        events.hover(this, now.x, now.y);
        return;
      }
      if (start && Math.hypot(now.x - start.x, now.y - start.y) > 4) dragged = true;
      if (!dragged) return;
      if (start?.shift) {
        this.showFrame(start, now);
        return;
      }
      const other = [...this.fingers].find(([id]) => id !== event.pointerId)?.[1];
      if (other) {
        const was = Math.hypot(before.x - other.x, before.y - other.y);
        const is = Math.hypot(now.x - other.x, now.y - other.y);
        view.pan((now.x - before.x) / 2, (now.y - before.y) / 2);
        if (was > 0 && is > 0) view.zoom(is / was, (now.x + other.x) / 2, (now.y + other.y) / 2);
      } else {
        view.pan(now.x - before.x, now.y - before.y);
      }
      this.fingers.set(event.pointerId, now);
      events.view();
    });
    const release = (event: PointerEvent) => {
      if (!this.fingers.delete(event.pointerId)) return;
      const now = this.at(event);
      if (event.type === "pointerup" && !dragged) {
        events.pick(now.x, now.y);
        if (event.pointerType === "touch") events.hover(this, now.x, now.y);
      }
      if (event.type === "pointerup" && dragged && start?.shift) this.zoomToFrame(start, now);
      // The browser has taken the finger to scroll the page: what it moved here before that is taken back.
      if (event.type === "pointercancel") {
        back();
        events.view();
      }
      this.frame.hidden = true;
      start = null;
    };
    stage.addEventListener("pointerup", release);
    stage.addEventListener("pointercancel", release);
    // A finger that is lifted leaves the figures it asked for.
    stage.addEventListener("pointerleave", (event) => { if (event.pointerType !== "touch") events.leave(); });
    stage.addEventListener("dblclick", () => {
      view.fit();
      events.view();
    });
    stage.addEventListener("keydown", (event) => this.key(event));
  }

  private showFrame(a: { x: number; y: number }, b: { x: number; y: number }): void {
    this.frame.hidden = false;
    this.frame.style.left = `${Math.min(a.x, b.x)}px`;
    this.frame.style.top = `${Math.min(a.y, b.y)}px`;
    this.frame.style.width = `${Math.abs(a.x - b.x)}px`;
    this.frame.style.height = `${Math.abs(a.y - b.y)}px`;
  }

  private zoomToFrame(a: { x: number; y: number }, b: { x: number; y: number }): void {
    if (Math.abs(a.x - b.x) < 6 || Math.abs(a.y - b.y) < 6) return;
    const { view } = this;
    view.show({
      x0: view.mmX(Math.min(a.x, b.x)), x1: view.mmX(Math.max(a.x, b.x)),
      y0: view.mmY(Math.max(a.y, b.y)), y1: view.mmY(Math.min(a.y, b.y)),
    });
    this.events.view();
  }

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const { view, events } = this;
    const far = event.shiftKey ? 10 : 1;
    const moves: Record<string, () => void> = {
      "+": () => view.zoom(1.25), "=": () => view.zoom(1.25), "-": () => view.zoom(0.8), "_": () => view.zoom(0.8),
      "0": () => view.fit(),
      ArrowLeft: () => view.pan(60, 0), ArrowRight: () => view.pan(-60, 0),
      ArrowUp: () => view.pan(0, 60), ArrowDown: () => view.pan(0, -60),
    };
    const steps: Record<string, number> = { ",": -far, ".": far, "<": -10, ">": 10, Home: NaN, End: Infinity };
    // With Shift the same two keys write other signs on other keyboards.
    const written: Record<string, string> = event.shiftKey ? { Comma: ",", Period: "." } : {};
    const step = event.key in steps ? event.key : written[event.code];
    if (moves[event.key]) {
      moves[event.key]();
      events.view();
    } else if (step) {
      events.step(steps[step]);
    } else if (event.key === " ") {
      events.toggle();
    } else {
      return;
    }
    event.preventDefault();
  }
}
