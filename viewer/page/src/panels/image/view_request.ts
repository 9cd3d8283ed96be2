// Asks the bridge for a view's images and overlays: once, and again when what was laid on them has
// changed.
import { useEffect } from "preact/hooks";
import { askForView, stampOf } from "../../chosen_view";
import { connection, session } from "../../store";

/// "" asks for nothing: the live view comes by itself.
export function useViewRequest(view: string): void {
  const stamp = stampOf(session.value, view);
  const open = connection.value === "open";
  useEffect(() => { if (open) askForView(view); }, [view, stamp, open]);
}
