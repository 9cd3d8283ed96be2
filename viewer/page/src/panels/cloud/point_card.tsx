// All values of the picked point.
import type { PointValues } from "../../cloud/points";
import { picked, stats } from "../../cloud/settings";
import { rig } from "../../store";
import { celsius, fixed, metres, utc } from "../../format";

/// What the rig has no sensor for is left out.
function rows(point: PointValues): [string, string][] {
  const has = (kind: string) => rig.value?.cameras.some((camera) => camera.kind === kind) ?? true;
  const unknown = [...(has("color") ? [] : ["RGB"]), ...(has("thermal") ? [] : ["temperature", "thermal counts"])];
  return allRows(point).filter(([name]) => !unknown.includes(name));
}

function allRows(point: PointValues): [string, string][] {
  const [x, y, z] = point.position;
  const sigma = point.sigma_k === null ? "" : ` ± ${fixed(point.sigma_k, 2, "K")}`;
  return [
    ["x", metres(x)], ["y", metres(y)], ["z", metres(z)],
    [stats.value.frame === "map" ? "distance from the map's origin" : "distance", metres(Math.hypot(x, y, z))],
    ["RGB", point.color?.join(" ") ?? "–"],
    ["intensity", fixed(point.intensity, 0)],
    ["temperature", celsius(point.kelvin) + sigma],
    ["thermal counts", fixed(point.counts, 0)],
    ["seen by", point.cameras.join(", ") || "no camera"],
    ["time", utc(point.utime)],
    ["sweep", utc(point.sweep)],
  ];
}

export function PointCard() {
  const point = picked.value;
  if (!point) return null;
  return (
    <aside class="cloud-card card" data-testid="point-card" aria-label="Picked point" aria-live="polite">
      <div class="cloud-card-head">
        <h3>Point, {stats.value.frame === "map" ? "map frame" : "LIDAR frame"}</h3>
        {point.color && <i style={{ background: `rgb(${point.color.join(" ")})` }} />}
        <button aria-label="Close" title="Esc" onClick={() => { picked.value = null; }}>✕</button>
      </div>
      <dl>
        {rows(point).map(([name, value]) => (
          <div key={name}><dt>{name}</dt><dd data-testid={`point-${name.replace(/\W+/g, "-")}`}>{value}</dd></div>
        ))}
      </dl>
    </aside>
  );
}
