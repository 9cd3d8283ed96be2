// A person clicks the board's four outer corners where the detector did not find them.
import type { SessionFrame } from "../protocol";
import { connection, hello, images, keyOf, send, session } from "../store";
import type { ShownImage } from "../store";
import { useViewRequest } from "./image/view_request";
import { Choice, choose, targetOf } from "./pick/choice";
import type { Target } from "./pick/choice";
import { faultOf, goingRound, kCorners } from "./pick/corners";
import type { Four } from "./pick/corners";
import { cameraIn, Outcome } from "./pick/outcome";
import { PickImage } from "./pick/pick_image";
import { cornersOf, sentOf, setCorners, setSent } from "./pick/picked";
import { whyNotCommand } from "./session/permission";
import "./panels.css";

function whyNotSend(state: SessionFrame): string {
  const why = whyNotCommand(connection.value, hello.value);
  return why === "" && state.mode === "finished" ? "This session is finished: corners can no longer be picked." : why;
}

function Help() {
  return (
    <div class="pick-help">
      <p><strong>Click the four outer corners of the board, in order around it (the corners of the board, not of the squares).</strong></p>
      <details>
        <summary>How to pick accurately</summary>
        <p>Zoom in with the wheel or two fingers. Drag a corner to move it; arrow keys move the chosen one by 0.25 px,
          with Shift by 2 px. Tab goes to the next corner, Backspace removes it. Without a mouse: move the image with the
          arrow keys and press Enter to set a corner in its middle.</p>
      </details>
    </div>
  );
}

function SendLine({ state, target, image }: { state: SessionFrame; target: Target; image: ShownImage }) {
  const key = keyOf(target.view, target.camera);
  const corners = cornersOf(key);
  const fault = faultOf(corners, image.header), refused = whyNotSend(state);
  const possible = fault === "" && refused === "";
  const sendCorners = (): void => {
    setSent(key, { at: Date.now(), before: JSON.stringify(cameraIn(state, target)) });
    choose(target); // stays on this image when the session no longer wants it
    send({ type: "pick", camera: target.camera, image_utime: image.header.utime, corners: corners as Four });
  };
  return (
    <>
      <div class="row">
        <button type="button" class={possible ? "primary" : ""} disabled={!possible} onClick={sendCorners} data-testid="pick-send">
          Send corners
        </button>
        <button type="button" disabled={corners.length === 0} onClick={() => setCorners(key, [])} data-testid="pick-clear">Clear</button>
        {corners.length === kCorners && fault !== "" && (
          <button type="button" onClick={() => setCorners(key, goingRound(corners))} data-testid="pick-order">Sort the corners</button>
        )}
      </div>
      <p aria-live="polite" data-testid="pick-fault" class={corners.length === kCorners && fault ? "caution" : "muted"}>
        {refused || fault || "Four corners are set."}
      </p>
    </>
  );
}

function Picking({ state, target }: { state: SessionFrame; target: Target }) {
  const key = keyOf(target.view, target.camera);
  const image = images.value.get(key);
  if (!image) return <p class="empty">Waiting for the image of {target.camera} in view {target.view}.</p>;
  return (
    <>
      <PickImage key={key} image={image} corners={cornersOf(key)} set={(next) => { choose(target); setCorners(key, next); }}
        label={`Image of ${target.camera}, view ${target.view}. Click the board's four outer corners.`} />
      <SendLine state={state} target={target} image={image} />
    </>
  );
}

export function PickPanel() {
  const state = session.value;
  const target = state && targetOf(state);
  useViewRequest(target?.view ?? "");
  if (!state || !target) return <p class="empty">No views yet.</p>;
  return (
    <div class="panel pick">
      <div class="card">
        <Choice session={state} target={target} />
        <Help />
        <Picking state={state} target={target} />
        <Outcome session={state} target={target} sent={sentOf(keyOf(target.view, target.camera))} />
      </div>
    </div>
  );
}
