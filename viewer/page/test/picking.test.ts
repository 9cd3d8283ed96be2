import { PerspectiveCamera, Matrix4 } from "three";
import { expect, test } from "vitest";
import { kEverything } from "../src/cloud/crop";
import { pick } from "../src/cloud/picking";
import type { Vec3 } from "../src/protocol";
import { part } from "./cloud";

const kScreen = { width: 800, height: 600 };

/// Looks along +x, z up.
function clipFromPoints(): Matrix4 {
  const camera = new PerspectiveCamera(60, kScreen.width / kScreen.height, 0.1, 100);
  camera.up.set(0, 0, 1);
  camera.lookAt(1, 0, 0);
  camera.updateMatrixWorld();
  return new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
}

function picked(points: Vec3[], x: number, y: number, drawn = points.length): number | null {
  return pick([{ points: part(points.map((at) => ({ at }))), drawn }], clipFromPoints(), kScreen, x, y)?.index ?? null;
}

test("the point under the finger, not one beside it", () => {
  expect(picked([[10, 0.1, 0], [10, 0, 0], [5, -0.08, 0]], 400, 300)).toBe(1);
});

test("of points over each other the nearest to the viewpoint", () => {
  expect(picked([[10, 0, 0], [4, 0, 0], [6, 0, 0]], 401, 300)).toBe(1);
});

test("none within reach, none behind it, none that is not drawn", () => {
  expect(picked([[10, 1, 0]], 400, 300)).toBeNull();
  expect(picked([[-10, 0, 0], [NaN, NaN, NaN]], 400, 300)).toBeNull();
  expect(picked([[10, 1, 0], [10, 0, 0]], 400, 300, 1)).toBeNull();
});

test("left of the LIDAR is left on the screen", () => {
  const x = 400 - (300 / Math.tan(Math.PI / 6)) * 0.1; // 1 m of 10
  expect(picked([[10, 1, 0]], x, 300)).toBe(0);
});

test("none that is cropped away", () => {
  const points = part([{ at: [4, 0, 0] }, { at: [10, 0, 0] }]);
  const found = pick([{ points, drawn: 2 }], clipFromPoints(), kScreen, 400, 300, { limits: { low: [5, -1, -1], high: [20, 1, 1] }, before: 0 });
  expect(found?.index).toBe(1);
});

test("none that is cut away, unless a camera saw it", () => {
  const points = part([{ at: [4, 0, 0] }, { at: [10, 0, 0] }, { at: [12, 2, 0] }, { at: [3, 0.5, 0], valid: 1 }]);
  const find = (x: number) => pick([{ points, drawn: 4 }], clipFromPoints(), kScreen, x, 300, { limits: kEverything, before: 5 })?.index;
  expect(find(400)).toBe(1);
  expect(find(400 - (300 / Math.tan(Math.PI / 6)) * (0.5 / 3))).toBe(3);
});
