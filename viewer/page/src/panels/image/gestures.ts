// Mouse, pen and fingers on an element, as pans, zooms and taps.
import type { Vec2 } from "../../protocol";

export interface GestureHandlers {
  pan(dx: number, dy: number): void;
  zoom(factor: number, centre: Vec2): void;
  tap?(at: Vec2): void;
  /// The pointer is here, without or with a button; null: it left.
  point?(at: Vec2 | null): void;
  /// Whether one finger aims (and taps where it is lifted) rather than pans.
  aims?(): boolean;
}

const kTapPx = 6; // [CSS px] that a tap may wander

interface Pressed { at: Vec2; from: Vec2; moved: boolean; aiming: boolean }

class Gestures {
  private pressed = new Map<number, Pressed>();
  private pinched = false; // two fingers were down: what is lifted now is no tap

  constructor(private element: HTMLElement, private handlers: GestureHandlers) {}

  private at(event: MouseEvent): Vec2 {
    const box = this.element.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  down(event: PointerEvent): void {
    if (event.button !== 0) return;
    this.element.setPointerCapture(event.pointerId);
    const at = this.at(event);
    if (this.pressed.size === 0) this.pinched = false;
    const aiming = event.pointerType === "touch" && (this.handlers.aims?.() ?? false);
    this.pressed.set(event.pointerId, { at, from: at, moved: false, aiming });
    if (this.pressed.size > 1) {
      this.pinched = true;
      this.handlers.point?.(null);
    } else if (aiming || event.pointerType !== "touch") {
      this.handlers.point?.(at);
    }
  }

  move(event: PointerEvent): void {
    const at = this.at(event);
    const own = this.pressed.get(event.pointerId);
    if (!own) {
      if (event.pointerType !== "touch") this.handlers.point?.(at);
    } else if (this.pressed.size === 1) {
      this.drag(own, at);
    } else {
      this.pinch(event.pointerId, own, at);
    }
  }

  private drag(own: Pressed, at: Vec2): void {
    own.moved ||= Math.hypot(at[0] - own.from[0], at[1] - own.from[1]) > kTapPx;
    if (own.aiming && !this.pinched) {
      this.handlers.point?.(at);
    } else if (own.moved) {
      this.handlers.point?.(null);
      this.handlers.pan(at[0] - own.at[0], at[1] - own.at[1]);
    }
    if (own.aiming || own.moved) own.at = at;
  }

  private pinch(id: number, own: Pressed, at: Vec2): void {
    const other = [...this.pressed].find(([key]) => key !== id)?.[1].at;
    if (other) {
      const before = Math.hypot(own.at[0] - other[0], own.at[1] - other[1]);
      const after = Math.hypot(at[0] - other[0], at[1] - other[1]);
      this.handlers.pan((at[0] - own.at[0]) / 2, (at[1] - own.at[1]) / 2);
      if (before > 1) this.handlers.zoom(after / before, [(at[0] + other[0]) / 2, (at[1] + other[1]) / 2]);
    }
    own.at = at;
  }

  up(event: PointerEvent, cancelled: boolean): void {
    const own = this.pressed.get(event.pointerId);
    if (!own) return;
    this.pressed.delete(event.pointerId);
    if (!cancelled && !this.pinched && (own.aiming || !own.moved)) this.handlers.tap?.(this.at(event));
    if (event.pointerType === "touch") this.handlers.point?.(null);
  }

  leave(): void {
    if (this.pressed.size === 0) this.handlers.point?.(null);
  }

  wheel(event: WheelEvent): void {
    event.preventDefault();
    const lines = event.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? event.deltaY / 100 : event.deltaY / 3;
    this.handlers.zoom(Math.exp(-0.25 * Math.max(-4, Math.min(4, lines))), this.at(event));
  }
}

/// Listens until the function that it returns is called.
export function listenToGestures(element: HTMLElement, handlers: GestureHandlers): () => void {
  const gestures = new Gestures(element, handlers);
  const abort = new AbortController();
  const listen = <K extends keyof HTMLElementEventMap>(name: K, take: (event: HTMLElementEventMap[K]) => void): void =>
    element.addEventListener(name, take, { signal: abort.signal, passive: false });
  listen("pointerdown", (event) => gestures.down(event));
  listen("pointermove", (event) => gestures.move(event));
  listen("pointerup", (event) => gestures.up(event, false));
  listen("pointercancel", (event) => gestures.up(event, true));
  listen("pointerleave", () => gestures.leave());
  listen("wheel", (event) => gestures.wheel(event));
  return () => abort.abort();
}
