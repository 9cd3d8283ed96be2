// From where a cloud fills the canvas.
import { Matrix4, Quaternion, Vector3 } from "three";
import type { Vec3 } from "../protocol";
import { isInside, kEverything, type Box } from "./crop";
import { forSample, type Points } from "./points";

const kSample = 4000; // points that are looked at
const kQuantile = 0.02; // of them beyond each side of the canvas: outliers
const kMargin = 0.94; // share of the canvas that they fill
const kLeastSeen = 50;

/// What the view is fitted to: points that a camera saw, or all where hardly any was; x y z each [m].
/// Only within `limits`.
export function subjectOf(shown: Points[], limits: Box = kEverything): Float32Array {
  const seen: number[] = [], all: number[] = [];
  forSample(shown, kSample, ({ floats, words }, at) => {
    const point = [floats[at], floats[at + 1], floats[at + 2]];
    if (!point.every(Number.isFinite) || !isInside(limits, point[0], point[1], point[2])) return;
    all.push(...point);
    if (words[at + 6] >>> 16) seen.push(...point);
  });
  return Float32Array.from(seen.length >= 3 * kLeastSeen ? seen : all);
}

export function quantile(sorted: ArrayLike<number>, share: number): number {
  return sorted[Math.round(share * (sorted.length - 1))];
}

/// Some of the points, seen or not; x y z each [m].
export function sampleOf(shown: Points[]): Float32Array {
  const all: number[] = [];
  forSample(shown, kSample, ({ floats }, at) => {
    if (Number.isFinite(floats[at] + floats[at + 1] + floats[at + 2])) all.push(floats[at], floats[at + 1], floats[at + 2]);
  });
  return Float32Array.from(all);
}

/// Robust extents of x y z triples, in each axis from the 2nd to the 98th percentile; null: no points.
export function extentsOf(points: Float32Array): Box | null {
  if (points.length === 0) return null;
  const sorted = [0, 1, 2].map((axis) => points.filter((_, i) => i % 3 === axis).sort());
  const at = (share: number) => sorted.map((values) => quantile(values, share)) as Vec3;
  return { low: at(kQuantile), high: at(1 - kQuantile) };
}

/// Where people look first: somewhat behind the LIDAR, above it and to its left, towards the nearer
/// part of the subject, which stands in front of the walls. The direction of view.
export function firstDirection(subject: Float32Array, lidar: Vector3): Vector3 {
  const points: Vector3[] = [];
  for (let i = 0; i < subject.length; i += 3) points.push(new Vector3().fromArray(subject, i).sub(lidar));
  points.sort((a, b) => a.lengthSq() - b.lengthSq());
  const nearer = points.slice(0, Math.ceil(0.6 * points.length));
  const middle = (axis: "x" | "y" | "z") => nearer.map((point) => point[axis]).sort((a, b) => a - b)[nearer.length >> 1] ?? 0;
  const target = new Vector3(middle("x"), middle("y"), middle("z"));
  const ahead = new Vector3(target.x, target.y, 0);
  if (ahead.length() < 1e-3) ahead.set(1, 0, 0);
  ahead.normalize();
  const left = new Vector3(-ahead.y, ahead.x, 0);
  const distance = Math.max(0.5, target.length());
  const eye = ahead.clone().multiplyScalar(-0.25).addScaledVector(left, 0.3).add(new Vector3(0, 0, 0.25)).multiplyScalar(distance);
  return target.sub(eye).normalize();
}

export interface Fitted { position: Vector3; target: Vector3 }

/// The camera's position from which nearly all of `subject` (x y z each) fills the canvas, without
/// turning it. A side of the canvas is a plane through the position: as the camera stands, points lie
/// beyond it by x - slope * depth, and a position moves all of them alike. So the quantiles of that are
/// where the planes go. `slope`: half the canvas' height at a distance of 1. Null: no points.
export function fit(subject: Float32Array, turned: Quaternion, slope: number, aspect: number): Fitted | null {
  if (subject.length === 0) return null;
  const view_from_world = new Matrix4().makeRotationFromQuaternion(turned).transpose();
  const axes = { x: [] as number[], y: [] as number[], depth: [] as number[] };
  const point = new Vector3();
  for (let i = 0; i < subject.length; i += 3) {
    point.fromArray(subject, i).applyMatrix4(view_from_world);
    axes.x.push(point.x);
    axes.y.push(point.y);
    axes.depth.push(-point.z);
  }
  const sides = (values: number[], half: number) => {
    const ends = (sign: number) => values.map((value, i) => value + sign * half * axes.depth[i]).sort((a, b) => a - b);
    const high = quantile(ends(-1), 1 - kQuantile), low = quantile(ends(1), kQuantile);
    return { middle: (low + high) / 2, depth: (low - high) / (2 * half) };
  };
  const x = sides(axes.x, kMargin * slope * aspect), y = sides(axes.y, kMargin * slope);
  const depth = Math.min(x.depth, y.depth);
  const middle = quantile(axes.depth.sort((a, b) => a - b), 0.5);
  const world = (forward: number) => new Vector3(x.middle, y.middle, -forward).applyQuaternion(turned);
  return { position: world(depth), target: world(Math.max(middle, depth + 0.2)) };
}

/// How a camera is turned that looks in a direction, z up. Straight down or up it is a little off, as
/// it would have no up.
export function turnTowards(direction: Vector3): Quaternion {
  const towards = direction.clone().normalize();
  if (Math.hypot(towards.x, towards.y) < 1e-3) towards.add(new Vector3(1e-3, 0, 0)).normalize();
  const eye = new Vector3();
  return new Quaternion().setFromRotationMatrix(new Matrix4().lookAt(eye, towards, new Vector3(0, 0, 1)));
}
