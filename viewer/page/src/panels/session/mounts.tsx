// Whether each camera still sits where its calibration says: a lamp a camera, and how far it drifted.
import type { MountsFrame } from "../../protocol";
import { degrees } from "../words";
import { LineChart } from "./line_chart";

type Mount = MountsFrame["cameras"][number];

const kLamps = {
  holds: { grade: "good", mark: "✓", words: "holds" },
  moved: { grade: "bad", mark: "✗", words: "moved" },
  lost: { grade: "bad", mark: "✗", words: "does not fit" },
  cannot_tell: { grade: "muted", mark: "?", words: "cannot tell" },
} as const;
const kColumns = 4;

/// Badges for where little room is.
export function MountLamps({ frame }: { frame: MountsFrame }) {
  return (
    <>
      {frame.cameras.map(({ camera, state, text }) => (
        <span key={camera} class={`badge ${kLamps[state].grade}`} title={`${camera}: ${text}`} data-testid={`mount-lamp-${camera}`}
          data-state={state}>
          {camera} <span aria-hidden="true">{kLamps[state].mark}</span>
          <span class="visually-hidden">{kLamps[state].words}</span>
        </span>
      ))}
    </>
  );
}

function probability(holds: number): string {
  if (holds > 0.999) return "more than 99.9%";
  if (holds < 0.001) return "less than 0.1%";
  return `${(100 * holds).toFixed(1)}%`;
}

/// The image, its parts as dark as they told.
function Where({ where }: { where: number[] }) {
  const most = Math.max(...where, 1e-6);
  return (
    <svg class="mount-where" viewBox={`0 0 ${kColumns} ${where.length / kColumns}`} role="img"
      aria-label="Which parts of the image told">
      {where.map((share, i) => (
        <rect key={i} x={i % kColumns} y={Math.floor(i / kColumns)} width="1" height="1" fill="var(--accent)"
          fill-opacity={0.08 + 0.9 * (share / most)}>
          <title>{`${Math.round(100 * share)}% of the edges that told`}</title>
        </rect>
      ))}
    </svg>
  );
}

function MountLine({ mount }: { mount: Mount }) {
  const { grade, mark, words } = kLamps[mount.state];
  return (
    <li data-testid={`mount-${mount.camera}`} data-state={mount.state}>
      <span class={`badge ${grade}`}>{mount.camera} <span aria-hidden="true">{mark}</span> {words}</span>
      {mount.holds !== null && <span> still holds: {probability(mount.holds)}</span>}
      <p>{mount.text}</p>
      {mount.holds !== null && <Where where={mount.where} />}
    </li>
  );
}

/// In whole seconds from the first: the newest of each camera by then.
function Drift({ cameras }: { cameras: Mount[] }) {
  const first = Math.min(...cameras.flatMap(({ steps }) => steps.slice(0, 1).map(({ utime }) => utime)));
  const secondOf = (utime: number): number => Math.round((utime - first) / 1e6);
  const seconds = [...new Set(cameras.flatMap(({ steps }) => steps.map(({ utime }) => secondOf(utime))))].sort((a, b) => a - b);
  if (seconds.length < 2) return null;
  const lines = cameras.map(({ camera, steps }) => {
    const bySecond = new Map(steps.map((step) => [secondOf(step.utime), step.rotation_deg]));
    let last: number | null = null;
    return { name: camera, values: seconds.map((second) => (last = bySecond.get(second) ?? last)) };
  });
  return (
    <LineChart title="Rotation away from the calibration [°], by seconds" testid="chart-drift"
      x={seconds} lines={lines} text={(value) => degrees(value)} />
  );
}

export function Mounts({ frame }: { frame: MountsFrame }) {
  return (
    <section class="card" aria-label="Mounts" data-testid="mounts">
      <h2>Mounts</h2>
      <ul class="mounts">{frame.cameras.map((mount) => <MountLine key={mount.camera} mount={mount} />)}</ul>
      <Drift cameras={frame.cameras} />
    </section>
  );
}
