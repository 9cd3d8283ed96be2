// The session: what is to be done now, what came of it, and how sure the result is.
import type { CameraState, SessionFrame } from "../protocol";
import { rig, session, targetStatus } from "../store";
import { px } from "./words";
import { Controls } from "./session/controls";
import { Coverage } from "./session/coverage";
import { EventLog } from "./session/event_log";
import { ReportSection, SigmaPictures } from "./session/report";
import type { ReportMessage } from "./session/report_message";
import { TargetStatusLine } from "./session/target_status_line";
import { HeldoutErrors, SigmaCharts } from "./session/sureness";
import { Progress, VerdictCard } from "./session/verdict";
import { ViewCards } from "./session/view_cards";
import "./panels.css";

function NextView({ next }: { next: NonNullable<SessionFrame["next_view"]> }) {
  const gain = next.before_px !== null && next.after_px !== null
    ? `Where ${next.camera} is worst, 1 sigma of a colour is to go from ${px(next.before_px)} to ${px(next.after_px)}.` : "";
  return (
    <div class="next-view" data-testid="next-view">
      <h3>Where to hold the board next</h3>
      <p class="next-words">{next.words}</p>
      {gain && <p class="muted">{gain}</p>}
    </div>
  );
}

function CameraVerdicts({ cameras }: { cameras: CameraState[] }) {
  return (
    <div class="verdicts">
      {cameras.map((camera) => (
        <VerdictCard key={camera.camera} title={camera.camera} verdict={camera.verdict} testid={`verdict-${camera.camera}`} />
      ))}
    </div>
  );
}

function Now({ session: state }: { session: SessionFrame }) {
  return (
    <section class="card now" aria-label="Now">
      {state.mode !== "finished" && <TargetStatusLine targetStatus={targetStatus.value} />}
      {state.next_view && <NextView next={state.next_view} />}
      <Progress session={state} />
      {state.mode !== "finished" && <Controls session={state} />}
    </section>
  );
}

function isEmpty(state: SessionFrame): boolean {
  return state.mode === "finished" && !state.next_view && !state.failure && !state.busy && state.steps === 0;
}

export function SessionPanel() {
  const state = session.value;
  if (!state) return <p class="empty">Nothing is known of a session yet.</p>;
  return (
    <div class="panel session">
      <section class="card" aria-label="Verdict">
        <VerdictCard verdict={state.verdict} testid="verdict" />
        {state.cameras.length > 1 && (
          <details>
            <summary>Camera by camera</summary>
            <CameraVerdicts cameras={state.cameras} />
          </details>
        )}
      </section>
      {!isEmpty(state) && <Now session={state} />}
      <section class="card" aria-label="How sure it is">
        <h2>How sure it is</h2>
        <SigmaCharts sigma={state.sigma} />
        <HeldoutErrors cameras={state.cameras} />
      </section>
      <section class="card" aria-label="Coverage">
        <h2>Where the board was held</h2>
        <Coverage cameras={rig.value?.cameras ?? []} views={state.views} />
      </section>
      <SigmaPictures />
      <section aria-label="Views">
        <h2>Views ({state.views.length})</h2>
        <ViewCards session={state} />
      </section>
      {state.report && <ReportSection report={state.report as ReportMessage} open={state.mode === "finished"} />}
      <EventLog log={state.log} />
    </div>
  );
}
