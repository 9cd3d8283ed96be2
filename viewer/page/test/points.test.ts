import { expect, test } from "vitest";
import { valuesOf } from "../src/cloud/points";
import { encodeFrame } from "../src/mock/encode";
import { decodeFrame } from "../src/protocol";
import { part } from "./cloud";

test("a point's values are those of its record", () => {
  const points = part([
    { at: [9, 9, 9] },
    { at: [1, -2, 0.5], color: [10, 20, 30], intensity: 200, kelvin: 300, valid: 2, offset: 1234 },
  ]);
  expect(valuesOf(points, 1)).toEqual({
    position: [1, -2, 0.5], color: [10, 20, 30], intensity: 200, kelvin: 300, sigma_k: 0.15, counts: null,
    cameras: ["thermal"], utime: 1e15 + 1234, sweep: 1e15,
  });
});

test("what is unknown is null", () => {
  expect(valuesOf(part([{ at: [1, 2, 3] }]), 0)).toMatchObject(
    { color: null, intensity: null, kelvin: null, sigma_k: null, cameras: [] });
});

test("a thinned frame holds the records that came", () => {
  const bytes = encodeFrame(1, { type: "cloud", view: "", sweep_utime: 0, whole: true, part: 0, sweep_end: true, utime: 0, cameras: [],
    calibrated: [], map_from_lidar: null, count: 4 }, { points: new Uint8Array(4 * 32) });
  expect(decodeFrame(bytes.slice(0, bytes.byteLength - 64)).arrays.get("points")?.length).toBe(64);
});

test("a header that is longer than its frame is refused with both sizes", () => {
  const bytes = encodeFrame(1, { type: "notice", level: "info", text: "" });
  new DataView(bytes).setUint32(4, 5000, true);
  expect(() => decodeFrame(bytes)).toThrow(`5000 bytes in a frame of ${bytes.byteLength}`);
});
