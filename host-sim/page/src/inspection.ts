/** What a customer reads beside figures and points: which part, from which files, by which rule; and who signs for it. */

import type { Report } from "./data";
import { card, el } from "./dom";
import { say } from "./format";

export function part(report: Report): HTMLElement | null {
  const { name, drawing, serial, material_batch: batch, customer, date } = report.part ?? {};
  const rows: [string, string | undefined][] = [
    ["part", name], ["drawing", drawing], ["serial number", serial], ["material batch", batch], ["customer", customer], ["measured", date],
    ...(report.files ?? []).map((f): [string, string] => [f.what, `${f.name} · CRC-32 ${f.crc32}`]),
  ];
  // A key that the job does not give comes as null.
  const known = rows.filter((row): row is [string, string] => typeof row[1] === "string");
  if (known.length === 0) return null;
  return card("part", "Part", el("dl", { class: "facts" }, ...known.flatMap(([term, value]) => [el("dt", {}, term), el("dd", {}, value)])));
}

export function statements(report: Report): HTMLElement | null {
  const list = report.statements ?? [];
  if (list.length === 0) return null;
  return card("statements", "What the verdict rests on", el("ul", {}, ...list.map((text) => el("li", {}, () => say(text)))));
}

/** Lines to write on; on paper only. */
export function signature(report: Report): HTMLElement | null {
  if (report.kind !== "inspect") return null;
  const line = (name: string) => el("div", { class: "line" }, el("span", {}, name));
  return el("section", { class: "signature", "aria-label": "Signature" }, line("inspected by"), line("date"), line("signature"));
}
