// What a person set in the Cloud panel, and what is read from it.
import { signal } from "@preact/signals";
import type { Colour } from "./color_maps";
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

export const isRanged = (which: Colour): which is Ranged => which in ranges.peek();

export function setRange(which: Ranged, change: Partial<Range>): void {
  ranges.value = { ...ranges.peek(), [which]: { ...ranges.peek()[which], ...change } };
}
