// The newest of everything that the bridge said, as signals: a panel reads them and is drawn anew
// when they change. What is drawn by hand (the cloud) listens to `onCloud`.
import { signal } from "@preact/signals";
import type {
  BusFrame, CloudFrame, Frame, Hello, ImageFrame, NoticeFrame, OverlayFrame, RigFrame,
  MountsFrame, SessionFrame, TargetStatusFrame, ToBridge, WaveFrame,
} from "./protocol";
import { floats, octets } from "./protocol";

export type Connection = "connecting" | "open" | "lost" | "embedded";

/// An image as an object URL; `key` is keyOf(view, camera).
export interface ShownImage { header: ImageFrame; url: string }
export interface ShownOverlay {
  header: OverlayFrame;
  corners: Float32Array; // x y
  outline: Float32Array; // x y
  edge: Float32Array; // x y residual
  cloud: Float32Array; // x y depth
}

export const connection = signal<Connection>("connecting");
export const hello = signal<Hello | null>(null);
export const rig = signal<RigFrame | null>(null);
export const session = signal<SessionFrame | null>(null);
export const targetStatus = signal<TargetStatusFrame | null>(null);
export const mounts = signal<MountsFrame | null>(null);
export const wave = signal<WaveFrame | null>(null);
export const bus = signal<BusFrame | null>(null);
export const notices = signal<(NoticeFrame & { at: number })[]>([]);
export const images = signal<ReadonlyMap<string, ShownImage>>(new Map());
export const overlays = signal<ReadonlyMap<string, ShownOverlay>>(new Map());
export const thumbs = signal<ReadonlyMap<string, string>>(new Map()); // object URLs by keyOf

/// "" is the live view; camera "" is the board in the cloud.
export const keyOf = (view: string, camera: string): string => `${view}/${camera}`;

/// What is on the screen; the source tells the bridge whenever it changes.
export const watched = signal<{ cloud: boolean; cameras: string[]; overlay_cloud: boolean; points: number }>(
  { cloud: true, cameras: [], overlay_cloud: false, points: 100_000 });

type CloudListener = (header: CloudFrame, frame: Frame) => void;
const cloudListeners = new Set<CloudListener>();
export function onCloud(listener: CloudListener): () => void {
  cloudListeners.add(listener);
  return () => cloudListeners.delete(listener);
}

/// Set by the source (websocket.ts or embedded.ts).
let sender: (message: ToBridge) => void = () => undefined;
export function setSender(next: (message: ToBridge) => void): void { sender = next; }
export function send(message: ToBridge): void { sender(message); }
export function ack(frame: Frame): void { if (frame.id !== 0) sender({ type: "ack", id: frame.id }); }

function replaced<V>(map: ReadonlyMap<string, V>, key: string, value: V): ReadonlyMap<string, V> {
  const next = new Map(map);
  next.set(key, value);
  return next;
}

function urlOf(frame: Frame): string {
  return URL.createObjectURL(new Blob([octets(frame, "jpeg")], { type: "image/jpeg" }));
}

/// Takes a frame in. Frames that are to be acknowledged are so by who draws them: the cloud panel
/// its clouds; images and overlays here, at the next animation frame.
export function take(frame: Frame): void {
  const header = frame.header;
  switch (header.type) {
    case "hello": hello.value = header; break;
    case "rig": rig.value = header; break;
    case "session": session.value = header; break;
    case "target_status": targetStatus.value = header; break;
    case "mounts": mounts.value = header; break;
    case "wave": wave.value = header; break;
    case "bus": bus.value = header; break;
    case "notice": notices.value = [...notices.value.slice(-4), { ...header, at: Date.now() }]; break;
    case "image": {
      const key = keyOf(header.view, header.camera);
      const before = images.value.get(key);
      images.value = replaced(images.value, key, { header, url: urlOf(frame) });
      if (before) setTimeout(() => URL.revokeObjectURL(before.url), 2000);
      break;
    }
    case "thumb": {
      const key = keyOf(header.view, header.camera);
      const before = thumbs.value.get(key);
      thumbs.value = replaced(thumbs.value, key, urlOf(frame));
      if (before) setTimeout(() => URL.revokeObjectURL(before), 2000);
      break;
    }
    case "overlay":
      overlays.value = replaced(overlays.value, keyOf(header.view, header.camera), {
        header,
        corners: floats(frame, "corners").slice(),
        outline: floats(frame, "outline").slice(),
        edge: floats(frame, "edge").slice(),
        cloud: floats(frame, "cloud").slice(),
      });
      break;
    case "cloud":
      for (const listener of cloudListeners) listener(header, frame);
      if (cloudListeners.size === 0) ack(frame);
      return;
  }
  if ("ack" in header && header.ack) requestAnimationFrame(() => ack(frame));
}
