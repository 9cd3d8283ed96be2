// What is left out of the result, and the button that changes it.
import { useSignal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import type { SessionFrame, View } from "../../protocol";
import { connection, hello, notices, send } from "../../store";
import { howToKeep, movedWords, toggled, whyNotLeaveOut } from "./leave_out";

/// On top of the result: without which views it is, and how far that moved it.
export function LeftOutNote({ session }: { session: SessionFrame }) {
  const { views, moved } = session.left_out;
  if (views.length === 0) return null;
  return (
    <div class="left-out" data-testid="left-out">
      <p><strong>Without {views.length === 1 ? "view" : "views"} {views.join(", ")}.</strong> {howToKeep(session, connection.value, hello.value)}
        {moved.length > 0 && " Change of the pose from the result with all views (in sigmas of that result):"}</p>
      {moved.length > 0 && <ul class="plain">{moved.map((each) => <li key={each.camera} data-testid={`moved-${each.camera}`}>{movedWords(each)}</li>)}</ul>}
      {connection.value !== "embedded" && <button type="button" data-testid="take-all-back" disabled={whyNotLeaveOut(session, connection.value, hello.value) !== ""}
        onClick={() => send({ type: "leave_out", views: [] })}>Use all views again</button>}
    </div>
  );
}

export function LeaveOutButton({ session, view }: { session: SessionFrame; view: View }) {
  const asked = useSignal(false);
  useEffect(() => { asked.value = false; }, [session, notices.value, connection.value]);
  const why = whyNotLeaveOut(session, connection.value, hello.value);
  const ask = () => {
    asked.value = true;
    send({ type: "leave_out", views: toggled(session.left_out, view.name) });
  };
  return (
    <button type="button" disabled={why !== "" || asked.value} title={why} aria-pressed={view.left_out}
      data-testid={`leave-out-${view.name}`} onClick={ask}>
      {asked.value ? "Solving…" : view.left_out ? "Use again" : "Leave out"}
    </button>
  );
}

/// Once above all the buttons that cannot be pressed.
export function WhyNotLeaveOut({ session }: { session: SessionFrame }) {
  const why = whyNotLeaveOut(session, connection.value, hello.value);
  return why ? <p class="muted" data-testid="why-not-leave-out">{why}</p> : null;
}
