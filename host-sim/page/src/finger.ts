/** A finger across a trace frames a stretch, as the mouse does; up and down it scrolls the page. */

import type uPlot from "uplot";

/** Pixels from which a touch is a stretch and no tap. */
const LEAST = 12;

export function framedByFinger(plot: uPlot, framed: (range: [number, number]) => void): void {
  const { over } = plot;
  over.style.touchAction = "pan-y";
  let from: number | null = null;
  const at = (event: PointerEvent) => Math.min(over.clientWidth, Math.max(0, event.clientX - over.getBoundingClientRect().left));
  const select = (a: number, b: number) => plot.setSelect({ left: Math.min(a, b), top: 0, width: Math.abs(b - a), height: over.clientHeight }, false);
  over.addEventListener("pointerdown", (event) => { from = event.pointerType === "touch" && event.isPrimary ? at(event) : null; });
  over.addEventListener("pointermove", (event) => {
    if (from !== null && event.isPrimary && Math.abs(at(event) - from) > LEAST) select(from, at(event));
  });
  const end = (event: PointerEvent) => {
    if (from === null || !event.isPrimary) return;
    const to = at(event);
    if (event.type === "pointerup" && Math.abs(to - from) > LEAST) {
      framed([plot.posToVal(Math.min(from, to), "x"), plot.posToVal(Math.max(from, to), "x")]);
    }
    from = null;
    select(0, 0);
  };
  over.addEventListener("pointerup", end);
  over.addEventListener("pointercancel", end);
}
