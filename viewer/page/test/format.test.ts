import { expect, test } from "vitest";
import { utc } from "../src/format";
import { clock } from "../src/panels/words";

test("a time of the calendar has its date", () => {
  expect(utc(1_795_342_830_123_456)).toMatch(/^2026-11-22 10:20:30\.123456/);
  expect(clock(1_795_342_830_123_456)).toBe("10:20:30.123 UTC");
});

test("a clock that counts from when it was switched on has no date, and none has no time", () => {
  for (const say of [utc, clock]) {
    expect(say(12_500_000)).toMatch(/^12\.500000.s$/);
    expect(say(0)).toBe("–");
  }
});
