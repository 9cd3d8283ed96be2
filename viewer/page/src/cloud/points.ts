// Points as the bridge sends them, 32 bytes each, read where they lie: no object a point.
import { kPointBytes, kPointOffsets, type CloudFrame, type Frame, type Vec3 } from "../protocol";

export const kWords = kPointBytes / 4; // 32-bit words of a record
const kWord = { temperature: kPointOffsets.temperature / 4, counts: kPointOffsets.counts / 4, time: kPointOffsets.time / 4 };

/// Records, and what is known of all of them.
export interface Points {
  words: Uint32Array;
  floats: Float32Array; // of the same bytes
  count: number;
  cameras: string[]; // bit i of `valid`
  utimeOf(index: number): number; // [us]
  sweepOf(index: number): number; // its name, a utime
}

export interface Part extends Points {
  header: CloudFrame;
}

export function partOf(header: CloudFrame, frame: Frame): Part {
  const at = frame.arrays.get("points");
  const count = Math.floor((at?.length ?? 0) / kPointBytes);
  const words = new Uint32Array(frame.bytes, at?.offset ?? 0, count * kWords);
  return {
    header, words, floats: new Float32Array(words.buffer, words.byteOffset, words.length), count, cameras: header.cameras,
    utimeOf: (index) => header.utime + words[index * kWords + kWord.time],
    sweepOf: () => header.sweep_utime,
  };
}

/// Calls `visit` with some `most` points of `shown`, evenly: the points, and where the record begins.
export function forSample(shown: Points[], most: number, visit: (points: Points, at: number, index: number) => void): void {
  const total = shown.reduce((sum, { count }) => sum + count, 0);
  const step = Math.max(1, Math.floor(total / most));
  for (const points of shown) for (let i = 0; i < points.count; i += step) visit(points, i * kWords, i);
}

/// One point's values, for a person.
export interface PointValues {
  position: Vec3; // [m], in the frame of what is shown
  color: Vec3 | null;
  intensity: number | null; // 0 to 254
  kelvin: number | null;
  sigma_k: number | null;
  counts: number | null;
  cameras: string[]; // that saw it
  utime: number; // [us]
  sweep: number;
}

const finiteOrNull = (value: number): number | null => (Number.isFinite(value) ? value : null);

export function valuesOf(points: Points, index: number): PointValues {
  const at = index * kWords;
  const [x, y, z] = points.floats.subarray(at, at + 3);
  const colors = points.words[at + 3];
  const intensity = colors >>> 24;
  const sigma = points.words[at + 6] & 0xffff;
  const valid = points.words[at + 6] >>> 16;
  return {
    position: [x, y, z],
    color: colors & 0xffffff ? [colors & 255, (colors >>> 8) & 255, (colors >>> 16) & 255] : null,
    intensity: intensity === 255 ? null : intensity,
    kelvin: finiteOrNull(points.floats[at + kWord.temperature]),
    sigma_k: sigma === 65535 ? null : sigma / 1000,
    counts: finiteOrNull(points.floats[at + kWord.counts]),
    cameras: points.cameras.filter((_, bit) => valid & (1 << bit)),
    utime: points.utimeOf(index),
    sweep: points.sweepOf(index),
  };
}
