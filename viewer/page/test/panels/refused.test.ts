import { expect, test } from "vitest";
import { refusalsOf } from "../../src/panels/session/refused";
import type { BusFrame, SessionFrame } from "../../src/protocol";

const process = (name: string, last_problem: string) => ({ process: name, last_problem }) as BusFrame["processes"][number];
const cameras = (...calibrated: boolean[]) => calibrated.map((each) => ({ calibrated: each })) as SessionFrame["cameras"];

test("a refused calibration is told, once, as long as a camera has none", () => {
  const why = "CALIBRATION: the calibration of camera rgb was made with another rig: fx: 1300 -> 1310";
  const all = [process("viewer", why), process("fuser", why), process("detector", "RGB_IMAGE: too short"), process("viewer", why)];
  const told = refusalsOf(all, cameras(true, false));
  expect(told).toHaveLength(2);
  expect(told[0]).toMatch(/^viewer: the calibration of camera rgb .* fx/);
  expect(refusalsOf(all, cameras(true, true))).toEqual([]);
  expect(refusalsOf([process("viewer", "")], cameras(false))).toEqual([]);
});
