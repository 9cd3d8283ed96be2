import { expect, test } from "vitest";
import { coloursOf } from "../src/cloud/color_maps";
import { gridLines, gridOf, gridStep, groundHeight } from "../src/cloud/ground";

const noise = (i: number) => 0.01 * (((i * 37) % 11) / 5 - 1);
const floor = Array.from({ length: 600 }, (_, i) => [i % 10, i / 60, -1.4 + noise(i)]);
const walls = Array.from({ length: 1200 }, (_, i) => [9, i % 10, -1.4 + (4 * i) / 1200]);

test("the ground is the lowest layer with many points, not a few mirrored ones below", () => {
  const mirrored = Array.from({ length: 8 }, (_, i) => [i, 0, -3 - i]);
  expect(groundHeight(Float32Array.from([...walls, ...floor, ...mirrored].flat()))).toBeCloseTo(-1.4, 1);
});

test("a table in front is not the ground", () => {
  const table = Array.from({ length: 500 }, (_, i) => [i % 3, 1, -0.6 + noise(i)]);
  expect(groundHeight(Float32Array.from([...floor, ...table].flat()))).toBeCloseTo(-1.4, 1);
});

test("of nothing it is at zero", () => {
  expect(groundHeight(new Float32Array())).toBe(0);
});

test.each([[5, 0.5], [11, 1], [24, 2], [50, 5], [115, 10], [0.3, 0.1]])("of %f m lines are %f m apart", (size, step) => {
  expect(gridStep(size)).toBeCloseTo(step, 9);
});

test("a grid encloses what it is of, with lines at multiples of its step", () => {
  const grid = gridOf({ low: [-3.2, 0.5, -1], high: [7.7, 6, 2] }, -1.4);
  expect(grid.step).toBe(1);
  expect([grid.xs[0], grid.xs[grid.xs.length - 1]]).toEqual([-4, 8]);
  expect([grid.ys[0], grid.ys[grid.ys.length - 1]]).toEqual([0, 6]);
  expect(gridLines(grid).length).toBe(2 * (13 + 7));
  expect(gridLines(grid).every(([, , z]) => z === -1.4)).toBe(true);
});

test("colours are those that the rig's cameras give", () => {
  expect(coloursOf([{ kind: "color" }])).not.toContain("temperature");
  expect(coloursOf([{ kind: "color" }])).not.toContain("blend");
  expect(coloursOf([{ kind: "thermal" }])[0]).toBe("temperature");
  expect(coloursOf([{ kind: "color" }, { kind: "thermal" }])).toContain("blend");
  expect(coloursOf([])).toEqual(["depth", "intensity"]);
  expect(coloursOf(null)).toContain("temperature");
});
