// The image on which four corners are clicked.
import { useSignal } from "@preact/signals";
import type { Vec2 } from "../../protocol";
import type { ShownImage } from "../../store";
import { ImageCanvas } from "../image/image_canvas";
import type { Drawing } from "../image/image_canvas";
import { chain, strokeRimmed } from "../image/overlay_drawing";
import { toImage, toScreen } from "../image/viewport";
import { CornerHandles, nudged } from "./corner_handles";
import { inside, kCorners } from "./corners";
import { drawLoupe, kPickColour, loupeCovers } from "./loupe";

interface Props {
  image: ShownImage;
  label: string;
  corners: Vec2[];
  set(corners: Vec2[]): void;
}

const kArrows = [["ArrowLeft", "◀", "left"], ["ArrowUp", "▲", "up"], ["ArrowDown", "▼", "down"], ["ArrowRight", "▶", "right"]] as const;

/// For fingers, which have no arrow keys.
function NudgeButtons({ selected, nudge, remove }: { selected: number; nudge(key: string): void; remove(): void }) {
  return (
    <div class="row" role="group" aria-label={`Move corner ${selected + 1} by a quarter of a pixel`}>
      <span>Corner {selected + 1}:</span>
      {kArrows.map(([key, sign, way]) => (
        <button type="button" key={key} onClick={() => nudge(key)} aria-label={`Move corner ${selected + 1} ${way} by 0.25 px`}>{sign}</button>
      ))}
      <button type="button" onClick={remove} data-testid="pick-remove">Remove</button>
    </div>
  );
}

export function PickImage({ image, label, corners, set }: Props) {
  const selected = useSignal(0);
  const aim = useSignal<Vec2 | null>(null); // what the loupe shows, on the screen
  const falseColour = useSignal(false);
  const placing = corners.length < kCorners;
  const thermal = image.header.min_k !== null;
  const add = (at: Vec2): void => {
    if (!placing) return;
    selected.value = corners.length;
    set([...corners, inside(at, image.header)]);
    if (corners.length + 1 === kCorners) aim.value = null;
  };
  const move = (index: number, to: Vec2): void => set(corners.map((at, i) => (i === index ? inside(to, image.header) : at)));
  const remove = (index: number): void => {
    aim.value = null;
    set(corners.filter((_, i) => i !== index));
    selected.value = Math.max(0, Math.min(index, corners.length - 2));
  };
  const shown = Math.min(selected.value, corners.length - 1);
  const aimed = aim.value; // read here, so that the panel is drawn anew with it

  const draw = (drawing: Drawing): void => {
    const { context, viewport } = drawing;
    if (corners.length > 1) {
      chain(context, corners.map((at) => toScreen(viewport, at)), !placing);
      strokeRimmed(context, kPickColour, 1.5);
    }
    if (aimed) drawLoupe(drawing, aimed, corners);
  };
  return (
    <>
      <ImageCanvas image={image} label={label} testid="pick-canvas" falseColour={falseColour.value} draw={draw}
        tap={(at, viewport) => add(toImage(viewport, at))} enter={(at, viewport) => add(toImage(viewport, at))}
        point={(at) => { aim.value = placing ? at : null; }} aims={() => placing}>
        {(viewport, size) => (
          <CornerHandles corners={corners} selected={shown} viewport={viewport} move={move} remove={remove}
            covered={(at) => loupeCovers(aimed, size, at)} select={(index) => { selected.value = index; }} hold={(at) => { aim.value = at; }} />
        )}
      </ImageCanvas>
      {corners.length > 0 && (
        <NudgeButtons selected={shown} remove={() => remove(shown)}
          nudge={(key) => { const to = nudged(corners[shown]!, key, false); if (to) move(shown, to); }} />
      )}
      {thermal && (
        <label class="check">
          <input type="checkbox" checked={falseColour.value} onChange={(event) => { falseColour.value = event.currentTarget.checked; }} />
          False colour
        </label>
      )}
    </>
  );
}
