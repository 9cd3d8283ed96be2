// From one point to another.
import type { Vec3 } from "../protocol";

export interface Measured { distance: number; difference: Vec3 } // [m]

export function measured(from: Vec3, to: Vec3): Measured {
  const difference = to.map((value, axis) => value - from[axis]) as Vec3;
  return { distance: Math.hypot(...difference), difference };
}

/// The ends after another point was tapped: two at most, a third begins anew.
export const withPoint = (ends: Vec3[], point: Vec3): Vec3[] => (ends.length >= 2 ? [point] : [...ends, point]);
