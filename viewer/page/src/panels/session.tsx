// The session: what is to be done now, what came of it, and the result's uncertainty.
import type { SessionFrame } from "../protocol";
import { mounts, rig, session, targetStatus, wave } from "../store";
import { Answer } from "./session/answer";
import { Controls } from "./session/controls";
import { Coverage } from "./session/coverage";
import { EventLog } from "./session/event_log";
import { Mounts } from "./session/mounts";
import { ReportSection, ReportPictures } from "./session/report";
import { TableView } from "./session/table";
import { TargetStatusLine } from "./session/target_status_line";
import { SigmaCharts } from "./session/uncertainty";
import { Progress } from "./session/verdict";
import { ViewCards } from "./session/view_cards";
import { Wave, waveComesFirst } from "./session/wave";
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
  const waved = wave.value && <Wave frame={wave.value} />;
  const wavedFirst = wave.value !== null && waveComesFirst(wave.value, state.mode);
  return (
    <div class="panel session">
      {wavedFirst && waved}
      <Answer session={state} />
      {!isEmpty(state) && <Now session={state} />}
      {!wavedFirst && waved}
      {mounts.value && <Mounts frame={mounts.value} />}
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
      {(state.mode !== "finished" || state.log.length > 0) && <EventLog log={state.log} />}
    </div>
  );
}
