// The point under a finger.
import type { Matrix4 } from "three";
import { isInside, kEverything, type Box } from "./crop";
import { kWords, type Points } from "./points";

export interface Screen { width: number; height: number } // [px]
/// What is left out: points beyond `limits`, and those nearer to the eye than `before` [m] that no camera saw.
export interface Shown { limits: Box; before: number }
export interface Picked { points: Points; index: number }

const kReach = 12; // from the finger [px]
const kAsNear = 3; // no farther than the nearest and this [px]: drawn over each other

/// Of the points nearest to (x, y) on the screen [px from its upper left], the nearest to the viewpoint.
/// `clip_from_points`: projection * view.
export function pick(shown: { points: Points; drawn: number }[], clip_from_points: Matrix4, screen: Screen,
  x: number, y: number, { limits, before }: Shown = { limits: kEverything, before: 0 }): Picked | null {
  const m = clip_from_points.elements;
  const found: { points: Points; index: number; away: number; depth: number }[] = [];
  for (const { points, drawn } of shown)
    for (let index = 0; index < drawn; ++index) {
      const at = index * kWords;
      const [px, py, pz] = [points.floats[at], points.floats[at + 1], points.floats[at + 2]];
      const w = m[3] * px + m[7] * py + m[11] * pz + m[15];
      if (!(w > 0) || !isInside(limits, px, py, pz)) continue;
      if (w < before && points.words[at + 6] >>> 16 === 0) continue;
      const dx = (((m[0] * px + m[4] * py + m[8] * pz + m[12]) / w + 1) / 2) * screen.width - x;
      if (Math.abs(dx) > kReach) continue;
      const dy = ((1 - (m[1] * px + m[5] * py + m[9] * pz + m[13]) / w) / 2) * screen.height - y;
      const away = Math.hypot(dx, dy);
      if (away <= kReach) found.push({ points, index, away, depth: w });
    }
  const nearest = Math.min(...found.map(({ away }) => away));
  const best = found.filter(({ away }) => away <= nearest + kAsNear)
    .reduce<(typeof found)[number] | null>((a, b) => (a && a.depth <= b.depth ? a : b), null);
  return best && { points: best.points, index: best.index };
}
