/** Paper: light colours, the whole part, both passes, the cutter where it stands; and back. */

import type { Stage } from "./stage";
import type { Shown, Store } from "./state";
import type { Traces } from "./traces";

export function printing(stage: Stage, store: Store, traces: Traces | null, recolour: () => void, both: boolean): void {
  const root = document.documentElement;
  let kept: { theme: string | undefined; shown: Shown; range: [number, number] | null; cx: number; cy: number; scale: number } | null = null;
  window.addEventListener("beforeprint", () => {
    const { cx, cy, scale } = stage.view;
    kept = { theme: root.dataset.theme, shown: store.state.shown, range: store.state.range, cx, cy, scale };
    root.dataset.theme = "light";
    root.dataset.printing = "yes";
    store.set({ playing: false, range: null, ...(both ? { shown: "both" } : {}) });
    for (const details of document.querySelectorAll<HTMLDetailsElement>("details.warnings")) details.open = true;
    stage.view.fit();
    stage.layout(3);
    recolour();
    traces?.resize(Math.floor(440 / Math.max(5, traces.count)) - 20);
    stage.layout(3);
  });
  window.addEventListener("afterprint", () => {
    if (!kept) return;
    delete root.dataset.printing;
    if (kept.theme) root.dataset.theme = kept.theme;
    else delete root.dataset.theme;
    store.set({ shown: kept.shown, range: kept.range });
    stage.layout();
    Object.assign(stage.view, { cx: kept.cx, cy: kept.cy, scale: kept.scale });
    recolour();
    kept = null;
  });
}
