// How fast drawing is, and what is drawn while the camera moves so that it keeps up.

const kGoal_ms = { slow: 70, fast: 35 }; // what a frame may take, and what leaves room for more
const kLeastShare = 0.05;
const kTooSlowAtRest_ms = 60; // so that moving is begun in a hurry

export class Pace {
  share = 1; // of the points, while the camera moves
  hurry = false; // it draws slowly: while the camera moves what costs less is to be drawn
  frames = 0; // drawn since the page was opened
  cost_ms = 0; // of the frame drawn last
  private times: number[] = []; // when [ms]

  /// A frame that took `cost_ms` was drawn at `now_ms`.
  drew(now_ms: number, cost_ms: number, moving: boolean): void {
    ++this.frames;
    this.cost_ms = cost_ms;
    this.times = [...this.times.filter((time) => time > now_ms - 1000), now_ms];
    if (!moving) this.hurry = cost_ms > kTooSlowAtRest_ms;
    else if (cost_ms > kGoal_ms.slow && !this.hurry) this.hurry = true;
    else if (cost_ms > kGoal_ms.slow) this.share = Math.max(kLeastShare, this.share * Math.max(0.5, kGoal_ms.slow / cost_ms));
    else if (cost_ms < kGoal_ms.fast) this.share = Math.min(1, this.share * 1.2);
  }

  /// Frames of the last second.
  fps(now_ms: number): number {
    return this.times.filter((time) => time > now_ms - 1000).length;
  }
}
