/** Elements in one call. */

/** A text that holds a length is a function: its node says it again in another unit. */
export type Said = string | (() => string);
type Child = Node | Said | null | undefined;

function text(said: Said): string | Node {
  if (typeof said === "string") return said;
  return Object.assign(document.createTextNode(said()), { said });
}

/** Says every length on the page anew. */
export function sayAgain(): void {
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node; (node = walker.nextNode() as (Text & { said?: () => string }) | null);) if (node.said) node.data = node.said();
}

export function el<K extends keyof HTMLElementTagNameMap>(tag: K, attributes: Record<string, string> = {}, ...children: Child[]): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  for (const child of children) if (child !== null && child !== undefined) element.append(child instanceof Node ? child : text(child));
  return element;
}

/** A titled block of the page; its heading names it. */
export function card(id: string, title: string, ...children: Child[]): HTMLElement {
  return el("section", { class: "card", id, "aria-labelledby": `${id}-title` }, el("h2", { id: `${id}-title` }, title), ...children);
}

/** A table that scrolls within itself on a narrow screen; `text` are the columns of words. */
export function table(name: string, heads: Said[], rows: Child[][], text: number[] = [0]): HTMLElement {
  const kind = (i: number) => (text.includes(i) ? "text" : "number");
  const head = el("tr", {}, ...heads.map((title, i) => el("th", { scope: "col", class: kind(i) }, title)));
  const body = rows.map((row) => el("tr", {}, ...row.map((cell, i) => (
    i === 0 ? el("th", { scope: "row", class: kind(i) }, cell) : el("td", { class: kind(i) }, cell)))));
  const element = el("table", {}, el("thead", {}, head), el("tbody", {}, ...body));
  return el("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": name }, element);
}

/** An element of a drawing. */
export function svg(tag: string, attributes: Record<string, string | number>, text?: string): SVGElement {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
  if (text !== undefined) element.textContent = text;
  return element;
}
