/** The clock that moves the cutter: machine time times a factor, independent of the frame rate. */

import type { Model } from "./model";
import type { Store } from "./state";

export class Player {
  private last = 0;
  private seconds = 0;

  constructor(private readonly model: Model, private readonly store: Store) {
    store.onChange((changed) => {
      if (changed.has("place") && !this.moving) this.seconds = this.timeOf(store.state.place);
      if (changed.has("playing") && store.state.playing) this.start();
    });
  }

  private moving = false;

  toggle(): void {
    const { state } = this.store;
    if (!state.playing && state.place >= this.model.count - 1) this.store.set({ place: 0 });
    this.store.set({ playing: !state.playing });
  }

  timeOf(place: number): number {
    const i = Math.floor(place);
    const j = Math.min(i + 1, this.model.count - 1);
    return this.model.time[i] + (this.model.time[j] - this.model.time[i]) * (place - i);
  }

  private start(): void {
    this.last = performance.now();
    this.seconds = this.timeOf(this.store.state.place);
    requestAnimationFrame((now) => this.tick(now));
  }

  private tick(now: number): void {
    const { state } = this.store;
    if (!state.playing) return;
    this.seconds += Math.max(0, now - this.last) / 1000 * state.speed;
    this.last = now;
    const end = this.model.time[this.model.count - 1];
    const done = this.seconds >= end;
    this.moving = true;
    this.store.set({ place: done ? this.model.count - 1 : this.placeAt(this.seconds), ...(done ? { playing: false } : {}) });
    this.moving = false;
    if (!done) requestAnimationFrame((next) => this.tick(next));
  }

  private placeAt(seconds: number): number {
    const { time, count } = this.model;
    let low = 0;
    let high = count - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (time[middle] <= seconds) low = middle;
      else high = middle - 1;
    }
    const span = low + 1 < count ? time[low + 1] - time[low] : 0;
    return span > 0 ? low + (seconds - time[low]) / span : low;
  }
}
