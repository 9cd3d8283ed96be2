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
  if (!overlay.header.calibrated) return "No calibration of this camera yet: nothing of the cloud can be laid on the image.";
  if (overlay.edge.length === 0) return "The cloud shows no edge of the board to compare with.";
  const rule = "Points of the board's edge should lie on its border";
  const { rms } = summaryOf(overlay.edge);
  return rms === null ? `${rule}; its outline was not found in the image, so judge by eye.` : `${rule}: ${px(rms, 1)} RMS.`;
}

function lateness(image: ShownImage, overlay: ShownOverlay): string {
  const late = image.header.utime - overlay.header.utime;
  return Math.abs(late) > kLateUs ? ` (of an image ${(late / 1e6).toFixed(1)} s before this one)` : "";
}

function OverlayWords({ image, overlay }: { image: ShownImage; overlay: ShownOverlay | undefined }) {
  if (!overlay) return <p class="muted">Nothing was looked for in this image yet.</p>;
  return (
    <>
      <p data-testid={`overlay-text-${image.header.camera}`}>
        <strong>{overlay.header.text}</strong>{lateness(image, overlay)}
      </p>
      <p>{whatToSee(overlay)}</p>
    </>
  );
}

interface Props { camera: CameraInfo; view: string; switches: OverlaySwitches }

function waitingFor(camera: string, view: string): string {
  if (view === "") return "Waits for this camera's first image.";
  const own = session.value?.views.find((each) => each.name === view)?.cameras.find((each) => each.camera === camera);
  return own?.image_utime ? `Waits for the image of view ${view}.` : `View ${view} has no image of this camera.`;
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
  const title = `${camera.name}, ${view === "" ? "live" : `view ${view}`}`;
  const { min_k: low, max_k: high } = image?.header ?? { min_k: null, max_k: null };
  return (
    <article class="card picture" aria-label={title} data-testid={`picture-${camera.name}`}>
      <header class="row">
        <h3>{title}</h3>
        <span class="muted">{camera.width} × {camera.height} px{image ? `, ${clock(image.header.utime)}` : ""}</span>
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
