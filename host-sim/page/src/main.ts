/** Puts the page together from the data in it. */

import { checked, contourView } from "./contour";
import type { Report } from "./data";
import { readReport } from "./decode";
import { el } from "./dom";
import { sayInches } from "./format";
import { palette } from "./palette";
import { head, sourceOf, warnings } from "./panels";
import { printing } from "./printing";
import { showSeveral } from "./several";
import { tools } from "./theme";

function start(): void {
  const main = document.getElementById("main") as HTMLElement;
  const top = document.getElementById("top") as HTMLElement;
  try {
    const report = readReport(document.getElementById("truepath-data"));
    document.title = `${report.title} – Truepath`;
    sayInches(("contours" in report ? report.contours[0].page : report).unit === "in");
    if ("contours" in report) showSeveral(report, top, main);
    else showOne(checked(report), top, main);
  } catch (problem) {
    main.append(el("p", { class: "problem", role: "alert" }, problem instanceof Error ? problem.message : String(problem)));
    top.append(el("h1", {}, "Truepath report"));
  }
  document.documentElement.dataset.firstPicture = performance.now().toFixed(0);
}

function showOne(report: Report, top: HTMLElement, main: HTMLElement): void {
  const view = contourView(report);
  top.append(...head(report, sourceOf(report), warnings(report.warnings ?? []), tools(view.recolour, view.resay)));
  main.append(...view.nodes);
  view.begin();
  printing(report, view);
}

/** Letters on a canvas are drawn once: the font of the page comes first. Without it a font of the system does. */
function lettered(): Promise<unknown> {
  return Promise.allSettled([400, 600].map((weight) => document.fonts.load(`${weight} 13px ${palette().font}`)));
}

lettered().then(start);
