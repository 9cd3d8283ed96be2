import { expect, test } from "vitest";
import { shortNames } from "../../src/panels/words";

const labels = (views: string[]): string[] => [...shortNames(views).values()];

test("a view is called without what all names begin with", () => {
  expect(labels(["0003", "0012", "0100"])).toEqual(["3", "12", "100"]);
  expect(labels(["pose07", "pose38"])).toEqual(["7", "38"]);
  expect(labels(["day/pose30", "day/pose38"])).toEqual(["30", "38"]);
  expect(labels(["left_1", "right_1"])).toEqual(["left_1", "right_1"]);
});

test("nothing is left of no name", () => {
  expect(labels([])).toEqual([]);
  expect(labels(["pose07"])).toEqual(["pose07"]);
  expect(labels(["pose", "pose2"])).toEqual(["pose", "2"]);
});
