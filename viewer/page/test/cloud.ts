// Clouds for tests, through the bytes that a bridge would send.
import { partOf, type Part } from "../src/cloud/points";
import { encodeFrame } from "../src/mock/encode";
import { decodeFrame, kPointBytes, kPointOffsets, type CloudFrame, type Vec3 } from "../src/protocol";

export interface TestPoint { at: Vec3; color?: Vec3; intensity?: number; kelvin?: number; valid?: number; offset?: number }

export function part(points: TestPoint[], header: Partial<CloudFrame> = {}): Part {
  const view = new DataView(new ArrayBuffer(points.length * kPointBytes));
  points.forEach(({ at, color, intensity, kelvin, valid, offset }, i) => {
    const record = i * kPointBytes;
    at.forEach((value, axis) => view.setFloat32(record + 4 * axis, value, true));
    color?.forEach((value, band) => view.setUint8(record + kPointOffsets.color + band, value));
    view.setUint8(record + kPointOffsets.intensity, intensity ?? 255);
    view.setFloat32(record + kPointOffsets.temperature, kelvin ?? NaN, true);
    view.setFloat32(record + kPointOffsets.counts, NaN, true);
    view.setUint16(record + kPointOffsets.sigma, kelvin === undefined ? 65535 : 150, true);
    view.setUint16(record + kPointOffsets.valid, valid ?? 0, true);
    view.setUint32(record + kPointOffsets.time, offset ?? 0, true);
  });
  const frame = decodeFrame(encodeFrame(1, {
    type: "cloud", view: "", sweep_utime: 1e15, whole: true, part: 0, sweep_end: true, utime: 1e15, cameras: ["rgb", "thermal"],
    calibrated: [true, true], map_from_lidar: null, count: points.length, ...header,
  }, { points: new Uint8Array(view.buffer) }));
  return partOf(frame.header as CloudFrame, frame);
}
