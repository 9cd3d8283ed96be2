// An image on a canvas that zooms and pans; who uses it draws on top.
import type { ComponentChildren } from "preact";
import { useEffect, useLayoutEffect, useRef } from "preact/hooks";
import type { Vec2 } from "../../protocol";
import type { ShownImage } from "../../store";
import { falseColoured } from "./colour_tables";
import { useDecoded } from "./decoded";
import { listenToGestures } from "./gestures";
import { useViewport } from "./use_viewport";
import type { Look } from "./use_viewport";
import type { Size, Viewport } from "./viewport";

export type Picture = HTMLImageElement | HTMLCanvasElement;

export interface Drawing {
  context: CanvasRenderingContext2D;
  viewport: Viewport;
  size: Size; // of the canvas [CSS px]
  image: Size; // [px]
  picture: Picture;
}

interface Props {
  image: ShownImage;
  label: string;
  testid?: string;
  falseColour?: boolean;
  draw(drawing: Drawing): void;
  // Screen coordinates come with the viewport that they are of.
  tap?(at: Vec2, viewport: Viewport): void;
  point?(at: Vec2 | null, viewport: Viewport): void;
  aims?(): boolean;
  enter?(centre: Vec2, viewport: Viewport): void; // the Enter key, with the canvas' middle
  children?(viewport: Viewport, size: Size): ComponentChildren;
}

/// Sharp on this screen, in CSS pixels from here on.
function cleared(canvas: HTMLCanvasElement, size: Size): CanvasRenderingContext2D {
  const ratio = window.devicePixelRatio || 1;
  const width = Math.round(size.width * ratio), height = Math.round(size.height * ratio);
  if (canvas.width !== width || canvas.height !== height) {
    canvas.width = width;
    canvas.height = height;
  }
  const context = canvas.getContext("2d")!;
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, size.width, size.height);
  return context;
}

/// `image`: the full size that `picture` stands for.
export function drawPicture(context: CanvasRenderingContext2D, picture: Picture, at: Viewport, image: Size): void {
  const shown = picture instanceof HTMLImageElement ? picture.naturalWidth : picture.width;
  context.imageSmoothingEnabled = at.scale * image.width < 3 * shown;
  context.drawImage(picture, at.x, at.y, at.scale * image.width, at.scale * image.height);
}

function usePicture(image: ShownImage, falseColour: boolean): Picture | null {
  const decoded = useDecoded(image.url);
  const coloured = useRef<{ of: HTMLImageElement; canvas: HTMLCanvasElement } | null>(null);
  if (!decoded || !falseColour) return decoded;
  if (coloured.current?.of !== decoded) coloured.current = { of: decoded, canvas: falseColoured(decoded) };
  return coloured.current.canvas;
}

const kKeyZoom = 1.4, kKeyPan = 40; // [CSS px]

/// Whether the key is one of ours.
function lookByKey(key: string, { pan, zoom, whole }: Look): boolean {
  const actions: Record<string, () => void> = {
    "+": () => zoom(kKeyZoom), "=": () => zoom(kKeyZoom), "-": () => zoom(1 / kKeyZoom), "0": whole,
    ArrowLeft: () => pan(kKeyPan, 0), ArrowRight: () => pan(-kKeyPan, 0),
    ArrowUp: () => pan(0, kKeyPan), ArrowDown: () => pan(0, -kKeyPan),
  };
  actions[key]?.();
  return key in actions;
}

function LookButtons({ zoom, whole, moved, viewport }: Look & { moved: boolean; viewport: Viewport | null }) {
  return (
    <div class="imagebox-buttons" role="group" aria-label="Zoom">
      <button type="button" onClick={() => zoom(kKeyZoom)} aria-label="Zoom in">+</button>
      <button type="button" onClick={() => zoom(1 / kKeyZoom)} aria-label="Zoom out">−</button>
      <button type="button" onClick={whole} disabled={!moved}>Fit image</button>
      {viewport && <span class="muted">{Math.round(100 * viewport.scale)} %</span>}
    </div>
  );
}

export function ImageCanvas(props: Props) {
  const box = useRef<HTMLDivElement>(null);
  const canvas = useRef<HTMLCanvasElement>(null);
  const image: Size = props.image.header;
  const { size, viewport, moved, look } = useViewport(box, image);
  const picture = usePicture(props.image, props.falseColour ?? false);

  // What the listeners, which outlive a drawing, look at.
  const now = useRef({ props, viewport });
  now.current = { props, viewport };
  useEffect(() => listenToGestures(canvas.current!, {
    pan: look.pan, zoom: look.zoom,
    tap: (at) => { if (now.current.viewport) now.current.props.tap?.(at, now.current.viewport); },
    point: (at) => { if (now.current.viewport) now.current.props.point?.(at, now.current.viewport); },
    aims: () => now.current.props.aims?.() ?? false,
  }), []);

  useLayoutEffect(() => {
    if (!canvas.current || !size || !viewport) return;
    const context = cleared(canvas.current, size);
    if (!picture) return;
    drawPicture(context, picture, viewport, image);
    props.draw({ context, viewport, size, image, picture });
  });

  const keyed = (event: KeyboardEvent): void => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const entered = event.key === "Enter" && props.enter && size && viewport;
    if (entered) props.enter!([size.width / 2, size.height / 2], viewport);
    if (entered || lookByKey(event.key, look)) event.preventDefault();
  };

  return (
    <div class="imagebox">
      <div ref={box} class="imagebox-frame" style={{ aspectRatio: `${image.width} / ${image.height}` }}>
        <canvas
          ref={canvas} tabIndex={0} role="img" aria-label={props.label} data-testid={props.testid}
          style={{ touchAction: moved || props.aims?.() ? "none" : "pan-y" /* a whole image lets the page scroll */ }}
          onKeyDown={keyed} onDblClick={props.tap ? undefined : look.whole}
        />
        {size && viewport && props.children?.(viewport, size)}
      </div>
      <LookButtons {...look} moved={moved} viewport={viewport} />
    </div>
  );
}
