/** Several contours of one program: an overview of all, and the one that is chosen with everything there is to see of it. */

import { contourView, tell, type ContourView } from "./contour";
import type { Report, Several, Told } from "./data";
import { el, table } from "./dom";
import { decimalsOf, entriesOf, figuresOf, ranking, worstFirst, type Entry, type Figure } from "./entries";
import { NO_VALUE, say, sayError, sayLength, withUnit } from "./format";
import { part, signature } from "./inspection";
import { limitsOf, limitsText } from "./limits";
import { Overview, stepped } from "./overview";
import { nextStep, ofSeveral } from "./headline";
import { figure, figures, head, inUnit, sourceOf, warnings } from "./panels";
import { onPaper, sheets } from "./printing";
import { tools } from "./theme";

/** What the address of the page has behind its #; the name of no element. */
const HASH = "#contour=";
/** Pixels of a canvas for one of the style sheet on paper; of many contours fewer. */
const SHARP = { few: 3, many: 1.5, from: 12 };
const WORDS = { pass: "pass", fail: "fail", open: "open" };

export function showSeveral(data: Several, top: HTMLElement, main: HTMLElement): void {
  new Contours(data, top, main);
}

class Contours {
  private readonly entries: Entry[];
  private readonly columns: Figure[];
  private decimals: number;
  private readonly overview: Overview;
  private readonly list = el("div", { class: "list" });
  private readonly section = el("section", { class: "contour", id: "contour" });
  /** The figure that the contours are ranked by, and the order of the table: worst first, or that of the program. */
  private rank: Figure;
  private ranked: Entry[];
  private inOrder = false;
  private chosen: Entry;
  private view: ContourView | null = null;

  constructor(private readonly data: Several, top: HTMLElement, main: HTMLElement) {
    this.entries = entriesOf(data);
    this.columns = figuresOf(data, this.entries);
    this.rank = ranking(data, this.entries);
    this.ranked = worstFirst(this.entries, this.rank);
    this.decimals = decimalsOf(this.entries);
    this.overview = new Overview(this.entries, this.rank, (size) => this.read(size), hrefOf, (entry, step) => this.go(entry, step), (entry) => this.point(entry));
    const shared = { ...this.entries[0].report, ...data } as Report;
    const [program, crc] = sourceOf(shared);
    top.append(...head(data, [program, crc, `${this.entries.length} contours`], warnings(this.warned()), tools(() => this.view?.recolour(), () => this.resay())));
    document.head.append(sheets(shared));
    const card = el("section", { class: "card overview", "aria-labelledby": "overview-title" },
      el("div", { class: "overview-head" }, el("h2", { id: "overview-title" }, `Contours of the part: ${this.entries.length}`), ...this.orders()),
      el("div", { class: "overview-body" }, this.overview.element, this.list));
    document.getElementById("keys")?.prepend("Overview: a click or the arrows choose a contour; its address in the browser leads back to it. ");
    main.append(...[...this.figures(), part(shared), card, this.section, signature(shared)].filter((node) => node !== null));
    this.overview.draw();
    this.chosen = this.named() ?? this.ranked[0];
    this.rows();
    this.show();
    if (this.named()) this.section.scrollIntoView();
    window.addEventListener("hashchange", () => this.follow());
    this.paper();
  }

  private read(size: number | undefined, unit = (text: string) => withUnit(text)): string {
    return unit(sayError(size, this.decimals));
  }

  private resay(): void {
    this.decimals = decimalsOf(this.entries);
    this.overview.rank(this.rank);
    this.rows();
    this.view?.resay();
  }

  /** The contour that the address names. */
  private named(): Entry | undefined {
    return this.entries.find((entry) => hrefOf(entry) === location.hash || HASH + entry.name === location.hash);
  }

  private go(entry: Entry, step: boolean): void {
    if (entry === this.chosen && this.named() === entry) this.reveal();
    // What is passed on the way is no place to go back to.
    else if (step) location.replace(hrefOf(entry));
    else {
      location.hash = hrefOf(entry);
      this.choose(entry);
      this.reveal();
    }
  }

  private follow(): void {
    const entry = this.named() ?? (location.hash === "" ? this.ranked[0] : undefined);
    if (entry) this.choose(entry);
  }

  private choose(entry: Entry): void {
    if (entry === this.chosen) return;
    this.chosen = entry;
    this.show();
    const size = this.size(entry);
    tell(() => [entry.name, size === undefined ? "" : `${this.rank.name} ${this.read(size)}`].filter(Boolean).join(", "));
  }

  /** Scrolls to the contour where it is not to be seen. */
  private reveal(): void {
    if (this.section.getBoundingClientRect().top > window.innerHeight * 0.75) this.section.scrollIntoView();
  }

  /** Everything of the contour chosen, made anew. */
  private show(): void {
    this.view?.close();
    this.view = null;
    const { chosen } = this;
    const pressed = document.activeElement?.closest(".contour-head button")?.getAttribute("aria-label");
    document.title = `${chosen.name} – ${this.data.title} – Truepath`;
    this.section.setAttribute("aria-label", chosen.name);
    this.section.replaceChildren(this.title(chosen, true));
    try {
      this.view = contourView(chosen.report, { names: this.entries.map(({ name }) => name), paper: false });
      this.section.append(...this.view.nodes);
      this.view.begin();
    } catch (problem) {
      this.section.append(el("p", { class: "problem", role: "alert" }, problem instanceof Error ? problem.message : String(problem)));
    }
    this.overview.mark(chosen.index);
    this.mark();
    // A button that leads on can be pressed again.
    if (pressed) this.section.querySelector<HTMLElement>(`.contour-head button[aria-label="${pressed}"]`)?.focus();
  }

  /** Name and place of a contour; on the screen with its warnings and with buttons to its neighbours. On paper the head has all warnings. */
  private title({ index, name, outcome, report }: Entry, buttons: boolean): HTMLElement {
    const { lines, z_mm: z } = outcome;
    const said = () => [`${index + 1} of ${this.entries.length}`, ...(report.program?.shown ? [say(report.program.shown)] : [lines ? linesText(lines) : "", z === undefined ? "" : `Z ${withUnit(sayLength(z))}`]),
      report.kind === "learn" ? report.title : ""].filter(Boolean).join(" · ");
    const to = (title: string, text: string, by: number) => {
      const button = el("button", { type: "button", "aria-label": title, title }, text);
      button.addEventListener("click", () => this.go(this.entries[(index + by + this.entries.length) % this.entries.length], true));
      return button;
    };
    return el("div", { class: "contour-head" },
      el("div", { class: "title" }, el("h2", {}, name), el("p", { class: "source" }, said)),
      buttons && report.warnings?.length ? warnings(report.warnings) : null,
      buttons ? el("div", { class: "buttons" }, to("The contour before", "‹", -1), to("The next contour", "›", 1)) : null);
  }

  /** The worst of all contours, and of which it is. */
  private figures(): HTMLElement[] {
    const entries = this.columns.map(({ key, name }) => {
      const size = ({ outcome }: Entry) => outcome[key] ?? -1;
      const worst = this.entries.reduce((a, b) => (size(b) > size(a) ? b : a));
      return figure(name, () => this.read(worst.outcome[key]), size(worst) > 0 ? this.link(worst) : undefined);
    });
    const lengths = this.entries.map(({ outcome }) => outcome.length_mm);
    const all = lengths.every((v) => v !== undefined) ? () => `${withUnit(sayLength(lengths.reduce((a, b) => a + b, 0), 1))} long together` : "";
    entries.unshift(figure("contours", String(this.entries.length), all));
    const tolerances = new Set(this.entries.map(({ report }) => { const limits = limitsOf(report); return limits ? limitsText(limits) : ""; }));
    const [tolerance] = tolerances;
    const limits = limitsOf(this.entries[0].report);
    if (tolerances.size === 1 && tolerance && limits) entries.unshift(figure("tolerance", () => limitsText(limits)));
    // What the contours are ranked by, then what it is held against or how many they are.
    const ranked = entries[entries.length - this.columns.length + this.columns.indexOf(this.rank)];
    const shown = [...new Set([ranked, ...entries])].slice(0, 3);
    return figures({
      told: ofSeveral(this.entries) && (() => ofSeveral(this.entries) ?? ""), verdict: this.verdict(), entries: shown, next: nextStep(this.entries[0].report),
      rest: entries.filter((entry) => !shown.includes(entry)), name: "The worst of all contours",
    });
  }

  /** The worst verdict, and whose it is. */
  private verdict(): Report["verdict"] {
    // Of a part that is not milled yet there are predictions only.
    const foretold = this.data.kind === "inspect" ? "" : "predicted: ";
    for (const state of ["fail", "open", "pass"] as const) {
      const these = this.entries.filter(({ report }) => report.verdict?.state === state);
      if (these.length === 0) continue;
      if (these.length === this.entries.length) return { state, text: `${foretold}all ${these.length} contours` };
      const names = these.slice(0, 3).map(({ name }) => name).join(", ");
      return { state, text: `${foretold}${these.length} of ${this.entries.length} contours: ${names}${these.length > 3 ? ", …" : ""}` };
    }
    return undefined;
  }

  /** Every warning once, with the contours it is of. */
  private warned(): Told[] {
    const by = new Map<string, { told: Told; names: Set<string> }>();
    for (const { name, report } of this.entries) {
      for (const told of report.warnings ?? []) {
        const key = String(told);
        by.set(key, { told, names: (by.get(key)?.names ?? new Set<string>()).add(name) });
      }
    }
    return [...by.values()].map(({ told, names }) => {
      const whose = (text: string) => `${names.size === this.entries.length ? "all contours" : [...names].join(", ")}: ${text}`;
      return typeof told === "string" ? whose(told) : [whose(told[0]), whose(told[1])];
    });
  }

  private link(entry: Entry): HTMLElement {
    const link = el("a", { href: hrefOf(entry) }, entry.name);
    link.addEventListener("click", (event) => {
      if (event.ctrlKey || event.metaKey || event.shiftKey || event.altKey) return;
      event.preventDefault();
      this.go(entry, false);
    });
    return link;
  }

  private get sorted(): Entry[] {
    return this.inOrder ? this.entries : this.ranked;
  }

  /** What the contours are ranked by, and in which order the table is. */
  private orders(): HTMLElement[] {
    const by = el("select", { id: "rank" }, ...this.columns.map(({ key, name }) => el("option", { value: key }, name)));
    by.value = this.rank.key;
    by.addEventListener("change", () => {
      this.rank = this.columns.find(({ key }) => key === by.value) ?? this.rank;
      this.ranked = worstFirst(this.entries, this.rank);
      this.overview.rank(this.rank);
      this.overview.mark(this.chosen.index);
      this.rows();
    });
    const group = el("div", { class: "segments", role: "radiogroup", "aria-label": "Order of the table" });
    for (const [id, name, inOrder] of [["worst-first", "worst first", false], ["as-cut", "as cut", true]] as const) {
      const input = el("input", { type: "radio", name: "order", id, value: id });
      input.checked = inOrder === this.inOrder;
      input.addEventListener("change", () => { this.inOrder = inOrder; this.rows(); });
      group.append(input, el("label", { for: id }, name));
    }
    return [...(this.columns.length > 1 ? [el("label", { class: "field" }, "ranked by", by)] : []), group];
  }

  private rows(): void {
    const judged = this.entries.some(({ report }) => report.verdict);
    const [worst] = this.ranked;
    const heads = ["contour", ...this.columns.map(({ head }) => inUnit(head)), ...(judged ? ["verdict"] : []), "lines", inUnit("Z"), inUnit("length"), "warnings"];
    const rows = this.sorted.map((entry) => {
      const { outcome, report, index } = entry;
      const { state } = report.verdict ?? {};
      const name = el("span", { class: "name" }, el("span", { class: "count" }, String(index + 1)),
        el("span", {}, this.link(entry), entry === worst && (this.size(worst) ?? 0) > 0 ? el("strong", { class: "worst" }, "worst") : null));
      return [name, ...this.columns.map(({ key }) => this.read(outcome[key], String)),
        ...(judged ? [state ? el("span", { class: `state ${state}` }, WORDS[state]) : NO_VALUE] : []),
        outcome.lines ? `${outcome.lines[0]}–${outcome.lines[1]}` : NO_VALUE, sayLength(outcome.z_mm), sayLength(outcome.length_mm, 1), String(report.warnings?.length ?? 0)];
    });
    const words = [0, ...(judged ? [this.columns.length + 1] : [])];
    const box = table("Contours of the part", heads, rows, words);
    this.body(box).forEach((row, k) => {
      row.addEventListener("pointerenter", () => this.overview.point(this.sorted[k]));
      row.addEventListener("pointerleave", () => this.overview.point(null));
      row.addEventListener("click", (event) => { if (!(event.target as Element).closest("a")) this.go(this.sorted[k], false); });
    });
    box.addEventListener("keydown", (event) => {
      if (!(event.target as Element).closest("a")) return;
      const to = stepped(event, this.sorted.indexOf(this.chosen), this.sorted.length);
      if (to === null) return;
      event.preventDefault();
      this.go(this.sorted[to], true);
      this.body(box)[to].querySelector("a")?.focus({ preventScroll: true });
    });
    this.list.replaceChildren(box);
    this.mark();
  }

  private size({ outcome }: Entry): number | undefined {
    return outcome[this.rank.key];
  }

  private body(of: HTMLElement = this.list): HTMLElement[] {
    return [...of.querySelectorAll<HTMLElement>("tbody tr")];
  }

  /** The row of the contour chosen, where it can be seen; its link is the one a Tab stops at. */
  private mark(): void {
    this.body().forEach((row, k) => {
      const here = this.sorted[k] === this.chosen;
      row.classList.toggle("chosen", here);
      const link = row.querySelector("a");
      link?.setAttribute("tabindex", here ? "0" : "-1");
      if (!here) {
        link?.removeAttribute("aria-current");
        return;
      }
      link?.setAttribute("aria-current", "true");
      const scroll = row.closest(".scroll") as HTMLElement;
      const head = scroll.querySelector("thead")?.offsetHeight ?? 0;
      if (row.offsetTop - head < scroll.scrollTop) scroll.scrollTop = row.offsetTop - head;
      else if (row.offsetTop + row.offsetHeight > scroll.scrollTop + scroll.clientHeight) scroll.scrollTop = row.offsetTop + row.offsetHeight - scroll.clientHeight;
    });
  }

  private point(entry: Entry | null): void {
    this.body().forEach((row, k) => row.classList.toggle("near", this.sorted[k] === entry));
  }

  /** On paper: the overview, then each contour with its figures and its picture, two or three on a sheet. */
  private paper(): void {
    let back: (() => void) | null = null;
    window.addEventListener("beforeprint", () => {
      if (back) return;
      const light = onPaper();
      this.view?.store.set({ playing: false });
      this.section.hidden = true;
      const ratio = this.entries.length > SHARP.from ? SHARP.many : SHARP.few;
      const all = this.entries.map((entry) => this.printed(entry, ratio));
      const inspected = this.data.kind === "inspect";
      const note = el("p", { class: "paper-note" }, inspected ? "The unabridged page has each contour with its job and its cuts." : "Traces, probe points and what was identified are on the page itself, contour by contour.");
      this.section.before(note);
      this.overview.draw();
      // What the lines of the pictures are is said once, by the contour that has most of them.
      const legends = all.flatMap(({ host }) => [...host.querySelectorAll(".picture:not([hidden]) .legend")]);
      const legend = legends.reduce<Element | undefined>((a, b) => (a && a.childElementCount >= b.childElementCount ? a : b), undefined);
      if (legend) all[0].host.before(legend);
      back = () => {
        legend?.remove();
        for (const { host, close } of all) {
          close();
          host.remove();
        }
        note.remove();
        this.section.hidden = false;
        light();
        this.overview.draw();
        this.view?.recolour();
      };
    });
    window.addEventListener("afterprint", () => {
      back?.();
      back = null;
    });
  }

  /** A contour as it is printed, put on the page. */
  private printed(entry: Entry, ratio: number): { host: HTMLElement; close: () => void } {
    const host = el("section", { class: "contour sheet", "aria-label": entry.name }, this.title(entry, false));
    this.section.before(host);
    try {
      const view = contourView(entry.report, { names: this.entries.map(({ name }) => name), paper: true });
      host.append(...view.nodes);
      view.begin();
      if (view.several) view.store.set({ shown: "both" });
      view.stage.layout(ratio);
      return { host, close: view.close };
    } catch (problem) {
      host.append(el("p", { class: "problem" }, problem instanceof Error ? problem.message : String(problem)));
      return { host, close: () => undefined };
    }
  }
}

function hrefOf({ name }: Entry): string {
  return HASH + encodeURIComponent(name);
}

function linesText([first, last]: [number, number]): string {
  return first === last ? `line ${first}` : `lines ${first}–${last}`;
}
