import { kPointBytes, kPointOffsets, type CloudFrame } from "../protocol";
import { boardAt, kCameras, project, sample } from "./scene";

/// Records of `count` random points, see PointView in the protocol.
function records(count: number, seconds: number): Uint8Array {
  const view = new DataView(new ArrayBuffer(count * kPointBytes));
  const board = boardAt(seconds);
  for (let i = 0; i < count; ++i) {
    const at = i * kPointBytes;
    const { at: point, color, kelvin, intensity } = sample(seconds, board);
    const valid = kCameras.reduce((mask, camera, bit) => {
      const pixel = project(camera, point);
      const seen = pixel && pixel[0] >= 0 && pixel[0] < camera.width && pixel[1] >= 0 && pixel[1] < camera.height;
      return seen ? mask | (1 << bit) : mask;
    }, 0);
    point.forEach((value, axis) => view.setFloat32(at + 4 * axis, value + 0.01 * (Math.random() - 0.5), true));
    if (valid & 1) color.forEach((value, band) => view.setUint8(at + kPointOffsets.color + band, value));
    view.setUint8(at + kPointOffsets.intensity, intensity);
    view.setFloat32(at + kPointOffsets.temperature, valid & 2 ? kelvin + 0.2 * (Math.random() - 0.5) : NaN, true);
    view.setFloat32(at + kPointOffsets.counts, valid & 2 ? Math.round(kelvin / 0.04) : NaN, true);
    view.setUint16(at + kPointOffsets.sigma, valid & 2 ? 150 : 65535, true);
    view.setUint16(at + kPointOffsets.valid, valid, true);
    view.setUint32(at + kPointOffsets.time, Math.floor((i / count) * 900_000), true);
  }
  return new Uint8Array(view.buffer);
}

type Unsent = Omit<CloudFrame, "arrays">;
function header(sweep_utime: number, count: number): Omit<Unsent, "whole" | "part" | "sweep_end"> {
  return {
    type: "cloud", view: "", sweep_utime, utime: sweep_utime, cameras: kCameras.map(({ name }) => name),
    calibrated: kCameras.map(() => true), map_from_lidar: null, count, ack: true,
  };
}

/// A whole sweep of two parts.
export function wholeSweep(sweep_utime: number, points: number, seconds: number): { header: Unsent; points: Uint8Array }[] {
  const count = Math.floor(points / 2);
  return [0, 1].map((part) => ({
    header: { ...header(sweep_utime, count), whole: true, part, sweep_end: part === 1 },
    points: records(count, seconds),
  }));
}

export function chunk(sweep_utime: number, part: number, points: number, seconds: number): { header: Unsent; points: Uint8Array } {
  return {
    header: { ...header(sweep_utime, points), whole: false, part, sweep_end: false },
    points: records(points, seconds),
  };
}
