/** The bars: what is shown, how large, at which height; and the transport of the cutter. */

import { el, type Said } from "./dom";
import { fixed, sayLength, withUnit } from "./format";
import type { Model } from "./model";
import type { Player } from "./player";
import type { PassName } from "./model";
import type { Shown, State, Store } from "./state";
import { placeText } from "./readout";

const FACTORS = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000];
const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10];

/** The factor that draws an error of this size about 6 % as large as the part. */
export function fittingFactor(largest: number, size: number): number {
  if (!(largest > 0)) return 100;
  const wanted = (0.06 * size) / largest;
  return [...FACTORS].reverse().find((f) => f <= wanted) ?? 1;
}

export interface SceneActions { zoomIn(): void; zoomOut(): void; whole(): void; fragment(): void }

/** A layer with the signs that belong to it: class of the key, name, the pass it is of where it is not of all. */
export interface Layer { id: string; keys: [string, Said, PassName?][] }

export function sceneBar(model: Model | null, store: Store, actions: SceneActions): HTMLElement {
  const bar = el("div", { class: "bar", role: "group", "aria-label": "Picture" });
  if (model && model.passes.length > 1) bar.append(segments(model, store));
  bar.append(factorField(store, "magnify"));
  const heights = model?.report.heights;
  if (heights && heights.z_mm.length > 0) bar.append(heightSlider(heights.z_mm, store));
  const zoom = el("div", { class: "buttons" });
  const fragment = el("button", { type: "button", title: "Show in the picture what the traces show" }, "fragment");
  fragment.hidden = true;
  fragment.addEventListener("click", actions.fragment);
  store.onChange((changed) => { if (changed.has("range")) fragment.hidden = store.state.range === null; });
  zoom.append(fragment);
  for (const [text, name, run] of [["+", "Zoom in", actions.zoomIn], ["−", "Zoom out", actions.zoomOut], ["whole", "Show everything", actions.whole]] as const) {
    const button = el("button", { type: "button", ...(text === "whole" ? {} : { "aria-label": name }), title: name }, text);
    button.addEventListener("click", run);
    zoom.append(button);
  }
  bar.append(zoom);
  return bar;
}

/** How many times as large errors are drawn. */
export function factorField(store: Store, id: string): HTMLElement {
  const factor = el("select", { id }, ...FACTORS.map((f) => el("option", { value: String(f) }, `${f} ×`)));
  factor.value = String(store.state.magnify);
  factor.addEventListener("change", () => store.set({ magnify: Number(factor.value) }));
  store.onChange((changed) => { if (changed.has("magnify")) factor.value = String(store.state.magnify); });
  return el("label", { class: "field" }, "error drawn", factor);
}

/** What the lines and colours are; each can be hidden. */
export function legend(store: Store, layers: Layer[], seen: () => PassName[]): HTMLElement {
  const list = el("div", { class: "legend", role: "group", "aria-label": "Layers of the picture" });
  for (const { id, keys } of layers) {
    const box = el("input", { type: "checkbox", id: `layer-${id}` });
    box.checked = !store.state.hidden.has(id);
    box.addEventListener("change", () => {
      const hidden = new Set(store.state.hidden);
      if (box.checked) hidden.delete(id);
      else hidden.add(id);
      store.set({ hidden });
    });
    const signs = keys.map(([key, name, pass]) => ({ pass, nodes: [el("i", { class: `key ${key}` }), el("span", {}, name)] }));
    const label = el("label", {}, box, ...signs.flatMap(({ nodes }) => nodes));
    // Of a pass that is not shown there is no sign.
    const follow = () => {
      const here = signs.filter(({ pass, nodes }) => {
        const shown = pass === undefined || seen().includes(pass);
        for (const node of nodes) node.hidden = !shown;
        return shown;
      });
      label.hidden = here.length === 0;
    };
    store.onChange((changed) => { if (changed.has("shown")) follow(); });
    follow();
    list.append(label);
  }
  return list;
}

function segments(model: Model, store: Store): HTMLElement {
  const group = el("div", { class: "segments", role: "radiogroup", "aria-label": "Pass shown" });
  for (const [value, name] of [...model.passes.map((pass) => [pass.name, pass.title]), ["both", "side by side"]] as [Shown, string][]) {
    const input = el("input", { type: "radio", name: "shown", id: `shown-${value}`, value });
    input.checked = store.state.shown === value;
    input.addEventListener("change", () => store.set({ shown: value }));
    store.onChange(() => { input.checked = store.state.shown === value; });
    group.append(input, el("label", { for: `shown-${value}` }, name));
  }
  return group;
}

function heightSlider(z: number[], store: Store): HTMLElement {
  const input = el("input", { type: "range", id: "height", min: "0", max: String(z.length), step: "1", value: "0" });
  const output = el("output", { for: "height" });
  const show = () => {
    const { height } = store.state;
    const text = height === null ? "mean" : withUnit(sayLength(z[height], 2));
    output.textContent = text;
    input.setAttribute("aria-valuetext", height === null ? "mean over the height" : `${text} above the tip`);
    input.value = String(height === null ? 0 : height + 1);
  };
  input.addEventListener("input", () => store.set({ height: input.value === "0" ? null : Number(input.value) - 1 }));
  store.onChange((changed) => { if (changed.has("height")) show(); });
  show();
  return el("label", { class: "field" }, "height", input, output);
}

/** The sample with the largest wall error at the height shown, of the pass shown; side by side of the one after. Null without any. */
function largestError(model: Model, { shown, height }: State): number | null {
  const name = shown === "both" ? "after" : shown;
  const errors = model.error(name, height);
  let best: number | null = null;
  errors?.forEach((error, i) => { if (Math.abs(error) > (best === null ? -1 : Math.abs(errors[best]))) best = i; });
  return best;
}

/** `jumped` is called with the sample that the cutter was sent to. */
export function transport(model: Model, store: Store, player: Player, jumped: (index: number) => void): HTMLElement {
  const play = el("button", { type: "button", id: "play", class: "play" });
  const scrub = el("input", { type: "range", id: "scrub", min: "0", max: String(model.count - 1), step: "1", "aria-label": "Place of the cutter" });
  const at = el("output", { class: "time", for: "scrub" });
  const speed = el("select", { id: "speed" }, ...SPEEDS.map((v) => el("option", { value: String(v) }, `${v} ×`)));
  speed.value = String(store.state.speed);
  play.addEventListener("click", () => player.toggle());
  scrub.addEventListener("input", () => store.set({ place: Number(scrub.value), playing: false }));
  speed.addEventListener("change", () => store.set({ speed: Number(speed.value) }));
  const end = model.time[model.count - 1];
  const show = () => {
    const { place, playing } = store.state;
    const text = playing ? "Pause" : "Play";
    if (play.dataset.state !== text) {
      play.dataset.state = text;
      play.setAttribute("aria-label", `${text} the cutter`);
      play.textContent = playing ? "❚❚" : "▶";
    }
    const index = Math.round(place);
    if (scrub.value !== String(index)) scrub.value = String(index);
    if (!playing) scrub.setAttribute("aria-valuetext", placeText(model, index));
    at.textContent = `s ${withUnit(sayLength(model.s.values[index], 1))} · t ${fixed(player.timeOf(place), 2)} / ${fixed(end, 2)} s`;
  };
  store.onChange((changed) => { if (changed.has("place") || changed.has("playing")) show(); });
  show();
  const worst = el("button", { type: "button", id: "worst", title: "Put the cutter where the wall error is largest" }, "largest error");
  worst.hidden = largestError(model, store.state) === null;
  worst.addEventListener("click", () => {
    const index = largestError(model, store.state);
    if (index === null) return;
    store.set({ place: index, playing: false });
    jumped(index);
  });
  const follow = el("input", { type: "checkbox", id: "follow" });
  follow.addEventListener("change", () => store.set({ follow: follow.checked }));
  return el("div", { class: "transport", role: "group", "aria-label": "Cutter" }, play, scrub, worst, at, el("label", { class: "field follow" }, follow, "follow"), el("label", { class: "field" }, "speed", speed));
}
