// Four corners that a person clicked, in image pixels.
import type { Vec2 } from "../../protocol";
import type { Size } from "../image/viewport";

export const kCorners = 4;
export type Four = [Vec2, Vec2, Vec2, Vec2];

const kLeastSidePx = 4; // shorter sides are slips of the finger

const kLeastTurn = 0.02; // [sine] about 1 degree; straighter is no corner

/// Sine of the turn at b; above 0 clockwise as seen.
function turn(a: Vec2, b: Vec2, c: Vec2): number {
  const cross = (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]);
  return cross / (Math.hypot(b[0] - a[0], b[1] - a[1]) * Math.hypot(c[0] - b[0], c[1] - b[1]));
}

function around(corners: Vec2[], i: number): Vec2 {
  return corners[(i + corners.length) % corners.length]!;
}

/// What is wrong with them; "": nothing. A flat board's outline is convex in every image.
export function faultOf(corners: Vec2[], image: Size): string {
  if (corners.length < kCorners) return `Click corner ${corners.length + 1} of ${kCorners}.`;
  const outside = corners.findIndex(([x, y]) => x < -0.5 || y < -0.5 || x > image.width - 0.5 || y > image.height - 0.5);
  if (outside >= 0) return `Corner ${outside + 1} is outside the image.`;
  const close = corners.findIndex((at, i) => Math.hypot(at[0] - around(corners, i + 1)[0], at[1] - around(corners, i + 1)[1]) < kLeastSidePx);
  if (close >= 0) return `Corners ${close + 1} and ${((close + 1) % kCorners) + 1} are in the same place.`;
  const turns = corners.map((at, i) => turn(around(corners, i - 1), at, around(corners, i + 1)));
  if (turns.some((each) => Math.abs(each) < kLeastTurn)) return "Three corners lie on a line.";
  const right = turns.filter((each) => each > 0).length;
  if (right === 0 || right === kCorners) return "";
  return right === 2 ? "The outline crosses itself: the corners must be in order around the board." : "One corner lies inside the other three.";
}

/// Clockwise as seen, from the one that came first.
export function goingRound(corners: Vec2[]): Vec2[] {
  if (corners.length === 0) return [];
  const middle = corners.reduce<Vec2>(([x, y], [u, v]) => [x + u / corners.length, y + v / corners.length], [0, 0]);
  const angle = ([x, y]: Vec2): number => Math.atan2(y - middle[1], x - middle[0]);
  const sorted = [...corners].sort((a, b) => angle(a) - angle(b));
  const first = sorted.indexOf(corners[0]!);
  return [...sorted.slice(first), ...sorted.slice(0, first)];
}

export function inside([x, y]: Vec2, image: Size): Vec2 {
  return [Math.min(Math.max(x, -0.5), image.width - 0.5), Math.min(Math.max(y, -0.5), image.height - 0.5)];
}
