// Tables of 256 colours: perceptual ones for values, one colour a combination of cameras.
import { interpolateInferno, interpolateTurbo, interpolateViridis } from "d3-scale-chromatic";

import type { CameraInfo } from "../protocol";

export type Colour = "rgb" | "temperature" | "depth" | "intensity" | "cameras" | "blend";
export const kColours: { id: Colour; name: string; unit: string }[] = [
  { id: "rgb", name: "Colour (RGB)", unit: "" },
  { id: "temperature", name: "Temperature", unit: "°C" },
  { id: "depth", name: "Distance", unit: "m" },
  { id: "intensity", name: "Intensity", unit: "" },
  { id: "cameras", name: "Cameras", unit: "" },
  { id: "blend", name: "Colour + temperature", unit: "°C" },
];

/// What these cameras let be shown, the best first; null: it is not known which there are.
export function coloursOf(cameras: Pick<CameraInfo, "kind">[] | null): Colour[] {
  const has = (kind: CameraInfo["kind"]) => !cameras || cameras.some((camera) => camera.kind === kind);
  const [color, thermal] = [has("color"), has("thermal")];
  const offered: [Colour, boolean][] = [
    ["rgb", color], ["temperature", thermal], ["blend", color && thermal], ["depth", true], ["intensity", true], ["cameras", color || thermal],
  ];
  return offered.filter(([, there]) => there).map(([id]) => id);
}

/// The darkest ends cannot be told from a dark ground.
const warm = (t: number) => interpolateInferno(0.12 + 0.88 * t);
const kRamps: Partial<Record<Colour, (t: number) => string>> = {
  temperature: warm,
  blend: warm,
  depth: (t) => interpolateTurbo(0.05 + 0.93 * t),
  intensity: (t) => interpolateViridis(t),
};

/// Of Okabe and Ito, whom nobody confuses; further ones at the golden angle.
const kCombinations = ["#e69f00", "#56b4e9", "#009e73", "#f0e442", "#0072b2", "#d55e00", "#cc79a7"];

export function cameraColor(valid: number): string {
  return kCombinations[valid - 1] ?? `hsl(${Math.round((valid * 137.5) % 360)} 70% 55%)`;
}

export function rampColor(colour: Colour, t: number): string {
  return colour === "cameras" ? cameraColor(Math.round(t * 255)) : (kRamps[colour]?.(t) ?? "#888888");
}

/// CSS of the legend's bar.
export function gradient(colour: Colour): string {
  return `linear-gradient(to right, ${Array.from({ length: 17 }, (_, i) => rampColor(colour, i / 16)).join(", ")})`;
}

/// 256 x RGBA; of "cameras" the entry is `valid`, beyond 8 cameras the last.
export function table(colour: Colour): Uint8Array<ArrayBuffer> {
  const canvas = document.createElement("canvas");
  canvas.width = 256;
  canvas.height = 1;
  const context = canvas.getContext("2d", { willReadFrequently: true })!;
  for (let i = 0; i < 256; ++i) {
    context.fillStyle = rampColor(colour, i / 255);
    context.fillRect(i, 0, 1, 1);
  }
  return new Uint8Array(context.getImageData(0, 0, 256, 1).data);
}
