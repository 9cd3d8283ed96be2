// Frames as the bridge writes them.
import type { ArrayInfo, Header } from "../protocol";

type Values = Uint8Array | Float32Array;
type Unsent = Header extends infer H ? (H extends { arrays: ArrayInfo[] } ? Omit<H, "arrays"> : H) : never;

const padded = (size: number): number => (size + 7) & ~7;

export function encodeFrame(id: number, header: Unsent, arrays: Record<string, Values> = {}): ArrayBuffer {
  const infos: ArrayInfo[] = Object.entries(arrays).map(([name, values]) =>
    ({ name, type: values instanceof Float32Array ? "f32" : "u8", length: values.length }));
  const json = new TextEncoder().encode(JSON.stringify(infos.length > 0 ? { ...header, arrays: infos } : header));
  const size = padded(8 + json.length) - 8;
  const total = Object.values(arrays).reduce((at, values) => padded(at) + values.byteLength, 8 + size);
  const bytes = new Uint8Array(total).fill(32, 8, 8 + size);
  const view = new DataView(bytes.buffer);
  view.setUint32(0, id, true);
  view.setUint32(4, size, true);
  bytes.set(json, 8);
  let at = 8 + size;
  for (const values of Object.values(arrays)) {
    at = padded(at);
    bytes.set(new Uint8Array(values.buffer, values.byteOffset, values.byteLength), at);
    at += values.byteLength;
  }
  return bytes.buffer;
}
