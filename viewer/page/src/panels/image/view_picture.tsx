// A view's image with what the calibration lays on it, small and still.
import { useEffect, useRef } from "preact/hooks";
import type { ShownImage, ShownOverlay } from "../../store";
import { useDecoded } from "./decoded";
import { drawPicture } from "./image_canvas";
import { drawOverlay, type OverlaySwitches } from "./overlay_drawing";
import { fitted } from "./viewport";

const kWidth = 480; // [px] of the canvas
const kShown: OverlaySwitches = { corners: false, outline: true, edge: false, cloud: true };

interface Props { image: ShownImage; overlay: ShownOverlay | undefined; label: string; testid: string }

export function ViewPicture({ image, overlay, label, testid }: Props) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const picture = useDecoded(image.url);
  const { width, height } = image.header;
  const size = { width: kWidth, height: Math.round((kWidth * height) / width) };
  useEffect(() => {
    const context = canvas.current?.getContext("2d");
    if (!context || !picture) return;
    const viewport = fitted(size, image.header);
    context.clearRect(0, 0, size.width, size.height);
    drawPicture(context, picture, viewport, image.header);
    if (overlay) drawOverlay(context, viewport, overlay, kShown);
    canvas.current!.dataset.points = String(overlay ? overlay.cloud.length / 3 : 0);
  }, [picture, overlay]);
  return <canvas ref={canvas} class="view-picture" width={size.width} height={size.height} role="img" aria-label={label} data-testid={testid} />;
}
