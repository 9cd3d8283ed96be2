import { useEffect, useRef, useState } from "preact/hooks";
import { measureAt, pickAt, setVisible, startScene } from "../cloud/model";
import type { CloudScene } from "../cloud/scene";
import { ends, measuring, picked } from "../cloud/settings";
import { hello } from "../store";
import { compassParts, turnCompass } from "./cloud/compass";
import { Controls, Status } from "./cloud/controls";
import { Legend } from "./cloud/legend";
import { PointCard } from "./cloud/point_card";
import "./cloud/cloud.css";

const kTap = { px: 6, ms: 700 }; // what moved less, and took no longer, is no drag

/// Calls `onTap` with the window's pixel.
function listenToTaps(canvas: HTMLCanvasElement, onTap: (x: number, y: number) => void): void {
  let down: PointerEvent | null = null;
  canvas.addEventListener("pointerdown", (event) => { down = event.isPrimary && event.button === 0 ? event : null; });
  canvas.addEventListener("pointerup", (event) => {
    const still = down && Math.hypot(event.clientX - down.clientX, event.clientY - down.clientY) < kTap.px;
    if (down && still && event.timeStamp - down.timeStamp < kTap.ms) onTap(event.clientX, event.clientY);
    down = null;
  });
}

function placeMarker(marker: HTMLElement, scene: CloudScene, canvas: HTMLCanvasElement): void {
  const point = picked.peek();
  const at = point && scene.project(point.position);
  const box = canvas.getBoundingClientRect();
  marker.hidden = !at?.inFront;
  if (at) marker.style.transform = `translate(${at.x - box.left}px, ${at.y - box.top}px)`;
}

interface Parts { canvas: HTMLCanvasElement; marker: HTMLElement; words: HTMLElement; compass: SVGSVGElement }

function start({ canvas, marker, words, compass }: Parts): () => void {
  const scene = startScene(canvas, words, () => {
    placeMarker(marker, scene, canvas);
    turnCompass(compass, scene.axesOnScreen());
  });
  listenToTaps(canvas, (x, y) => (measuring.peek() ? measureAt(x, y) : pickAt(x, y)));
  const stopMarker = picked.subscribe(() => placeMarker(marker, scene, canvas));
  const forget = (event: KeyboardEvent) => { if (event.key === "Escape") [picked.value, ends.value] = [null, []]; };
  addEventListener("keydown", forget);
  canvas.addEventListener("dblclick", () => {
    [picked.value, ends.value] = [null, []];
    scene.fit();
  });
  const sizes = new ResizeObserver(([entry]) => scene.resize(entry.contentRect.width, entry.contentRect.height));
  sizes.observe(canvas.parentElement!);
  return () => { stopMarker(); removeEventListener("keydown", forget); sizes.disconnect(); };
}

export function CloudPanel({ visible }: { visible: boolean }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const marker = useRef<HTMLDivElement>(null);
  const words = useRef<HTMLDivElement>(null);
  const compass = useRef<SVGSVGElement>(null);
  const [failure, setFailure] = useState("");
  useEffect(() => {
    try {
      return start({ canvas: canvas.current!, marker: marker.current!, words: words.current!, compass: compass.current! });
    } catch (error) {
      setFailure(`The cloud cannot be drawn: this browser has no WebGL 2 (${error})`);
    }
  }, []);
  useEffect(() => setVisible(visible), [visible]);
  return (
    <div class="cloud">
      <div class="cloud-canvas">
        <canvas ref={canvas} tabIndex={0} data-testid="cloud-canvas"
          aria-label="The fused cloud. Arrow keys move it, with Shift turn it; plus and minus zoom." />
        <div ref={words} class="cloud-labels" aria-hidden="true" data-testid="cloud-labels" />
        <svg ref={compass} class="cloud-compass" viewBox="-42 -42 84 84" aria-hidden="true" data-testid="cloud-compass">{compassParts()}</svg>
        <div ref={marker} class="cloud-marker" hidden data-testid="cloud-marker" />
        {failure && <p class="empty bad" role="alert">{failure}</p>}
      </div>
      <Controls />
      <div class="cloud-foot">
        <Legend />
        <Status />
      </div>
      <PointCard />
      {!hello.value && <p class="cloud-wait empty">Waiting for data.</p>}
    </div>
  );
}
