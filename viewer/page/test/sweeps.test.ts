import { beforeEach, expect, test } from "vitest";
import { Sweeps } from "../src/cloud/sweeps";
import { part as points } from "./cloud";

const one = (sweep_utime: number, part: number, whole: boolean, sweep_end = false) =>
  points([{ at: [0, 0, 0] }], { sweep_utime, part, whole, sweep_end });
let sweeps: Sweeps;
const shown = () => sweeps.shown().map(({ header }) => `${header.sweep_utime}${header.whole ? "w" : "c"}${header.part}`);

beforeEach(() => { sweeps = new Sweeps(); });

test("chunks lie over the last whole sweep until their own is whole", () => {
  sweeps.add(one(1, 0, true, true));
  sweeps.add(one(2, 0, false));
  sweeps.add(one(2, 1, false));
  expect(shown()).toEqual(["1w0", "2c0", "2c1"]);
  sweeps.add(one(2, 0, true));
  expect(shown()).toEqual(["1w0", "2c0", "2c1"]);
  sweeps.add(one(2, 1, true, true));
  expect(shown()).toEqual(["2w0", "2w1"]);
});

test("parts may come in any order", () => {
  sweeps.add(one(1, 0, true, true));
  sweeps.add(one(2, 1, true, true));
  expect(shown()).toEqual(["1w0"]);
  sweeps.add(one(2, 0, true));
  expect(shown().sort()).toEqual(["2w0", "2w1"]);
});

test("a sweep whose part was dropped is shown when the next one comes", () => {
  sweeps.add(one(1, 0, true, true));
  sweeps.add(one(2, 1, true, true));
  sweeps.add(one(3, 0, true));
  expect(shown()).toEqual(["2w1"]);
});

test("what is late is not shown over what is newer", () => {
  sweeps.add(one(2, 0, true, true));
  sweeps.add(one(1, 0, true, true));
  sweeps.add(one(2, 0, false));
  expect(shown()).toEqual(["2w0"]);
});

test("chunks alone do not pile up", () => {
  for (let sweep = 1; sweep <= 5; ++sweep) sweeps.add(one(sweep, 0, false));
  expect(shown()).toEqual(["4c0", "5c0"]);
});

test("a log that begins anew is shown from its beginning", () => {
  sweeps.add(one(1e9, 0, true, true));
  sweeps.add(one(1, 0, true, true));
  expect(shown()).toEqual(["1w0"]);
});
