/** The figures at one sample of the contour: the table beside the scene and the flag at the pointer. */

import { el } from "./dom";
import { decimalsOf, fixed, NO_VALUE, per, sayDeviation, sayLength, sigmaText, signed, unitOf, withUnit } from "./format";
import type { Series } from "./decode";
import type { Model, Pass, PassName, Quantity } from "./model";

const ROWS: [Quantity, string, string][] = [
  ["error_mm", "wall error", "mm"], ["sigma_mm", "σ of it", "mm"], ["arc_deg", "engagement arc", "°"], ["chip_area_mm2", "chip area", "mm²"],
  ["force_n", "force", "N"], ["fx_n", "force x", "N"], ["fy_n", "force y", "N"], ["dx_mm", "deflection x", "mm"],
  ["dy_mm", "deflection y", "mm"], ["feed_mm_per_min", "feed", "mm/min"],
];

/** What has no sign. */
const SIZES = /^(arc|chip|force|feed)/;

function said(quantity: Quantity, { values, decimals }: Series, index: number): string {
  if (quantity === "sigma_mm") return sigmaText(values[index]);
  const [, , unit] = ROWS.find(([name]) => name === quantity) as (typeof ROWS)[0];
  return (SIZES.test(quantity) ? fixed : signed)(values[index] / per(unit), decimalsOf(unit, decimals));
}

export class Readout {
  readonly element: HTMLElement;
  private readonly place: HTMLElement;
  private readonly heads: HTMLElement[];
  private readonly title = el("h2", { id: "readout-title" }, "At the cutter");
  private readonly cells: [Quantity | "cx" | "cy", HTMLTableCellElement[]][] = [];

  constructor(private readonly model: Model) {
    const { passes } = model;
    // Three columns of figures leave no room for one of units.
    const narrow = passes.length > 2;
    const body = el("tbody");
    const add = (key: Quantity | "cx" | "cy", title: string, unit: string, count: number) => {
      const cells = Array.from({ length: count }, () => el("td", { class: "number" }));
      if (count < passes.length) cells[0].colSpan = passes.length;
      body.append(el("tr", {}, el("th", { scope: "row", class: "text" }, title, narrow ? el("span", { class: "unit" }, () => ` ${unitOf(unit)}`) : null), ...cells,
        narrow ? null : el("td", { class: "text unit" }, () => unitOf(unit))));
      this.cells.push([key, cells]);
    };
    for (const [quantity, title, unit] of ROWS) {
      if (passes.some((pass) => pass.series[quantity])) add(quantity, title, unit, passes.length);
    }
    // One correction belongs to the page as a whole; of several each stands below its pass.
    const own = passes.filter((pass) => pass.correction).length > 1 ? passes.length : 1;
    if (model.correction) {
      add("cx", "correction x", "mm", own);
      add("cy", "correction y", "mm", own);
    }
    this.place = el("p", { class: "at" });
    this.heads = passes.map((pass) => el("th", { scope: "col", class: "number" }, passes.length > 1 ? pass.title : "value"));
    const heads = [el("th", { scope: "col", class: "text" }, "quantity"), ...this.heads,
      ...(narrow ? [] : [el("th", { scope: "col", class: "text" }, "unit")])];
    this.element = el("section", { class: narrow ? "card narrow" : "card", id: "readout", "aria-labelledby": "readout-title" },
      this.title, this.place,
      el("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "Figures at the cutter" }, el("table", {}, el("thead", {}, el("tr", {}, ...heads)), body)));
  }

  /** Leaves the columns of the passes that are to be seen, and no correction where none of them has one. */
  only(names: PassName[]): void {
    const { passes } = this.model;
    const seen = passes.map((pass) => names.includes(pass.name));
    this.heads.forEach((head, k) => { head.hidden = !seen[k]; });
    for (const [key, cells] of this.cells) {
      const corrects = passes.map((pass, k) => seen[k] && (pass.correction !== undefined || passes.length === 1));
      if (key === "cx" || key === "cy") (cells[0].parentElement as HTMLElement).hidden = !corrects.includes(true);
      if (cells.length === passes.length) cells.forEach((cell, k) => { cell.hidden = !seen[k]; });
      else cells[0].colSpan = Math.max(1, seen.filter(Boolean).length);
    }
  }

  show(index: number, hovered = false): void {
    const { model } = this;
    const title = hovered ? "At the pointer" : "At the cutter";
    if (this.title.textContent !== title) this.title.textContent = title;
    this.place.textContent = placeText(model, index);
    for (const [key, cells] of this.cells) {
      if (key === "cx" || key === "cy") {
        cells.forEach((cell, k) => {
          const correction = cells.length > 1 ? model.passes[k].correction : model.correction;
          const series = key === "cx" ? correction?.x : correction?.y;
          cell.textContent = sayDeviation(series?.values[index]);
        });
        continue;
      }
      model.passes.forEach((pass, k) => {
        const series = pass.series[key];
        cells[k].textContent = series ? said(key, series, index) : NO_VALUE;
      });
    }
  }
}

export function placeText(model: Model, index: number): string {
  return ([["s", model.s], ["X", model.x], ["Y", model.y]] as const).map(([name, { values }]) => `${name} ${withUnit(sayLength(values[index]))}`).join(", ");
}

/** Lines of the flag, of the passes shown: name, value with unit. */
export function flagLines(model: Model, shown: Pass[], index: number, height: number | null): [string, string][] {
  const lines: [string, string][] = [
    ["s", withUnit(sayLength(model.s.values[index]))],
    ["X, Y", withUnit(`${sayLength(model.x.values[index])}, ${sayLength(model.y.values[index])}`)],
  ];
  for (const pass of shown) {
    const error = model.error(pass.name, height);
    if (error) lines.push([model.of("error", pass), Number.isNaN(error[index]) ? NO_VALUE : withUnit(sayDeviation(error[index]))]);
    const { sigma_mm: sigma, force_n: force, arc_deg: arc } = pass.series;
    if (sigma) lines.push(["± σ", withUnit(sigmaText(sigma.values[index]))]);
    if (force) lines.push([model.of("force", pass), `${fixed(force.values[index], 1)} N`]);
    if (arc && pass === shown[0]) lines.push(["arc", `${fixed(arc.values[index], 1)}°`]);
  }
  const corrected = shown.filter((pass) => pass.correction);
  const several = model.passes.filter((pass) => pass.correction).length > 1;
  const corrections = corrected.map((pass) => [several ? `correction, ${pass.title}` : "correction x, y", pass.correction] as const);
  for (const [name, correction] of corrections) {
    if (!correction) continue;
    const { x, y } = correction;
    lines.push([name, withUnit(`${sayDeviation(x.values[index])}, ${sayDeviation(y.values[index])}`)]);
  }
  return lines;
}
