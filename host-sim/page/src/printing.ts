/** Paper: light colours, the whole part, both passes, the cutter where it stands, a head and a number on every sheet; and back. */

import type { ContourView } from "./contour";
import type { Report } from "./data";
import { el } from "./dom";
import type { Stage } from "./stage";
import type { Shown } from "./state";

/** A text as CSS writes it: whatever is no letter or digit as its number. */
function quoted(text: string): string {
  return `"${[...text].map((c) => (/[\p{L}\p{N} ]/u.test(c) ? c : `\\${(c.codePointAt(0) as number).toString(16)} `)).join("")}"`;
}

/** What stands on the margin of every sheet. */
export function sheets(report: Report): HTMLStyleElement {
  const { name, serial, drawing } = report.part ?? {};
  const part = [name ?? (serial || drawing ? "" : report.title), drawing && `drawing ${drawing}`, serial && `serial ${serial}`].filter(Boolean).join(" · ");
  const program = report.program ? [report.program.name, report.program.crc32 && `CRC-32 ${report.program.crc32}`].filter(Boolean).join(" · ") : "";
  const box = (place: string, content: string) => `@${place} { content: ${content}; }`;
  return el("style", {}, `@page { ${box("top-left", quoted(part))} ${box("bottom-left", quoted([report.by, program].filter(Boolean).join(" · ")))}`
    + ` ${box("bottom-right", '"sheet " counter(page) " of " counter(pages)')} }`);
}

/** Room on a sheet between its margins, of A4 and Letter the smaller, in pixels of the style sheet. */
const SHEET = 940;
/** Height of a trace on paper with its head: enough for three numbers on its axis. */
const TRACE = 92;
/** Height of a picture there. */
const PICTURE = { least: 220, most: 560 };

/** Pictures as high as the first sheet has room for, below head and figures and with what belongs to them. */
function pictureHeight(stage: Stage): number {
  const high = (element: Element | null | undefined) => element?.getBoundingClientRect().height ?? 0;
  const picture = stage.element.closest(".picture");
  const all = [...stage.element.querySelectorAll(".stage")].map(high).filter((height) => height > 0);
  if (!picture || all.length === 0) return PICTURE.most;
  const above = picture.getBoundingClientRect().top - document.body.getBoundingClientRect().top;
  const room = SHEET - above - (high(picture) - all.reduce((a, b) => a + b)) - high(document.querySelector(".beside #statements"));
  return Math.max(PICTURE.least, Math.min(PICTURE.most, Math.floor(room / all.length)));
}

/** Paper is light and shows every warning; what is returned makes the page again what it was. */
export function onPaper(): () => void {
  const root = document.documentElement;
  const { theme } = root.dataset;
  const opened = [...document.querySelectorAll<HTMLDetailsElement>("details:is(.warnings, .all):not([open])")];
  root.dataset.theme = "light";
  root.dataset.printing = "yes";
  for (const details of opened) details.open = true;
  return () => {
    delete root.dataset.printing;
    if (theme) root.dataset.theme = theme;
    else delete root.dataset.theme;
    for (const details of opened) details.open = false;
  };
}

/** The page of one contour. */
export function printing(report: Report, { stage, store, traces, recolour, several }: ContourView): void {
  const root = document.documentElement;
  document.head.append(sheets(report));
  let kept: { back: () => void; shown: Shown; range: [number, number] | null; view: () => void } | null = null;
  window.addEventListener("beforeprint", () => {
    kept = { back: onPaper(), shown: store.state.shown, range: store.state.range, view: stage.view.remember() };
    store.set({ playing: false, range: null, ...(several ? { shown: "both" } : {}) });
    stage.view.fit();
    root.style.setProperty("--paper-stage", `${pictureHeight(stage)}px`);
    stage.layout(3);
    recolour();
    traces?.resize(TRACE - 20);
    traces?.place(store.state.place);
    stage.layout(3);
  });
  window.addEventListener("afterprint", () => {
    if (!kept) return;
    kept.back();
    root.style.removeProperty("--paper-stage");
    store.set({ shown: kept.shown, range: kept.range });
    stage.layout();
    kept.view();
    recolour();
    kept = null;
  });
}
