/** What the reader has chosen, and who wants to know when it changes. */

import type { PassName } from "./model";

export type Shown = PassName | "both";

export interface State {
  shown: Shown;
  /** Factor by which errors and deviations are drawn larger than they are. */
  magnify: number;
  /** Index of the height shown; null: mean over the height. */
  height: number | null;
  /** Place of the cutter on the contour, as a sample with a fraction. */
  place: number;
  playing: boolean;
  /** 1: as fast as the machine. */
  speed: number;
  /** The picture keeps the cutter in its middle. */
  follow: boolean;
  /** Shown stretch of arc length in the traces, mm. */
  range: [number, number] | null;
  /** Layers of the scene that are hidden. */
  hidden: Set<string>;
}

type Listener = (changed: Set<keyof State>) => void;

export class Store {
  private readonly listeners: Listener[] = [];
  constructor(readonly state: State) {}

  onChange(listener: Listener): void {
    this.listeners.push(listener);
  }

  set(change: Partial<State>): void {
    const changed = new Set<keyof State>();
    for (const key of Object.keys(change) as (keyof State)[]) {
      if (this.state[key] !== change[key] || key === "hidden") changed.add(key);
    }
    if (changed.size === 0) return;
    Object.assign(this.state, change);
    this.again(...changed);
  }

  /** Has everything that follows these made anew. */
  again(...keys: (keyof State)[]): void {
    for (const listener of this.listeners) listener(new Set(keys));
  }
}
