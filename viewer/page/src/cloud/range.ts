// A legend's ends, found from the points.
import type { Vec3 } from "../protocol";
import { forSample, type Points } from "./points";
import type { Colour } from "./color_maps";

const kSample = 4000; // values that are looked at

const kValue: Partial<Record<Colour, (points: Points, at: number, lidar: Vec3) => number>> = {
  temperature: ({ floats }, at) => floats[at + 4] - 273.15,
  depth: ({ floats }, at, [x, y, z]) => Math.hypot(floats[at] - x, floats[at + 1] - y, floats[at + 2] - z),
  intensity: ({ words }, at) => (words[at + 3] >>> 24 === 255 ? NaN : words[at + 3] >>> 24),
};

/// 1st and 99th percentile of what `colour` shows (°C, m from the LIDAR, intensity); null where no
/// point has it. `lidar`: where it is [m].
export function percentiles(shown: Points[], colour: Colour, lidar: Vec3): [number, number] | null {
  const value = kValue[colour];
  if (!value) return null;
  const values: number[] = [];
  forSample(shown, kSample, (points, at) => {
    const one = value(points, at, lidar);
    if (Number.isFinite(one)) values.push(one);
  });
  if (values.length === 0) return null;
  values.sort((a, b) => a - b);
  const at = (share: number) => values[Math.round(share * (values.length - 1))];
  return [at(0.01), Math.max(at(0.99), at(0.01) + 1e-3)];
}
