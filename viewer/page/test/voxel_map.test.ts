import { expect, test } from "vitest";
import { valuesOf } from "../src/cloud/points";
import { VoxelMap } from "../src/cloud/voxel_map";
import type { Vec3 } from "../src/protocol";
import { part } from "./cloud";

const line = (count: number, step: number) =>
  Array.from({ length: count }, (_, i) => ({ at: [(i - count / 2) * step, 0.02, 0.02] as Vec3 }));
const positions = (map: VoxelMap) => Array.from({ length: map.count }, (_, i) =>
  valuesOf(map, i).position.map((value) => Math.round(value * 100) / 100));

test("one point a voxel, the newest", () => {
  const map = new VoxelMap(1000, 0.1);
  map.add(part([{ at: [0.01, 0, 0], kelvin: 290, valid: 2 }], { sweep_utime: 1 }));
  map.add(part([{ at: [0.09, 0, 0], kelvin: 310, valid: 2 }, { at: [-0.01, 0, 0] }], { sweep_utime: 2 }));
  expect(positions(map)).toEqual([[0.09, 0, 0], [-0.01, 0, 0]]);
  expect(valuesOf(map, 0)).toMatchObject({ kelvin: 310, sweep: 2 });
});

test("a point that fewer cameras saw does not take the place of another", () => {
  const map = new VoxelMap(1000, 0.1);
  map.add(part([{ at: [0, 0, 0], kelvin: 290, valid: 3 }]));
  map.add(part([{ at: [0.01, 0, 0], valid: 1 }]));
  expect(valuesOf(map, 0).kelvin).toBe(290);
});

test("voxels double until the points are few enough, and none is lost on the way", () => {
  const map = new VoxelMap(100, 0.1);
  map.add(part(line(1000, 0.1)));
  expect(map.voxel_m).toBeCloseTo(1.6); // 100 m in 100 voxels need 1 m or more
  expect(map.count).toBeGreaterThanOrEqual(62);
  expect(map.count).toBeLessThanOrEqual(64);
});

test("what has no place is left out", () => {
  const map = new VoxelMap(1000, 0.1);
  map.add(part([{ at: [NaN, 0, 0] }, { at: [0, NaN, 0] }, { at: [0, 0, Infinity] }, { at: [1, 1, 1] }]));
  expect(positions(map)).toEqual([[1, 1, 1]]);
});

test("it grows beyond what it began with", () => {
  const map = new VoxelMap(1_000_000, 0.1);
  map.add(part(line(150_000, 0.25)));
  expect(map.count).toBe(150_000);
  expect(map.voxel_m).toBe(0.1);
});

test("the order names each record once", () => {
  const map = new VoxelMap(1000, 0.1);
  map.add(part(line(500, 0.25)));
  expect(Array.from(map.order.subarray(0, map.count)).sort((a, b) => a - b)).toEqual(Array.from({ length: 500 }, (_, i) => i));
});

test("with a pose it is in the map's frame, and what has none is left out", () => {
  const map = new VoxelMap(1000, 0.1);
  map.add(part([{ at: [1, 2, 3] }]));
  map.add(part([{ at: [1, 0, 0] }], { map_from_lidar: [0, -1, 0, 10, 1, 0, 0, 20, 0, 0, 1, 30, 0, 0, 0, 1] }));
  map.add(part([{ at: [5, 5, 5] }]));
  expect(map.frame).toBe("map");
  expect(positions(map)).toEqual([[10, 21, 30]]);
});
