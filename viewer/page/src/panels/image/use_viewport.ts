// A viewport that pans and zooms, of an image in an element.
import { useLayoutEffect, useMemo, useRef, useState } from "preact/hooks";
import type { Vec2 } from "../../protocol";
import { fitted, panned, zoomed } from "./viewport";
import type { Size, Viewport } from "./viewport";

export interface Look {
  pan(dx: number, dy: number): void;
  zoom(factor: number, centre?: Vec2): void; // without a centre: about the middle
  whole(): void;
}

type Element = { current: HTMLElement | null };

/// [CSS px]; null until it is laid out.
function useSize(element: Element): Size | null {
  const [size, setSize] = useState<Size | null>(null);
  useLayoutEffect(() => {
    const box = element.current;
    if (!box) return;
    const measure = (): void => {
      if (box.clientWidth > 0 && box.clientHeight > 0) setSize({ width: box.clientWidth, height: box.clientHeight });
    };
    const observer = new ResizeObserver(measure);
    observer.observe(box);
    measure();
    return () => observer.disconnect();
  }, []);
  return size;
}

export function useViewport(element: Element, image: Size) {
  const size = useSize(element);
  const [moved, setMoved] = useState<Viewport | null>(null); // null: the whole image
  const now = useRef({ size, image }); // for listeners, which outlive a drawing
  now.current = { size, image };
  const look = useMemo<Look>(() => {
    const change = (next: (at: Viewport, size: Size, image: Size) => Viewport): void => setMoved((before) => {
      const { size, image } = now.current;
      return size ? next(before ?? fitted(size, image), size, image) : before;
    });
    return {
      pan: (dx, dy) => change((at, size, image) => panned(at, dx, dy, size, image)),
      zoom: (factor, centre) => change((at, size, image) =>
        zoomed(at, factor, centre ?? [size.width / 2, size.height / 2], size, image)),
      whole: () => setMoved(null),
    };
  }, []);
  const viewport = size && (moved ? panned(moved, 0, 0, size, image) : fitted(size, image));
  return { size, viewport, moved: moved !== null, look };
}
