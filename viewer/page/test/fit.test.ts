import { PerspectiveCamera, Vector3 } from "three";
import { describe, expect, test } from "vitest";
import { extentsOf, firstDirection, fit, subjectOf, turnTowards } from "../src/cloud/fit";
import { part } from "./cloud";

const kSlope = Math.tan(Math.PI / 6);

/// A room of 10 x 8 x 3 m, its floor 1.5 m below the LIDAR.
const kRoom = Float32Array.from(Array.from({ length: 3000 }, (_, i) => {
  const [a, b] = [((i * 7) % 101) / 100, ((i * 13) % 97) / 96];
  return i % 3 === 0 ? [10 * a, 8 * b - 4, -1.5] : i % 3 === 1 ? [10, 8 * a - 4, 3 * b - 1.5] : [10 * a, 4, 3 * b - 1.5];
}).flat());

/// Where points lie on the canvas, from -1 to 1 each way.
function onCanvas(points: Float32Array, direction: Vector3, aspect: number) {
  const turned = turnTowards(direction);
  const fitted = fit(points, turned, kSlope, aspect)!;
  const camera = new PerspectiveCamera(60, aspect, 0.05, 1000);
  camera.quaternion.copy(turned);
  camera.position.copy(fitted.position);
  camera.updateMatrixWorld();
  const seen: Vector3[] = [];
  for (let i = 0; i < points.length; i += 3) seen.push(new Vector3().fromArray(points, i).project(camera));
  return { seen, fitted };
}
const within = (seen: Vector3[]) => seen.filter(({ x, y }) => Math.abs(x) <= 1 && Math.abs(y) <= 1).length / seen.length;

describe.each([[1.6], [0.46]])("on a canvas of %f times its height", (aspect) => {
  test.each([[1, 0, -0.35], [0, 0, -1], [0.6, -0.6, -0.4], [-1, 0, 0]])("along %f %f %f the cloud fills it", (...direction) => {
    const { seen } = onCanvas(kRoom, new Vector3(...direction), aspect);
    expect(within(seen)).toBeGreaterThan(0.92);
    const spread = (axis: "x" | "y") => {
      const values = seen.map((point) => point[axis]).sort((a, b) => a - b);
      return values[Math.floor(0.97 * values.length)] - values[Math.floor(0.03 * values.length)];
    };
    expect(Math.max(spread("x"), spread("y"))).toBeGreaterThan(1.5); // of 2
  });
});

test("a few far outliers do not make it small", () => {
  const outliers = Array.from({ length: 30 }, (_, i) => [300 + i, 200, 40]).flat();
  const direction = new Vector3(1, 0, -0.35);
  const alone = onCanvas(kRoom, direction, 1.6).fitted, amid = onCanvas(Float32Array.from([...kRoom, ...outliers]), direction, 1.6).fitted;
  expect(amid.position.distanceTo(alone.position)).toBeLessThan(1);
});

test("what it turns about lies in the cloud", () => {
  const { target } = onCanvas(kRoom, new Vector3(1, 0, -0.35), 1.6).fitted;
  expect(target.x).toBeGreaterThan(0);
  expect(target.x).toBeLessThan(10);
});

test("the first view is from behind and above, towards what is near", () => {
  const direction = firstDirection(kRoom, new Vector3());
  expect(direction.x).toBeGreaterThan(0.5);
  expect(direction.z).toBeLessThan(0);
});

test("without points there is nothing to fit", () => {
  expect(fit(new Float32Array(), turnTowards(new Vector3(1, 0, 0)), kSlope, 1)).toBeNull();
  expect(extentsOf(new Float32Array())).toBeNull();
});

test("extents leave out the farthest two of a hundred on each side", () => {
  const points = Float32Array.from(Array.from({ length: 101 }, (_, i) => [i, -i, i === 100 ? 1e6 : 0]).flat());
  expect(extentsOf(points)).toEqual({ low: [2, -98, 0], high: [98, -2, 0] });
});

describe("the subject", () => {
  const all = Array.from({ length: 200 }, (_, i) => ({ at: [i, 0, 0] as [number, number, number], valid: i < 60 ? 1 : 0 }));
  test("is what a camera saw", () => {
    expect(subjectOf([part(all)]).length).toBe(3 * 60);
  });
  test("is all where cameras saw hardly anything", () => {
    expect(subjectOf([part(all.map((point, i) => ({ ...point, valid: i < 5 ? 1 : 0 })))]).length).toBe(3 * 200);
  });
});
