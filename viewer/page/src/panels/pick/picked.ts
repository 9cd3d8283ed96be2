// The corners picked so far, by image; they outlive the panel, so that a look at another tab costs
// nobody their work.
import { signal } from "@preact/signals";
import type { Vec2 } from "../../protocol";
import type { Sent } from "./outcome";

const corners = signal<ReadonlyMap<string, Vec2[]>>(new Map());
const sent = signal<ReadonlyMap<string, Sent>>(new Map());

export const cornersOf = (image: string): Vec2[] => corners.value.get(image) ?? [];
export const sentOf = (image: string): Sent | undefined => sent.value.get(image);

export function setCorners(image: string, next: Vec2[]): void {
  corners.value = new Map(corners.value).set(image, next);
}

export function setSent(image: string, next: Sent): void {
  sent.value = new Map(sent.value).set(image, next);
}
