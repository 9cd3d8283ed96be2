// The corners on the image: buttons, so that the keyboard and a screen reader find them, too.
import { useRef } from "preact/hooks";
import type { Vec2 } from "../../protocol";
import { toImage, toScreen } from "../image/viewport";
import type { Viewport } from "../image/viewport";

interface Props {
  corners: Vec2[];
  selected: number;
  viewport: Viewport;
  select(index: number): void;
  move(index: number, to: Vec2): void;
  remove(index: number): void;
  covered(at: Vec2): boolean; // by the loupe
  hold(at: Vec2 | null): void; // a corner is being moved, on the screen; null: no more
}

const kNudgePx = 0.25, kWidePx = 2; // [px of the image]
const kDirections: Record<string, Vec2> = {
  ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1],
};

export function nudged([x, y]: Vec2, key: string, wide: boolean): Vec2 | null {
  const direction = kDirections[key];
  const step = wide ? kWidePx : kNudgePx;
  return direction ? [x + step * direction[0], y + step * direction[1]] : null;
}

function Handle({ index, ...props }: Props & { index: number }) {
  // From the pointer to the corner: it does not jump under the finger.
  const grip = useRef<Vec2 | null>(null);
  const { corners, viewport } = props;
  const at = toScreen(viewport, corners[index]!);
  const pointer = (event: PointerEvent): Vec2 => {
    const box = (event.currentTarget as HTMLElement).parentElement!.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  const down = (event: PointerEvent): void => {
    if (event.button !== 0) return;
    (event.currentTarget as HTMLElement).setPointerCapture(event.pointerId);
    const [x, y] = pointer(event);
    grip.current = [at[0] - x, at[1] - y];
    props.select(index);
    props.hold(at);
  };
  const drag = (event: PointerEvent): void => {
    if (!grip.current) return;
    const [x, y] = pointer(event);
    const to: Vec2 = [x + grip.current[0], y + grip.current[1]];
    props.move(index, toImage(viewport, to));
    props.hold(to);
  };
  const letGo = (): void => {
    grip.current = null;
    props.hold(null);
  };
  const keyed = (event: KeyboardEvent): void => {
    const to = nudged(corners[index]!, event.key, event.shiftKey);
    if (to) {
      props.move(index, to);
      props.hold(toScreen(viewport, to));
    } else if (event.key === "Backspace" || event.key === "Delete") {
      props.remove(index);
    } else {
      return;
    }
    event.preventDefault();
    event.stopPropagation();
  };
  const [u, v] = corners[index]!;
  return (
    <button type="button" class={`corner ${props.covered(at) ? "covered" : ""}`} data-testid={`pick-corner-${index + 1}`} data-x={u} data-y={v}
      style={{ left: `${at[0]}px`, top: `${at[1]}px` }} aria-pressed={props.selected === index}
      aria-label={`Corner ${index + 1}, x ${u.toFixed(2)} px, y ${v.toFixed(2)} px; arrow keys move it, Backspace removes it`}
      onPointerDown={down} onPointerMove={drag} onPointerUp={letGo} onPointerCancel={letGo}
      onFocus={() => props.select(index)} onBlur={letGo} onKeyDown={keyed}>
      <span class="corner-ring" aria-hidden="true" /><span class="corner-name" aria-hidden="true">{index + 1}</span>
    </button>
  );
}

export function CornerHandles(props: Props) {
  return <>{props.corners.map((_, index) => <Handle key={index} {...props} index={index} />)}</>;
}
