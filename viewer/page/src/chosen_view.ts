// The view of the session that the images and the cloud are of.
import { computed, effect, signal } from "@preact/signals";
import type { SessionFrame } from "./protocol";
import { connection, send, session } from "./store";

const chosen = signal<string | null>(null); // null: nobody chose yet; "": live

/// A finished session has no live image.
export const hasLive = computed(() => session.value?.mode !== "finished");

/// Of a finished session the last one, as long as nobody chose.
function viewOf(state: SessionFrame | null, wanted: string | null): string {
  const views = state?.views ?? [];
  if (wanted !== null && views.some(({ name }) => name === wanted)) return wanted;
  return hasLive.value ? "" : views[views.length - 1]?.name ?? "";
}

/// "": live.
export const shownView = computed(() => viewOf(session.value, chosen.value));

export function chooseView(view: string): void { chosen.value = view; }

/// Changes whenever the view's pictures do: its images, what was found in them, the calibrations.
export function stampOf(state: SessionFrame | null, view: string): string {
  if (!state) return "";
  const own = state.views.find((each) => each.name === view);
  const cameras = own?.cameras.map((each) => [each.camera, each.image_utime, each.state, each.picked]);
  return JSON.stringify([state.cameras.map((each) => [each.camera, each.utime]), cameras, state.left_out.views]);
}

/// Asks the bridge for a view's images, overlays and cloud; "" asks for nothing: live comes anyway.
export function askForView(view: string): void {
  if (view !== "" && connection.peek() === "open") send({ type: "view", view });
}

const wanted = computed(() => (connection.value === "open" ? `${shownView.value}\n${stampOf(session.value, shownView.value)}` : ""));

// Once, and again when what was laid on the images has changed.
effect(() => { if (wanted.value !== "") askForView(shownView.peek()); });
