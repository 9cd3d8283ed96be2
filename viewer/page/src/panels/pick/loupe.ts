// A round magnifier beside the pointer.
import type { Vec2 } from "../../protocol";
import { chain, strokeRimmed } from "../image/overlay_drawing";
import { drawPicture } from "../image/image_canvas";
import type { Drawing } from "../image/image_canvas";
import { toImage, toScreen } from "../image/viewport";
import type { Size, Viewport } from "../image/viewport";

const kMagnified = 6;
const kRadius = 66, kAway = 44; // [CSS px]; away: a fingertip
const kMostScale = 128; // [CSS px per image px]

export const kPickColour = "#ffe14d";

/// Above the pointer; where there is no room, beside it.
export function loupeMiddle([x, y]: Vec2, size: Size): Vec2 {
  const reach = kRadius + kAway;
  const within = (at: number, length: number): number => Math.min(Math.max(at, kRadius + 2), Math.max(kRadius + 2, length - kRadius - 2));
  if (y - reach - kRadius >= 0) return [within(x, size.width), y - reach];
  return [x + reach + kRadius <= size.width ? x + reach : x - reach, within(y, size.height)];
}

/// Whether the loupe lies on that place of the screen.
export function loupeCovers(at: Vec2 | null, size: Size, place: Vec2): boolean {
  if (!at) return false;
  const [x, y] = loupeMiddle(at, size);
  return Math.hypot(place[0] - x, place[1] - y) < kRadius + 16;
}

function crosshair(context: CanvasRenderingContext2D, [x, y]: Vec2): void {
  context.beginPath();
  for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]] as const) {
    context.moveTo(x + 5 * dx, y + 5 * dy);
    context.lineTo(x + kRadius * dx, y + kRadius * dy);
  }
  strokeRimmed(context, kPickColour, 1);
}

/// `at`: what is magnified, on the screen.
export function drawLoupe({ context, viewport, size, image, picture }: Drawing, at: Vec2, corners: Vec2[]): void {
  const [x, y] = loupeMiddle(at, size);
  const [u, v] = toImage(viewport, at);
  const scale = Math.min(viewport.scale * kMagnified, kMostScale);
  const magnified: Viewport = { scale, x: x - (u + 0.5) * scale, y: y - (v + 0.5) * scale };
  context.save();
  context.beginPath();
  context.arc(x, y, kRadius, 0, 2 * Math.PI);
  context.clip();
  context.fillStyle = "#000";
  context.fill();
  drawPicture(context, picture, magnified, image);
  chain(context, corners.map((corner) => toScreen(magnified, corner)), corners.length > 2);
  strokeRimmed(context, kPickColour, 1);
  crosshair(context, [x, y]);
  context.restore();
  context.beginPath();
  context.arc(x, y, kRadius, 0, 2 * Math.PI);
  strokeRimmed(context, "#fff", 2);
}
