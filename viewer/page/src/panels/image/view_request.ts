// Asks the bridge for a view's images and overlays: once, and again when what was laid on them has
// changed.
import { useEffect } from "preact/hooks";
import type { SessionFrame } from "../../protocol";
import { connection, send, session } from "../../store";

/// Changes whenever the view's pictures do: its images, what was found in them, the calibrations.
export function stampOf(state: SessionFrame | null, view: string): string {
  if (!state) return "";
  const own = state.views.find((each) => each.name === view);
  const cameras = own?.cameras.map((each) => [each.camera, each.image_utime, each.state, each.picked]);
  return JSON.stringify([state.cameras.map((each) => [each.camera, each.utime]), cameras]);
}

/// "" asks for nothing: the live view comes by itself.
export function useViewRequest(view: string): void {
  const stamp = stampOf(session.value, view);
  const open = connection.value === "open";
  useEffect(() => {
    if (view !== "" && open) send({ type: "view", view });
  }, [view, stamp, open]);
}
