import { expect, test } from "vitest";
import { Pace } from "../src/cloud/pace";

/// Frames while the view moves; each takes as long as it has to draw.
function moved(pace: Pace, frames: number, cost: (share: number) => number): void {
  for (let i = 0; i < frames; ++i) pace.drew(100 * i, cost(pace.share), true);
}

test("what is slow is drawn quicker first, then with fewer points", () => {
  const pace = new Pace();
  moved(pace, 1, () => 200);
  expect([pace.hurry, pace.share]).toEqual([true, 1]);
  moved(pace, 30, (share) => 20 + 400 * share);
  expect(20 + 400 * pace.share).toBeLessThan(75);
  expect(20 + 400 * pace.share).toBeGreaterThan(30);
});

test("a share is left however slow it is, and comes back where it is quick again", () => {
  const pace = new Pace();
  moved(pace, 50, () => 1000);
  expect(pace.share).toBeGreaterThanOrEqual(0.05);
  moved(pace, 50, () => 5);
  expect(pace.share).toBe(1);
});

test("a quick one is in no hurry, a slow frame at rest makes it so", () => {
  const pace = new Pace();
  pace.drew(0, 10, false);
  expect(pace.hurry).toBe(false);
  pace.drew(100, 300, false);
  expect([pace.hurry, pace.share]).toEqual([true, 1]);
});
