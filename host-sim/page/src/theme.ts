/** Light and dark: as the system says, until the reader chooses. */

import { el, sayAgain } from "./dom";
import { sayInches, saysInches } from "./format";

export type Theme = "light" | "dark";

export function current(): Theme {
  const chosen = document.documentElement.dataset.theme;
  if (chosen === "light" || chosen === "dark") return chosen;
  return matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
}

/** The button that switches them. */
export function themeButton(changed: () => void): HTMLElement {
  const button = el("button", { type: "button", id: "theme" });
  const show = () => { button.textContent = current() === "dark" ? "light" : "dark"; button.setAttribute("aria-label", `Switch to ${button.textContent} colours`); };
  button.addEventListener("click", () => {
    document.documentElement.dataset.theme = current() === "dark" ? "light" : "dark";
    show();
    changed();
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { show(); changed(); });
  show();
  return button;
}

/** The button that switches between millimetres and inches. */
function unitButton(changed: () => void): HTMLElement {
  const button = el("button", { type: "button", id: "unit" });
  const show = () => { button.textContent = saysInches() ? "mm" : "inches"; button.setAttribute("aria-label", `Say lengths in ${button.textContent}`); };
  button.addEventListener("click", () => {
    sayInches(!saysInches());
    show();
    changed();
    sayAgain();
  });
  show();
  return button;
}

/** The buttons of the page: inches or millimetres, light or dark, print. */
export function tools(recolour: () => void, resay: () => void): HTMLElement {
  const print = el("button", { type: "button" }, "print");
  print.addEventListener("click", () => window.print());
  return el("div", { class: "buttons tools" }, unitButton(resay), themeButton(recolour), print);
}
