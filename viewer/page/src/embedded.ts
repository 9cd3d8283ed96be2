// Frames that a report carries in itself, one an element, base64.
import { decodeFrame } from "./protocol";
import { connection, notices, take } from "./store";

function bytesOf(base64: string): ArrayBuffer {
  return Uint8Array.from(atob(base64.trim()), (letter) => letter.charCodeAt(0)).buffer;
}

/// Takes them all; false where there are none.
export function takeEmbedded(): boolean {
  const elements = document.querySelectorAll('script[type="application/x-rgbdt-frames"]');
  for (const element of elements) {
    try {
      take(decodeFrame(bytesOf(element.textContent ?? "")));
    } catch (error) {
      notices.value = [{ type: "notice", level: "error", text: `A frame of this report is damaged: ${error}`, at: Date.now() }];
    }
    element.remove(); // their text would be kept twice
  }
  if (elements.length > 0) connection.value = "embedded";
  return elements.length > 0;
}
