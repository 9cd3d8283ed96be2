// The session: what is to be done now, what came of it, and the result's uncertainty.
import type { CameraState, SessionFrame } from "../protocol";
import { rig, session, targetStatus } from "../store";
import { Controls } from "./session/controls";
import { Coverage } from "./session/coverage";
import { EventLog } from "./session/event_log";
import { ReportSection, ReportPictures } from "./session/report";
import { TableView } from "./session/table";
import { TargetStatusLine } from "./session/target_status_line";
import { SigmaCharts } from "./session/uncertainty";
import { Progress, VerdictCard } from "./session/verdict";
import { ViewCards } from "./session/view_cards";
import "./panels.css";

function NextView({ next }: { next: NonNullable<SessionFrame["next_view"]> }) {
  return (
    <div class="next-view" data-testid="next-view">
      <h3>Next board position</h3>
      <p class="next-words">{next.words}</p>
      <p class="muted">{next.gain}</p>
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
  if (!state) return <p class="empty">No session data yet.</p>;
  return (
    <div class="panel session">
      <section class="card" aria-label="Assessment">
        <h2>Assessment</h2>
        <VerdictCard verdict={state.verdict} testid="verdict" />
        {state.cameras.length > 1 && (
          <details>
            <summary>Camera by camera</summary>
            <CameraVerdicts cameras={state.cameras} />
          </details>
        )}
      </section>
      {!isEmpty(state) && <Now session={state} />}
      <section class="card" aria-label="Uncertainty">
        <h2>Uncertainty</h2>
        <SigmaCharts sigma={state.sigma} />
        {state.heldout.rows.length > 0 && <TableView table={state.heldout} />}
      </section>
      <section class="card" aria-label="Coverage">
        <h2>Board positions</h2>
        <Coverage cameras={rig.value?.cameras ?? []} views={state.views} />
      </section>
      <ReportPictures />
      <section aria-label="Views">
        <h2>Views ({state.views.length})</h2>
        <ViewCards session={state} />
      </section>
      {state.report && <ReportSection report={state.report} open={state.mode === "finished"} />}
      <EventLog log={state.log} />
    </div>
  );
}
