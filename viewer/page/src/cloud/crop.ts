// What of the cloud is shown: a box, and a slice across an axis.
import type { Vec3 } from "../protocol";

export interface Box { low: Vec3; high: Vec3 } // [m]
export interface Section { axis: 0 | 1 | 2; middle: number; thickness: number } // [m]

export const kEverything: Box = { low: [-1e9, -1e9, -1e9], high: [1e9, 1e9, 1e9] };

/// Where both the box and the slice are; null: not cut by it.
export function limitsOf(crop: Box | null, section: Section | null): Box {
  const { low, high } = crop ?? kEverything;
  const limits: Box = { low: [...low], high: [...high] };
  if (!section) return limits;
  const { axis, middle, thickness } = section;
  limits.low[axis] = Math.max(low[axis], middle - thickness / 2);
  limits.high[axis] = Math.min(high[axis], middle + thickness / 2);
  return limits;
}

export function isInside({ low, high }: Box, x: number, y: number, z: number): boolean {
  return x >= low[0] && x <= high[0] && y >= low[1] && y <= high[1] && z >= low[2] && z <= high[2];
}

/// One end of a box put elsewhere; the other end gives way.
export function withEnd({ low, high }: Box, end: "low" | "high", axis: number, to: number): Box {
  const put = (from: Vec3, other: "low" | "high") => from.map((value, i) => {
    if (i !== axis) return value;
    if (end === other) return to;
    return other === "low" ? Math.min(value, to) : Math.max(value, to);
  }) as Vec3;
  return { low: put(low, "low"), high: put(high, "high") };
}

/// A little larger each way, whole decimetres.
export function padded({ low, high }: Box): Box {
  return {
    low: low.map((value) => Math.floor(10 * value - 1) / 10) as Vec3,
    high: high.map((value) => Math.ceil(10 * value + 1) / 10) as Vec3,
  };
}

/// The eight corners' twelve edges, as pairs of places.
export function edgesOf({ low, high }: Box): Vec3[] {
  const corner = (i: number): Vec3 => [0, 1, 2].map((axis) => (i & (1 << axis) ? high : low)[axis]) as Vec3;
  return [0, 1, 2].flatMap((axis) => [0, 1, 2, 3, 4, 5, 6, 7].filter((i) => !(i & (1 << axis))).flatMap((i) => [corner(i), corner(i | (1 << axis))]));
}
