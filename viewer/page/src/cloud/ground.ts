// The ground below the LIDAR, and a grid on it.
import type { Box } from "./crop";
import type { Vec3 } from "../protocol";
import { quantile } from "./fit";

const kBin = 0.1; // [m]
const kProminent = 0.35; // of the fullest layer
const kMostLines = 12; // each way

/// Height of the lowest layer that holds many points; x y z triples [m]. Single points below it, as
/// mirrors make them, are not the ground.
export function groundHeight(points: Float32Array): number {
  const heights = points.filter((_, i) => i % 3 === 2).sort();
  if (heights.length === 0) return 0;
  const lowest = quantile(heights, 0.005);
  const counts: number[] = [];
  for (const height of heights) if (height >= lowest) {
    const bin = Math.floor((height - lowest) / kBin);
    if (bin < 10_000) counts[bin] = (counts[bin] ?? 0) + 1;
  }
  const layer = (bin: number) => (counts[bin] ?? 0) + (counts[bin + 1] ?? 0);
  const fullest = Math.max(...Array.from(counts, (_, bin) => layer(bin)));
  const found = Array.from(counts).findIndex((_, bin) => layer(bin) >= kProminent * fullest);
  const [from, to] = [lowest + found * kBin, lowest + (found + 2) * kBin];
  return quantile(heights.filter((height) => height >= from && height < to), 0.5);
}

/// A round distance between lines, so that they are not many [m].
export function gridStep(size: number): number {
  const least = Math.max(size / kMostLines, 0.1);
  const power = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map((step) => step * power).find((step) => step >= least * (1 - 1e-9)) ?? 10 * power;
}

export interface Grid { step: number; xs: number[]; ys: number[]; z: number }

/// Lines at multiples of a round step that enclose `extents`.
export function gridOf({ low, high }: Box, z: number): Grid {
  const step = gridStep(Math.max(high[0] - low[0], high[1] - low[1]));
  const lines = (axis: 0 | 1) => {
    const first = Math.floor(low[axis] / step), last = Math.ceil(high[axis] / step);
    return Array.from({ length: last - first + 1 }, (_, i) => (first + i) * step);
  };
  return { step, xs: lines(0), ys: lines(1), z };
}

/// Lines as pairs of places.
export function gridLines({ xs, ys, z }: Grid): Vec3[] {
  const [x0, x1, y0, y1] = [xs[0], xs[xs.length - 1], ys[0], ys[ys.length - 1]];
  return [...xs.flatMap((x): Vec3[] => [[x, y0, z], [x, y1, z]]), ...ys.flatMap((y): Vec3[] => [[x0, y, z], [x1, y, z]])];
}
