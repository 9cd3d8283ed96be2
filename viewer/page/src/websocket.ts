// The connection to the bridge. It is made again for ever; what is on the screen stays there.
import { effect } from "@preact/signals";
import { decodeFrame, type ToBridge } from "./protocol";
import { connection, notices, setSender, take, watched } from "./store";

const kBackoffMs = { first: 500, most: 5000 };
const kTokenKey = "rgbdt-token";

/// Of "#token=...", which then leaves the address; else as kept for a reload of this tab.
function readToken(): string {
  const given = /^#token=(.*)$/.exec(location.hash)?.[1];
  try {
    if (given === undefined) return sessionStorage.getItem(kTokenKey) ?? "";
    sessionStorage.setItem(kTokenKey, decodeURIComponent(given));
    history.replaceState(null, "", location.pathname + location.search);
  } catch {
    // No storage: the address keeps it.
  }
  return decodeURIComponent(given ?? "");
}

function complain(text: string): void {
  notices.value = [...notices.value.slice(-4), { type: "notice", level: "error", text, at: Date.now() }];
}

function onBytes(bytes: ArrayBuffer): void {
  try {
    take(decodeFrame(bytes));
  } catch (error) {
    complain(`Received data that cannot be read: ${error}`);
  }
}

export function connect(): void {
  const token = readToken();
  let socket: WebSocket | null = null;
  let backoff = kBackoffMs.first;
  let said = "";
  const say = (message: ToBridge) => {
    if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify(message));
  };
  // A page that nobody sees wants nothing: without animation frames it could not say what it drew.
  const watch = () => say(document.hidden
    ? { type: "watch", ...watched.peek(), cloud: false, cameras: [], overlay_cloud: false }
    : { type: "watch", ...watched.peek() });

  const open = () => {
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    socket = new WebSocket(`${scheme}://${location.host}/ws`);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      backoff = kBackoffMs.first;
      connection.value = "open";
      say({ type: "hello", token });
      watch();
    };
    socket.onmessage = (event) => { if (event.data instanceof ArrayBuffer) onBytes(event.data); };
    socket.onclose = ({ reason }) => {
      connection.value = "lost";
      // It is tried again and again: said once.
      if (reason !== "" && reason !== said) complain(`The viewer closed the connection: ${reason}`);
      said = reason;
      setTimeout(open, backoff);
      backoff = Math.min(2 * backoff, kBackoffMs.most);
    };
  };
  setSender(say);
  effect(() => { void watched.value; watch(); });
  document.addEventListener("visibilitychange", watch);
  // An address with a token, pasted while the page is open, loads nothing by itself.
  addEventListener("hashchange", () => { if (location.hash.startsWith("#token=")) location.reload(); });
  open();
}
