// Which of the newest sweeps' parts are shown: the last whole sweep and, over it, the chunks of the
// one that is being made. Parts may come in any order, and some never.
import type { Part } from "./points";

/// A sweep so much older than what is shown [us] is another run's: a log that begins anew.
const kRestartUs = 5e6;

interface Whole { sweep: number; parts: Map<number, Part>; last: number | null }

const isComplete = ({ parts, last }: Whole): boolean => last !== null && parts.size === last + 1;

export class Sweeps {
  private whole: Whole | null = null;
  private coming: Whole | null = null; // not yet complete
  private chunks: Part[] = [];

  shown(): Part[] {
    return [...(this.whole?.parts.values() ?? []), ...this.chunks];
  }

  /// A whole sweep is shown, not only chunks of one.
  isWhole(): boolean { return this.whole !== null; }

  add(part: Part): void {
    if (part.header.sweep_utime < this.newest() - kRestartUs) this.clear();
    if (part.header.whole) this.addWhole(part);
    else this.addChunk(part);
  }

  clear(): void {
    this.whole = this.coming = null;
    this.chunks = [];
  }

  private newest(): number {
    return Math.max(this.whole?.sweep ?? -Infinity, this.coming?.sweep ?? -Infinity,
      ...this.chunks.map(({ header }) => header.sweep_utime));
  }

  private addChunk(part: Part): void {
    const { sweep_utime: sweep, part: number } = part.header;
    if (this.whole && sweep <= this.whole.sweep) return;
    const same = this.chunks.findIndex(({ header }) => header.sweep_utime === sweep && header.part === number);
    if (same >= 0) this.chunks.splice(same, 1);
    this.chunks.push(part);
    // Of more than two sweeps in the making the oldest will never be whole.
    const sweeps = [...new Set(this.chunks.map(({ header }) => header.sweep_utime))].sort((a, b) => b - a);
    if (sweeps.length > 2) this.chunks = this.chunks.filter(({ header }) => header.sweep_utime >= sweeps[1]);
  }

  private addWhole(part: Part): void {
    const { sweep_utime: sweep, part: number, sweep_end } = part.header;
    if (this.whole && sweep < this.whole.sweep) return;
    if (this.coming && sweep > this.coming.sweep) this.show(this.coming); // what is missing of it was dropped
    const into = this.whole?.sweep === sweep ? this.whole
      : this.coming?.sweep === sweep ? this.coming : { sweep, parts: new Map<number, Part>(), last: null };
    into.parts.set(number, part);
    if (sweep_end) into.last = number;
    if (into === this.whole) return;
    this.coming = into;
    if (isComplete(into) || !this.whole) this.show(into);
  }

  private show(whole: Whole): void {
    this.whole = whole;
    if (this.coming && this.coming.sweep <= whole.sweep) this.coming = null;
    this.chunks = this.chunks.filter(({ header }) => header.sweep_utime > whole.sweep);
  }
}
