import { expect, test } from "vitest";
import { angularRadii, kAngleUnit } from "../src/cloud/spacing";
import type { Vec3 } from "../src/protocol";
import { part } from "./cloud";

/// A wall at x = `away` [m] seen by beams that are `across` and `along` [rad] apart.
function wall(away: number, across: number, along: number, columns = 40, rows = 30): Vec3[] {
  return Array.from({ length: columns * rows }, (_, i) => {
    const azimuth = ((i % columns) - columns / 2) * across, elevation = (Math.floor(i / columns) - rows / 2) * along;
    return [away, away * Math.tan(azimuth), (away * Math.tan(elevation)) / Math.cos(azimuth)];
  });
}
const radii = (points: Vec3[]) => Array.from(angularRadii(part(points.map((at) => ({ at }))))).map((unit) => unit * kAngleUnit);
const median = (values: number[]) => [...values].sort((a, b) => a - b)[values.length >> 1];

test("as the LIDAR sees it a point is as large near by as far away", () => {
  const [near, far] = [2, 30].map((away) => median(radii(wall(away, 0.004, 0.004))));
  expect(far).toBeCloseTo(near, 4);
});

test("beams that are twice as far apart make points twice as large", () => {
  expect(median(radii(wall(5, 0.008, 0.008))) / median(radii(wall(5, 0.004, 0.004)))).toBeCloseTo(2, 1);
});

test("points as large as their spacing close a surface's gaps, and no more", () => {
  const found = median(radii(wall(5, 0.004, 0.004)));
  expect(found).toBeGreaterThanOrEqual(0.004 * Math.SQRT1_2);
  expect(found).toBeLessThan(0.004);
});

test("where rows lie farther apart than points in a row, points grow with the gap", () => {
  const near = median(radii(wall(5, 0.004, 0.004))), apart = median(radii(wall(5, 0.004, 0.008)));
  expect(apart).toBeGreaterThan(1.3 * near);
});

test("a step in depth is no gap", () => {
  const step = [...wall(5, 0.004, 0.004), ...wall(9, 0.004, 0.004).map(([x, y, z]): Vec3 => [x, y + 9 * Math.tan(40 * 0.004), z])];
  expect(Math.max(...radii(step))).toBeLessThan(0.004 * 1.2);
});

test("a LIDAR of few rings is drawn larger", () => {
  const dense = median(radii(wall(5, 0.0035, 0.0035, 40, 30))), sparse = median(radii(wall(5, 0.0035, 0.07, 200, 12)));
  expect(sparse).toBeGreaterThan(1.4 * dense);
});

test("points that are not finite have no size", () => {
  const found = radii([[NaN, NaN, NaN], ...wall(5, 0.004, 0.004)]);
  expect(found[0]).toBe(0);
  expect(found[1]).toBeGreaterThan(0);
});
