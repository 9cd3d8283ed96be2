// Which image's corners are picked.
import { signal } from "@preact/signals";
import type { SessionFrame, ViewCamera } from "../../protocol";
import { keyOf } from "../../store";
import { open, paramsOf } from "../route";

export interface Target { view: string; camera: string }

const chosen = signal<Target | null>(null); // outlives the panel

function stateOf(session: SessionFrame, { view, camera }: Target): ViewCamera["state"] | undefined {
  return session.views.find((each) => each.name === view)?.cameras.find((own) => own.camera === camera)?.state;
}

/// The address' one; else what was chosen before and is not done yet; else the likeliest to be
/// wanted; else any.
export function targetOf(session: SessionFrame): Target | null {
  const params = paramsOf("pick");
  const named = { view: params.get("view") ?? "", camera: params.get("camera") ?? "" };
  if (stateOf(session, named)) return named;
  const before = chosen.value && stateOf(session, chosen.value);
  if (before && before !== "accepted") return chosen.value;
  const wanted = session.pick_wanted[0];
  if (wanted) return { view: wanted.view, camera: wanted.camera };
  const view = session.views[session.views.length - 1];
  const camera = view?.cameras[0]?.camera;
  return view && camera ? { view: view.name, camera } : null;
}

export function choose({ view, camera }: Target): void {
  chosen.value = { view, camera };
  open("pick", { view, camera });
}

export function Choice({ session, target }: { session: SessionFrame; target: Target }) {
  const all = session.views.flatMap((view) => view.cameras.map((own) => ({ view: view.name, camera: own.camera, state: own.state })));
  const shown = keyOf(target.view, target.camera);
  const wanted = session.pick_wanted.find((each) => keyOf(each.view, each.camera) === shown);
  return (
    <div class="choice">
      {session.pick_wanted.length > 0 && (
        <div class="row" role="group" aria-label="Images that need picked corners">
          <span>Needed for:</span>
          {session.pick_wanted.map((each) => (
            <button type="button" key={keyOf(each.view, each.camera)} aria-pressed={keyOf(each.view, each.camera) === shown}
              title={each.why} data-testid={`pick-wanted-${each.view}-${each.camera}`} onClick={() => choose(each)}>
              {each.view} {each.camera}
            </button>
          ))}
        </div>
      )}
      <label class="row">
        <span>Image:</span>
        <select data-testid="pick-view" value={shown} onChange={(event) => {
          const next = all.find((each) => keyOf(each.view, each.camera) === event.currentTarget.value);
          if (next) choose(next);
        }}>
          {all.map((each) => (
            <option key={keyOf(each.view, each.camera)} value={keyOf(each.view, each.camera)}>
              {each.view} {each.camera} ({each.state})
            </option>
          ))}
        </select>
      </label>
      {wanted?.why && <p class="caution" data-testid="pick-why">Reason: {wanted.why}</p>}
    </div>
  );
}
