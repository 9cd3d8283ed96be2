// What came back for corners that were sent.
import type { SessionFrame, ViewCamera } from "../../protocol";
import { keyOf, notices } from "../../store";
import { px } from "../words";
import { choose } from "./choice";
import type { Target } from "./choice";

export interface Sent { at: number; before: string } // [ms]; the camera's state in that view, as JSON

export function cameraIn(session: SessionFrame, { view, camera }: Target): ViewCamera | undefined {
  return session.views.find((each) => each.name === view)?.cameras.find((own) => own.camera === camera);
}

function answerOf(own: ViewCamera | undefined, sent: Sent): { grade: string; words: string } {
  const error = notices.value.filter((notice) => notice.level === "error" && notice.at >= sent.at).pop();
  if (error) return { grade: "bad", words: `✗ Refused: ${error.text}` };
  if (!own || JSON.stringify(own) === sent.before || own.state === "waiting") {
    return { grade: "muted", words: "Sent. Waiting for the detector…" };
  }
  if (own.state === "rejected") return { grade: "bad", words: `✗ Rejected: ${own.why || "no reason was given"}` };
  const edge = own.edge_rms_px === null ? "" : ` Outline error: ${px(own.edge_rms_px)} RMS.`;
  return { grade: "good", words: `✓ Accepted.${edge}` };
}

interface Props { session: SessionFrame; target: Target; sent: Sent | undefined }

export function Outcome({ session, target, sent }: Props) {
  if (!sent) return null;
  const own = cameraIn(session, target);
  const { grade, words } = answerOf(own, sent);
  const next = session.pick_wanted.find((each) => keyOf(each.view, each.camera) !== keyOf(target.view, target.camera));
  return (
    <div class="row" role="status" data-testid="pick-outcome">
      <strong class={grade}>{words}</strong>
      {grade === "good" && next && (
        <button type="button" onClick={() => choose(next)} data-testid="pick-next">Next image: {next.view} {next.camera}</button>
      )}
    </div>
  );
}
