import { describe, expect, test } from "vitest";
import type { Vec2 } from "../../src/protocol";
import { faultOf, goingRound, inside } from "../../src/panels/pick/corners";
import { nudged } from "../../src/panels/pick/corner_handles";

const kImage = { width: 640, height: 480 };
const kBoard: Vec2[] = [[100, 100], [300, 120], [290, 260], [110, 240]];
const [a, b, c, d] = kBoard as [Vec2, Vec2, Vec2, Vec2];

describe("four picked corners", () => {
  test("may go round either way, from any corner", () => {
    for (const corners of [kBoard, [...kBoard].reverse(), [c, d, a, b]]) expect(faultOf(corners, kImage)).toBe("");
  });

  test("must not cross", () => {
    for (const corners of [[a, c, b, d], [a, b, d, c]]) expect(faultOf(corners, kImage)).toContain("cross");
  });

  test("must not hold one of them inside the others", () => {
    expect(faultOf([a, b, [130, 120], d], kImage)).toContain("inside");
  });

  test("must be four, apart, not on a line, in the image", () => {
    expect(faultOf([a, b], kImage)).toContain("corner 3");
    expect(faultOf([a, b, c, [c[0] + 1, c[1]]], kImage)).toContain("Corners 3 and 4");
    expect(faultOf([a, [200, 100], [300, 100], d], kImage)).toContain("line");
    expect(faultOf([a, b, c, [-3, 200]], kImage)).toContain("Corner 4 is outside");
  });

  test("can be put in order, from the first", () => {
    const ordered = goingRound([a, c, b, d]);
    expect(faultOf(ordered, kImage)).toBe("");
    expect(ordered[0]).toEqual(a);
  });

  test("stay inside the image's border, which is half a pixel beyond the outer centres", () => {
    expect(inside([-9, 900], kImage)).toEqual([-0.5, 479.5]);
  });

  test("move by a quarter of a pixel, or by two", () => {
    expect(nudged([10, 20], "ArrowLeft", false)).toEqual([9.75, 20]);
    expect(nudged([10, 20], "ArrowDown", true)).toEqual([10, 22]);
    expect(nudged([10, 20], "a", false)).toBeNull();
  });
});
