import { useState } from "preact/hooks";
import type { CameraInfo } from "../../protocol";
import { images, keyOf, overlays, session } from "../../store";
import type { ShownImage, ShownOverlay } from "../../store";
import { clock, px } from "../words";
import { ImageCanvas } from "./image_canvas";
import { OverlayLegends, TemperatureLegend } from "./legends";
import { drawOverlay } from "./overlay_drawing";
import type { OverlaySwitches } from "./overlay_drawing";
import { summaryOf } from "./residuals";

const kLateUs = 300_000; // an overlay that is older than its image by more is said to be

/// What a person should see.
export function whatToSee(overlay: ShownOverlay): string {
  if (!overlay.header.calibrated) return "This camera is not calibrated yet: the cloud cannot be projected onto the image.";
  if (overlay.edge.length === 0) return "There is no board edge in the cloud to compare with.";
  const rule = "The board edge from the cloud should lie on the board's border";
  const { rms } = summaryOf(overlay.edge);
  return rms === null ? `${rule}; the outline was not detected in the image, so compare by eye.` : `${rule}, outline error ${px(rms, 1)} RMS.`;
}

function lateness(image: ShownImage, overlay: ShownOverlay): string {
  const late = image.header.utime - overlay.header.utime;
  return Math.abs(late) > kLateUs ? ` (of an image ${(late / 1e6).toFixed(1)} s before this one)` : "";
}

function OverlayWords({ image, overlay }: { image: ShownImage; overlay: ShownOverlay | undefined }) {
  if (!overlay) return <p class="muted">Detection has not run on this image yet.</p>;
  return (
    <>
      <p data-testid={`overlay-text-${image.header.camera}`}>
        <strong>{overlay.header.text}</strong>{lateness(image, overlay)}
      </p>
      <p>{whatToSee(overlay)}</p>
    </>
  );
}

/// A finished session without a view has no live image either.
function titleOf(camera: string, view: string): string {
  if (view !== "") return `${camera}, view ${view}`;
  return session.value?.mode === "finished" ? camera : `${camera}, live`;
}

interface Props { camera: CameraInfo; view: string; switches: OverlaySwitches }

function waitingFor(camera: string, view: string): string {
  if (view === "") return session.value?.mode === "finished" ? "No view has an image of this camera." : "Waiting for this camera's first image.";
  const own = session.value?.views.find((each) => each.name === view)?.cameras.find((each) => each.camera === camera);
  return own?.image_utime ? `Waiting for the image of view ${view}.` : `View ${view} has no image of this camera.`;
}

function Waiting({ camera, view }: { camera: CameraInfo; view: string }) {
  return (
    <p class="picture-wait" style={{ aspectRatio: `${camera.width} / ${camera.height}` }}>
      {waitingFor(camera.name, view)}
    </p>
  );
}

export function CameraPicture({ camera, view, switches }: Props) {
  const [falseColour, setFalseColour] = useState(false);
  const image = images.value.get(keyOf(view, camera.name));
  const overlay = overlays.value.get(keyOf(view, camera.name));
  const title = titleOf(camera.name, view);
  const { min_k: low, max_k: high } = image?.header ?? { min_k: null, max_k: null };
  return (
    <article class="card picture" aria-label={title} data-testid={`picture-${camera.name}`}>
      <header class="row">
        <h3>{title}</h3>
        <span class="muted">{camera.width} × {camera.height} px{image && image.header.utime > 0 ? `, ${clock(image.header.utime)}` : ""}</span>
      </header>
      {image ? (
        <ImageCanvas key={`${view}/${camera.name}`} image={image} falseColour={falseColour && camera.kind === "thermal"}
          label={`Image of ${title}. ${overlay?.header.text ?? ""} Plus and minus zoom, arrows move, 0 shows all.`}
          draw={({ context, viewport }) => { if (overlay) drawOverlay(context, viewport, overlay, switches); }} />
      ) : <Waiting camera={camera} view={view} />}
      {image && <OverlayWords image={image} overlay={overlay} />}
      {overlay && <OverlayLegends overlay={overlay} switches={switches} />}
      {low !== null && high !== null && <TemperatureLegend low={low} high={high} falseColour={falseColour} />}
      {camera.kind === "thermal" && (
        <label class="check">
          <input type="checkbox" checked={falseColour} data-testid={`false-colour-${camera.name}`}
            onChange={(event) => setFalseColour(event.currentTarget.checked)} />
          False colour
        </label>
      )}
    </article>
  );
}
