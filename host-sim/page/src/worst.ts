/** The worst places of the pass shown, as buttons that show them in the picture. */

import { el } from "./dom";
import { sayDeviation, sayLength, withUnit } from "./format";
import { limitsOf } from "./limits";
import type { Model } from "./model";
import { worstPlaces, type Place } from "./places";
import type { Store } from "./state";

/** Places that are named at most. */
const MOST = 5;

export function worstList(model: Model, store: Store, go: (place: Place) => void): HTMLElement {
  const limits = limitsOf(model.report);
  const title = el("p", { class: "worst-title" });
  const list = el("ol", {});
  const element = el("div", { class: "worst-places" }, title, list);
  const follow = () => {
    const { shown } = store.state;
    const pass = shown === "both" ? model.compared[model.compared.length - 1] : model.pass(shown);
    const places = pass ? worstPlaces(model, pass, limits, MOST) : [];
    element.hidden = places.length === 0;
    title.textContent = `Worst places${pass && model.passes.length > 1 ? `, ${pass.title}` : ""}`;
    list.replaceChildren(...places.map((place) => {
      const { index, height, error } = place;
      const z = height === null ? "" : `, ${withUnit(sayLength(model.report.heights?.z_mm[height], 1))} above the tip`;
      const button = el("button", { type: "button" }, el("b", {}, withUnit(sayDeviation(error))), ` ${error > 0 ? "left" : "too deep"}, s ${withUnit(sayLength(model.s.values[index], 1))}${z}`);
      button.addEventListener("click", () => go(place));
      return el("li", {}, button);
    }));
  };
  store.onChange((changed) => { if (changed.has("shown")) follow(); });
  follow();
  return element;
}
