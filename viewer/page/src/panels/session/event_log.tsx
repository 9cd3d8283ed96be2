import type { SessionFrame } from "../../protocol";
import { clock } from "../words";

const kShown = 50;
const kKinds = { progress: { icon: "·", grade: "muted" }, done: { icon: "✓", grade: "good" }, failed: { icon: "✗", grade: "bad" } };

/// The newest events, newest first.
export function EventLog({ log }: { log: SessionFrame["log"] }) {
  const newest = log.slice(-kShown).reverse();
  return (
    <details class="card" data-testid="log">
      <summary>Log: {newest.length} of {log.length} events</summary>
      <ol class="plain log">
        {newest.map((event, i) => {
          const { icon, grade } = kKinds[event.kind];
          return (
            <li key={log.length - i}>
              <span class={grade} aria-label={event.kind}>{icon}</span>
              <time class="mono muted">{clock(event.utime)}</time>
              <span><strong>{event.source}</strong> {event.text}</span>
            </li>
          );
        })}
      </ol>
    </details>
  );
}
