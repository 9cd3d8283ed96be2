// What a person set in the Cloud panel, and what is read from it.
import { signal } from "@preact/signals";
import type { Vec3 } from "../protocol";
import type { Colour } from "./color_maps";
import { kEverything, type Box, type Section } from "./crop";
import type { PointValues } from "./points";

export type Mode = "sweep" | "map";
export type Ranged = "temperature" | "depth" | "intensity";
export interface Range { auto: boolean; low: number; high: number }

export const mode = signal<Mode>("sweep");
export const colour = signal<Colour>("rgb");
export const pointSize = signal(1); // times what closes the gaps
export const lighting = signal(true); // eye-dome lighting
export const dark = signal(true); // behind the cloud
export const voxel = signal(0.05); // of the map [m]
/// The legends' ends [°C, m, intensity].
export const ranges = signal<Record<Ranged, Range>>({
  temperature: { auto: true, low: 15, high: 40 },
  depth: { auto: true, low: 0, high: 20 },
  intensity: { auto: true, low: 0, high: 254 },
});
export const picked = signal<PointValues | null>(null);
/// Of what is shown.
export const stats = signal({ points: 0, budget: 0, voxel_m: 0, frame: "lidar" as "lidar" | "map", cameras: [] as string[], renderer: "" });

export const blend = signal(0.5); // of the temperature, the rest of the colour
export const crop = signal<Box | null>(null); // what is shown; null: all
export const section = signal<Section | null>(null);
/// About where points are, in the frame that is shown.
export const extents = signal<Box>(kEverything);
export const measuring = signal(false);
export const ends = signal<Vec3[]>([]); // of what is measured
export const cutaway = signal(true); // what stands before the LIDAR, and no camera saw, is left out
export const showGrid = signal(true);
export const showCameras = signal(true);

/// Which legend a colour has; null: none with ends.
export function rangedBy(which: Colour): Ranged | null {
  const ranged = which === "blend" ? "temperature" : which;
  return ranged in ranges.peek() ? (ranged as Ranged) : null;
}

export function setRange(which: Ranged, change: Partial<Range>): void {
  ranges.value = { ...ranges.peek(), [which]: { ...ranges.peek()[which], ...change } };
}
