import type { Grade, SessionFrame, Verdict } from "../../protocol";

export const kGradeIcon: Record<Grade, string> = { good: "✓", usable: "✓", doubtful: "!", bad: "✗", none: "…" };

export const gradeClass = (grade: Grade): string => (grade === "none" ? "muted" : grade);

export function VerdictCard({ verdict, title, testid }: { verdict: Verdict; title?: string; testid?: string }) {
  return (
    <div class={`verdict ${gradeClass(verdict.grade)}`} data-testid={testid} data-grade={verdict.grade}>
      <span class="verdict-icon" aria-hidden="true">{kGradeIcon[verdict.grade]}</span>
      <div>
        {title && <h3 class="verdict-of">{title}</h3>}
        <p class="verdict-head"><strong>{verdict.headline}</strong></p>
        {verdict.reasons.length > 0 && (
          <ul>{verdict.reasons.map((reason) => <li key={reason}>{reason}</li>)}</ul>
        )}
      </div>
    </div>
  );
}

function stepWords({ step, steps }: SessionFrame): string {
  return steps > 0 ? `Step ${step} of ${steps}` : "";
}

/// How a session that is over ended.
function outcomeOf({ mode, log }: SessionFrame): string {
  return mode !== "none" ? "" : log.filter(({ source, kind }) => source === "session" && kind === "done").pop()?.text ?? "";
}

/// What is being done now, how it ended, and why it failed where it did.
export function Progress({ session }: { session: SessionFrame }) {
  const percent = Math.round(100 * session.fraction);
  return (
    <div class="progress">
      <p role="status" data-testid="progress">{[stepWords(session), session.busy || outcomeOf(session)].filter(Boolean).join(": ")}</p>
      {session.busy && (
        <div class="row">
          <progress max={1} value={session.fraction} aria-label={session.busy} />
          <span class="number" aria-hidden="true">{percent} %</span>
        </div>
      )}
      {session.failure && <p class="bad" role="alert"><strong>✗ Failed:</strong> {session.failure}</p>}
    </div>
  );
}
