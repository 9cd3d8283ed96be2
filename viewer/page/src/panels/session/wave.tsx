// A board that is waved before the sensors (`rgbdt sync live`): what to do, and how the sigma of
// each camera's time offset falls.
import { fixed } from "../../format";
import type { SessionFrame, WaveFrame } from "../../protocol";
import { LineChart } from "./line_chart";

const kPhases: Record<WaveFrame["phase"], { grade: string; words: string }> = {
  waiting: { grade: "doubtful", words: "waiting" },
  recording: { grade: "doubtful", words: "recording" },
  solving: { grade: "doubtful", words: "solving" },
  done: { grade: "good", words: "done" },
  failed: { grade: "bad", words: "failed" },
};

const milliseconds = (value: number): string => fixed(value, value < 1 ? 2 : 1, "ms");

/// It comes first in the panel while it goes on, and where there is no session.
export function waveComesFirst({ phase }: WaveFrame, mode: SessionFrame["mode"]): boolean {
  return mode === "none" || (phase !== "done" && phase !== "failed");
}

function Clock({ clock }: { clock: WaveFrame["cameras"][number] }) {
  return (
    <li data-testid={`wave-${clock.camera}`}>
      <strong>{clock.camera}</strong>{" "}
      {clock.offset_ms === null || clock.sigma_ms === null ? "no offset yet" : (
        <span>time offset {fixed(clock.offset_ms, 2)} ± {fixed(clock.sigma_ms, 2, "ms")} (1 sigma)</span>
      )}
      {clock.text && <p class="muted">{clock.text}</p>}
    </li>
  );
}

function SigmaChart({ steps }: Pick<WaveFrame, "steps">) {
  if (steps.length < 2) return null;
  const names = [...new Set(steps.flatMap(({ cameras }) => cameras.map(({ camera }) => camera)))];
  const lines = names.map((name) => ({
    name,
    values: steps.map(({ cameras }) => cameras.find(({ camera }) => camera === name)?.sigma_ms ?? null),
  }));
  return (
    <LineChart title="Time offset, 1 sigma [ms], by seconds of waving" testid="chart-wave"
      x={steps.map(({ seconds }) => seconds)} lines={lines} text={milliseconds} />
  );
}

export function Wave({ frame }: { frame: WaveFrame }) {
  const { grade, words } = kPhases[frame.phase];
  return (
    <section class="card wave" aria-label="Time offsets" data-testid="wave" data-phase={frame.phase}>
      <h2>Time offsets <span class={`badge ${grade}`}>{words}</span></h2>
      {frame.phase === "recording" && <p class="wave-left" data-testid="wave-left">{fixed(frame.left_s, 0, "s")} left</p>}
      <p class="wave-text" data-testid="wave-text">{frame.text}</p>
      <ul class="plain">{frame.cameras.map((clock) => <Clock key={clock.camera} clock={clock} />)}</ul>
      <SigmaChart steps={frame.steps} />
    </section>
  );
}
