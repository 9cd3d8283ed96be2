// How fast drawing is, and what share of the points is drawn while the camera moves.

const kSlowMs = 70;
const kFastMs = 30;
const kLeastShare = 0.1;

export class Pace {
  share = 1; // of the points, while the camera moves
  hurry = false; // it draws slowly: what costs less is to be taken while the camera moves
  frames = 0; // drawn since the page was opened
  private times: number[] = []; // when [ms]

  /// A frame that took `cost_ms` was drawn at `now_ms`.
  drew(now_ms: number, cost_ms: number, moving: boolean): void {
    ++this.frames;
    this.times = [...this.times.filter((time) => time > now_ms - 1000), now_ms];
    if (!moving) return;
    if (cost_ms > kSlowMs) this.share = Math.max(kLeastShare, this.share * 0.7);
    else if (cost_ms < kFastMs) this.share = Math.min(1, this.share * 1.2);
  }

  /// Frames of the last second.
  fps(now_ms: number): number {
    return this.times.filter((time) => time > now_ms - 1000).length;
  }
}
