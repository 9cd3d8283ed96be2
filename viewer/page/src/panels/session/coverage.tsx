// Where in each image, and how far away, the board was held.
import type { CameraInfo, Vec2, View, ViewCamera } from "../../protocol";
import { metres, shortNames } from "../words";
import { rowsOf, stripOf } from "./depth_strip";

type Fate = "used" | "heldout" | "rejected";
const kFateWords: Record<Fate, string> = { used: "used", heldout: "held out", rejected: "rejected or waiting" };

function fateOf(view: View, own: ViewCamera): Fate {
  if (own.state !== "accepted") return "rejected";
  return view.heldout ? "heldout" : "used";
}

/// A board's distance counts where any camera saw it well.
function fateOfView(view: View): Fate {
  if (!view.cameras.some((own) => own.state === "accepted")) return "rejected";
  return view.heldout ? "heldout" : "used";
}

function middleOf(outline: Vec2[]): Vec2 {
  const sum = outline.reduce<Vec2>(([x, y], [u, v]) => [x + u, y + v], [0, 0]);
  return [sum[0] / outline.length, sum[1] / outline.length];
}

function Outline({ view, own, text, label }: { view: View; own: ViewCamera; text: number; label: string | undefined }) {
  const [x, y] = middleOf(own.outline);
  return (
    <g class={`fate ${fateOf(view, own)}`}>
      <polygon points={own.outline.map(([u, v]) => `${u},${v}`).join(" ")} />
      <text x={x} y={y} font-size={text}>{label}</text>
    </g>
  );
}

function FrameCoverage({ camera, views, labels }: { camera: CameraInfo; views: View[]; labels: Map<string, string> }) {
  const found = views.flatMap((view) => view.cameras
    .filter((own) => own.camera === camera.name && own.outline.length > 2)
    .map((own) => ({ view, own })));
  return (
    <figure class="coverage">
      <svg viewBox={`-0.5 -0.5 ${camera.width} ${camera.height}`} role="img" data-testid={`coverage-${camera.name}`}
        aria-label={`Image of ${camera.name} with the board's outlines of ${found.length} views`}>
        {found.map(({ view, own }) => <Outline key={view.name} view={view} own={own} text={camera.width / 28} label={labels.get(view.name)} />)}
      </svg>
      <figcaption>{camera.name}: {camera.width} × {camera.height} px, board detected in {found.length} of {views.length} views</figcaption>
    </figure>
  );
}

const kLabelShare = 0.08, kRowPx = 26;

function DepthStrip({ views, labels }: { views: View[]; labels: Map<string, string> }) {
  const seen = views.flatMap((view) => (view.board ? [{ view, distance: view.board.distance_m }] : []));
  if (seen.length === 0) return <p class="muted">No board detected in the cloud yet.</p>;
  const { length, parts } = stripOf(Math.max(...seen.map((each) => each.distance)));
  const rows = rowsOf(seen.map((each) => each.distance / length), kLabelShare);
  const ticks = Array.from({ length: parts + 1 }, (_, i) => i / parts);
  return (
    <figure class="depths" data-testid="depth-strip">
      <div class="depths-marks" style={{ height: `${kRowPx * (1 + Math.max(...rows))}px` }}>
        {seen.map(({ view, distance }, i) => (
          <span key={view.name} class={`depth fate ${fateOfView(view)}`} title={`View ${view.name}: ${metres(distance)}`}
            style={{ left: `${(100 * distance) / length}%`, bottom: `${kRowPx * rows[i]!}px` }}>
            {labels.get(view.name)}<span class="visually-hidden"> at {metres(distance)}</span>
          </span>
        ))}
      </div>
      <div class="depths-axis" aria-hidden="true">
        {ticks.map((share) => <span key={share} style={{ left: `${100 * share}%` }}>{metres(share * length, length < 4 ? 1 : 0)}</span>)}
      </div>
      <figcaption>Distance of the board from the LIDAR, by view</figcaption>
    </figure>
  );
}

function FateLegend() {
  return (
    <ul class="legend">
      {(Object.keys(kFateWords) as Fate[]).map((fate) => (
        <li key={fate}>
          <svg class={`mark fate ${fate}`} viewBox="-2 -2 24 14" aria-hidden="true"><polygon points="0,0 20,0 20,10 0,10" /></svg>
          {" "}{kFateWords[fate]}
        </li>
      ))}
    </ul>
  );
}

export function Coverage({ cameras, views }: { cameras: CameraInfo[]; views: View[] }) {
  const labels = shortNames(views.map(({ name }) => name));
  return (
    <>
      <div class="coverages">{cameras.map((camera) => <FrameCoverage key={camera.name} camera={camera} views={views} labels={labels} />)}</div>
      <FateLegend />
      <DepthStrip views={views} labels={labels} />
    </>
  );
}
