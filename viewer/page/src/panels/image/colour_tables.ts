// 256 steps of a perceptual colour map.
import { interpolateInferno, interpolateTurbo } from "d3-scale-chromatic";

const kSteps = 256;

function tableOf(map: (at: number) => string): string[] {
  return Array.from({ length: kSteps }, (_, i) => map(i / (kSteps - 1)));
}

export const kTurbo = tableOf(interpolateTurbo); // CSS colours
const kInferno = tableOf(interpolateInferno);

/// Of a value from `low` to `high`; beyond them the end's colour.
export function colourAt(table: string[], value: number, low: number, high: number): string {
  const at = high > low ? (value - low) / (high - low) : 0;
  const step = Math.max(0, Math.min(kSteps - 1, Math.round(at * (kSteps - 1))));
  return table[step] ?? "#000";
}

/// For a legend: the map from left to right.
export function gradientOf(name: "turbo" | "inferno" | "grey"): string {
  if (name === "grey") return "linear-gradient(to right, #000, #fff)";
  const table = name === "turbo" ? kTurbo : kInferno;
  const stops = Array.from({ length: 17 }, (_, i) => table[Math.min(kSteps - 1, i * 16)]);
  return `linear-gradient(to right, ${stops.join(", ")})`;
}

function channels(css: string): [number, number, number] {
  const hex = /^#(..)(..)(..)$/.exec(css);
  if (hex) return [parseInt(hex[1]!, 16), parseInt(hex[2]!, 16), parseInt(hex[3]!, 16)];
  const rgb = css.match(/\d+/g) ?? [];
  return [Number(rgb[0] ?? 0), Number(rgb[1] ?? 0), Number(rgb[2] ?? 0)];
}

/// A grey image in inferno's colours.
export function falseColoured(image: HTMLImageElement): HTMLCanvasElement {
  const canvas = document.createElement("canvas");
  canvas.width = image.naturalWidth;
  canvas.height = image.naturalHeight;
  const context = canvas.getContext("2d", { willReadFrequently: true })!;
  context.drawImage(image, 0, 0);
  const pixels = context.getImageData(0, 0, canvas.width, canvas.height);
  const table = kInferno.map(channels);
  for (let i = 0; i < pixels.data.length; i += 4) pixels.data.set(table[pixels.data[i]!]!, i);
  context.putImageData(pixels, 0, 0);
  return canvas;
}
