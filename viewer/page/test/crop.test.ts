import { describe, expect, test } from "vitest";
import { edgesOf, isInside, kEverything, limitsOf, padded, withEnd, type Box } from "../src/cloud/crop";
import { measured, withPoint } from "../src/cloud/measure";

const kBox: Box = { low: [-1, -2, 0], high: [3, 2, 2] };

describe("what is shown", () => {
  test("is all where nothing cuts it", () => {
    expect(limitsOf(null, null)).toEqual(kEverything);
  });
  test("is a slice as thick as asked for", () => {
    const { low, high } = limitsOf(null, { axis: 1, middle: 0.5, thickness: 0.2 });
    expect([low[1], high[1]]).toEqual([0.4, 0.6]);
    expect(high[0]).toBe(kEverything.high[0]);
  });
  test("is where box and slice both are", () => {
    const limits = limitsOf(kBox, { axis: 2, middle: 2, thickness: 1 });
    expect(limits).toEqual({ low: [-1, -2, 1.5], high: [3, 2, 2] });
    expect(isInside(limits, 0, 0, 1.7)).toBe(true);
    expect(isInside(limits, 0, 0, 1.4)).toBe(false);
    expect(isInside(limits, 0, 0, 2.1)).toBe(false);
  });
  test("leaves box itself as it is", () => {
    limitsOf(kBox, { axis: 2, middle: 2, thickness: 1 });
    expect(kBox.low).toEqual([-1, -2, 0]);
  });
});

test("one end that is moved past the other takes it along", () => {
  expect(withEnd(kBox, "low", 0, 1)).toEqual({ low: [1, -2, 0], high: [3, 2, 2] });
  expect(withEnd(kBox, "low", 2, 5)).toEqual({ low: [-1, -2, 5], high: [3, 2, 5] });
  expect(withEnd(kBox, "high", 1, -3)).toEqual({ low: [-1, -3, 0], high: [3, -3, 2] });
});

test("a padded box is larger, by two decimetres at most", () => {
  const { low, high } = padded({ low: [-1.23, 0, 0], high: [1.23, 1, 1] });
  expect(low[0]).toBeCloseTo(-1.4, 9);
  expect(high[0]).toBeCloseTo(1.4, 9);
});

test("a box has twelve edges, each along one axis", () => {
  const edges = edgesOf(kBox);
  expect(edges.length).toBe(24);
  for (let i = 0; i < edges.length; i += 2)
    expect(edges[i].filter((value, axis) => value !== edges[i + 1][axis]).length).toBe(1);
});

describe("measuring", () => {
  test("tells the distance and its parts, from the first point to the second", () => {
    expect(measured([1, 1, 1], [4, -3, 1])).toEqual({ distance: 5, difference: [3, -4, 0] });
  });
  test("a third point begins anew", () => {
    const two = withPoint(withPoint([], [0, 0, 0]), [1, 0, 0]);
    expect(two).toEqual([[0, 0, 0], [1, 0, 0]]);
    expect(withPoint(two, [2, 0, 0])).toEqual([[2, 0, 0]]);
  });
});
