// What a person asks the session for.
import { useSignal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import type { RequestName, SessionFrame } from "../../protocol";
import { connection, hello, notices, send } from "../../store";
import { heldoutByDefault, whyNot } from "./permission";

const kNames: Record<RequestName, string> = {
  next_pose: "Next position",
  pose_is_set: "Board in position",
  capture: "Capture",
  finish: "Finish and save",
};

/// The request that nothing came back for yet: a second click would ask twice.
function useAsked(session: SessionFrame) {
  const asked = useSignal<RequestName | null>(null);
  useEffect(() => { asked.value = null; }, [session, notices.value, connection.value]);
  return asked;
}

function useHeldout(views: number) {
  const heldout = useSignal(heldoutByDefault(views));
  useEffect(() => { heldout.value = heldoutByDefault(views); }, [views]);
  return heldout;
}

/// "c" captures, except where a person is typing.
function useCaptureKey(capture: () => void): void {
  const newest = useRef(capture);
  newest.current = capture;
  useEffect(() => {
    const keyed = (event: KeyboardEvent): void => {
      const typing = (event.target as HTMLElement).closest?.("select, textarea, input:not([type=checkbox])");
      if (event.key !== "c" || event.repeat || event.ctrlKey || event.metaKey || event.altKey || typing) return;
      newest.current();
    };
    addEventListener("keydown", keyed);
    return () => removeEventListener("keydown", keyed);
  }, []);
}

interface ConfirmProps { yes(): void; no(): void }

function Confirm({ yes, no }: ConfirmProps) {
  const first = useRef<HTMLButtonElement>(null);
  // Not on "yes": a second press of Enter must not finish the session.
  useEffect(() => first.current?.focus(), []);
  return (
    <div class="confirm" role="alertdialog" aria-label="Finish and save?"
      onKeyDown={(event) => { if (event.key === "Escape") no(); }}>
      <p>Finish? The calibration is computed and assessed once more, and saved. No views can be added afterwards.</p>
      <div class="row">
        <button type="button" ref={first} onClick={no} data-testid="finish-cancel">Continue the session</button>
        <button type="button" class="primary" onClick={yes} data-testid="finish-confirm">Finish and save</button>
      </div>
    </div>
  );
}

/// One sentence for all buttons that cannot be pressed for the same reason.
function reasonsOf(reasons: Map<RequestName, string>): string[] {
  const given = [...reasons.values()].filter((why) => why !== "");
  return given.length < reasons.size ? [] : [...new Set(given)];
}

const kShown: RequestName[] = ["next_pose", "pose_is_set", "capture", "finish"];

export function Controls({ session }: { session: SessionFrame }) {
  const asked = useAsked(session);
  const heldout = useHeldout(session.views.length);
  const confirming = useSignal(false);
  const reasons = new Map(kShown.map((name) => [name, whyNot(name, session, connection.value, hello.value)]));
  const possible = (name: RequestName): boolean => reasons.get(name) === "" && asked.value === null;
  const ask = (request: RequestName): void => {
    if (!possible(request)) return;
    asked.value = request;
    send({ type: "request", request, heldout: request === "capture" && heldout.value });
  };
  useCaptureKey(() => ask("capture"));
  const finish = (): void => { confirming.value = false; ask("finish"); };
  // What is the next thing to do stands out.
  const primary = kShown.find((name) => name !== "finish" && possible(name));

  const button = (name: RequestName, act: () => void) => (
    <button type="button" class={name === primary ? "primary" : ""} disabled={!possible(name)} onClick={act}
      title={reasons.get(name)} data-testid={`request-${name}`} aria-keyshortcuts={name === "capture" ? "c" : undefined}>
      {asked.value === name ? "Requested…" : kNames[name]}{name === "capture" && <kbd aria-hidden="true">c</kbd>}
    </button>
  );
  return (
    <div class="controls">
      <div class="row">
        {button("next_pose", () => ask("next_pose"))}
        {button("pose_is_set", () => ask("pose_is_set"))}
        {button("capture", () => ask("capture"))}
        {button("finish", () => { confirming.value = true; })}
      </div>
      <label class="check">
        <input type="checkbox" data-testid="heldout" checked={heldout.value}
          onChange={(event) => { heldout.value = event.currentTarget.checked; }} />
        <span>Hold out the next view <span class="muted">(not used by the solver; used to check the result)</span></span>
      </label>
      {confirming.value && possible("finish") && <Confirm yes={finish} no={() => { confirming.value = false; }} />}
      {reasonsOf(reasons).map((why) => <p key={why} class="muted" data-testid="why-not">{why}</p>)}
    </div>
  );
}
