import type { TargetStatusFrame } from "../../protocol";
import { seconds } from "../words";

const kStaleS = 5;

type Sensor = TargetStatusFrame["sensors"][number];

function SensorBadge({ sensor }: { sensor: Sensor }) {
  const stale = sensor.age_s > kStaleS;
  const grade = stale ? "muted" : sensor.seen ? "good" : "bad";
  const said = stale ? `last update ${seconds(sensor.age_s, 0)} ago` : sensor.seen ? "" : sensor.text;
  return (
    <li class={grade} data-testid={`target-status-${sensor.sensor}`} data-seen={sensor.seen && !stale} title={sensor.text}>
      <strong>{sensor.sensor} <span aria-hidden="true">{stale ? "?" : sensor.seen ? "✓" : "✗"}</span></strong>
      <span class="visually-hidden">{stale ? "unknown" : sensor.seen ? "seen" : "not seen"}</span>
      {said && <span> ({said})</span>}
    </li>
  );
}

/// "Board seen by: rgb ✓ thermal ✓ lidar ✗ (why)"
export function TargetStatusLine({ targetStatus }: { targetStatus: TargetStatusFrame | null }) {
  if (!targetStatus || targetStatus.sensors.length === 0) {
    return <p class="muted">No detector is running.</p>;
  }
  return (
    <div class="target-status">
      <span>Board seen by:</span>
      <ul>{targetStatus.sensors.map((sensor) => <SensorBadge key={sensor.sensor} sensor={sensor} />)}</ul>
    </div>
  );
}
