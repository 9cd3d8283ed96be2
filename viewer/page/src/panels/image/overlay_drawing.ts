// An overlay on a canvas. The colours stand on any image, so they do not follow the theme; every
// mark has a dark rim.
import type { ShownOverlay } from "../../store";
import type { Vec2 } from "../../protocol";
import { colourAt, kTurbo } from "./colour_tables";
import { classOf, kResidualClasses } from "./residuals";
import type { ResidualClass } from "./residuals";
import { toScreen } from "./viewport";
import type { Viewport } from "./viewport";

export interface OverlaySwitches { corners: boolean; outline: boolean; edge: boolean; cloud: boolean }
export interface DepthRange { low: number; high: number } // [m]

const kRim = "rgba(0, 0, 0, 0.75)";
const kOutline = "#ff4df0";
const kCorners = "#4de1ff";

// Drawing and legend ask for it, and every pan draws.
const ranges = new WeakMap<Float32Array, DepthRange | null>();

/// 2nd to 98th percentile, whole tenths of a metre; null: no points.
export function depthRange(cloud: Float32Array): DepthRange | null {
  const known = ranges.get(cloud);
  if (known !== undefined) return known;
  const range = rangeOf(cloud);
  ranges.set(cloud, range);
  return range;
}

function rangeOf(cloud: Float32Array): DepthRange | null {
  const depths = cloud.filter((_, i) => i % 3 === 2).sort();
  if (depths.length === 0) return null;
  const at = (share: number): number => depths[Math.floor(share * (depths.length - 1))]!;
  return { low: Math.floor(at(0.02) * 10) / 10, high: Math.ceil(at(0.98) * 10) / 10 };
}

function drawCloud(context: CanvasRenderingContext2D, at: Viewport, cloud: Float32Array): void {
  const range = depthRange(cloud);
  if (!range) return;
  const size = Math.max(2, Math.min(6, at.scale * 2));
  for (let i = 0; i + 2 < cloud.length; i += 3) {
    const [x, y] = toScreen(at, [cloud[i]!, cloud[i + 1]!]);
    context.fillStyle = colourAt(kTurbo, cloud[i + 2]!, range.low, range.high);
    context.fillRect(x - size / 2, y - size / 2, size, size);
  }
}

export function chain(context: CanvasRenderingContext2D, points: Vec2[], closed: boolean): void {
  context.beginPath();
  points.forEach(([x, y], i) => (i === 0 ? context.moveTo(x, y) : context.lineTo(x, y)));
  if (closed) context.closePath();
}

export function strokeRimmed(context: CanvasRenderingContext2D, colour: string, width: number): void {
  context.lineWidth = width + 2;
  context.strokeStyle = kRim;
  context.stroke();
  context.lineWidth = width;
  context.strokeStyle = colour;
  context.stroke();
}

function pairs(at: Viewport, values: Float32Array): Vec2[] {
  const out: Vec2[] = [];
  for (let i = 0; i + 1 < values.length; i += 2) out.push(toScreen(at, [values[i]!, values[i + 1]!]));
  return out;
}

function drawOutline(context: CanvasRenderingContext2D, at: Viewport, outline: Float32Array): void {
  if (outline.length === 0) return;
  chain(context, pairs(at, outline), true);
  strokeRimmed(context, kOutline, 2);
}

/// Small on a small image, so that they leave something of it to see [CSS px].
function markRadius(at: Viewport): number {
  return Math.min(5, 2 + 2 * at.scale);
}

function drawCorners(context: CanvasRenderingContext2D, at: Viewport, corners: Float32Array): void {
  const reach = 1.5 * markRadius(at);
  for (const [x, y] of pairs(at, corners)) {
    context.beginPath();
    context.moveTo(x - reach, y);
    context.lineTo(x + reach, y);
    context.moveTo(x, y - reach);
    context.lineTo(x, y + reach);
    strokeRimmed(context, kCorners, 1);
  }
}

function traceMark(context: CanvasRenderingContext2D, mark: ResidualClass["mark"], x: number, y: number, r: number): void {
  context.beginPath();
  if (mark === "dot" || mark === "ring") context.arc(x, y, r, 0, 2 * Math.PI);
  else if (mark === "square") context.rect(x - r, y - r, 2 * r, 2 * r);
  else {
    context.moveTo(x - r, y - r);
    context.lineTo(x + r, y + r);
    context.moveTo(x + r, y - r);
    context.lineTo(x - r, y + r);
  }
}

function drawEdge(context: CanvasRenderingContext2D, at: Viewport, edge: Float32Array): void {
  // The worst last: they are what a person looks for.
  for (const wanted of [3, 0, 1, 2]) {
    const { mark, colour } = kResidualClasses[wanted]!;
    for (let i = 0; i + 2 < edge.length; i += 3) {
      if (classOf(edge[i + 2]!) !== wanted) continue;
      const [x, y] = toScreen(at, [edge[i]!, edge[i + 1]!]);
      traceMark(context, mark, x, y, markRadius(at));
      if (mark === "cross" || mark === "ring") {
        strokeRimmed(context, colour, 1.5);
      } else {
        context.fillStyle = colour;
        context.fill();
        context.lineWidth = 1;
        context.strokeStyle = kRim;
        context.stroke();
      }
    }
  }
}

export function drawOverlay(
  context: CanvasRenderingContext2D, at: Viewport, overlay: ShownOverlay, switches: OverlaySwitches,
): void {
  if (switches.cloud) drawCloud(context, at, overlay.cloud);
  if (switches.outline) drawOutline(context, at, overlay.outline);
  if (switches.corners) drawCorners(context, at, overlay.corners);
  if (switches.edge) drawEdge(context, at, overlay.edge);
}

export const kOverlayColours = { corners: kCorners, outline: kOutline };
