// Where an image lies on the screen. Image pixels have their centres at integers; the screen counts
// CSS pixels from the canvas' upper left corner.
import type { Vec2 } from "../../protocol";

export interface Size { width: number; height: number }

/// screen = (image + 0.5) * scale + (x, y)
export interface Viewport { scale: number; x: number; y: number }

const kMostScale = 64; // [CSS px per image px]

export function toScreen(at: Viewport, [u, v]: Vec2): Vec2 {
  return [(u + 0.5) * at.scale + at.x, (v + 0.5) * at.scale + at.y];
}

export function toImage(at: Viewport, [x, y]: Vec2): Vec2 {
  return [(x - at.x) / at.scale - 0.5, (y - at.y) / at.scale - 0.5];
}

/// The whole image, in the middle.
export function fitted(screen: Size, image: Size): Viewport {
  const scale = Math.min(screen.width / image.width, screen.height / image.height);
  return {
    scale,
    x: (screen.width - scale * image.width) / 2,
    y: (screen.height - scale * image.height) / 2,
  };
}

/// An image that is larger than the screen covers it; one that is smaller stands in the middle.
function held(at: number, screen: number, length: number): number {
  return length <= screen ? (screen - length) / 2 : Math.min(0, Math.max(screen - length, at));
}

function heldInside(at: Viewport, screen: Size, image: Size): Viewport {
  return {
    scale: at.scale,
    x: held(at.x, screen.width, at.scale * image.width),
    y: held(at.y, screen.height, at.scale * image.height),
  };
}

export function panned(at: Viewport, dx: number, dy: number, screen: Size, image: Size): Viewport {
  return heldInside({ ...at, x: at.x + dx, y: at.y + dy }, screen, image);
}

/// What is under `centre` (screen) stays there, where the image's border allows it.
export function zoomed(at: Viewport, factor: number, [cx, cy]: Vec2, screen: Size, image: Size): Viewport {
  const least = fitted(screen, image).scale;
  const scale = Math.min(Math.max(at.scale * factor, least), Math.max(least, kMostScale));
  const grown = scale / at.scale;
  return heldInside({ scale, x: cx - (cx - at.x) * grown, y: cy - (cy - at.y) * grown }, screen, image);
}
