// What browser tests read and do where clicks and `data-testid` do not reach: `window.rgbdt`.
import { pickAt, sceneNow, shownCloud } from "./cloud/model";
import type { PointValues } from "./cloud/points";
import type { ViewName } from "./cloud/viewpoint";

const access = {
  cloud: {
    /// The session's view whose cloud is shown; "": what came live.
    view: shownCloud,
    /// Points in the frame drawn last.
    points: (): number => sceneNow()?.points ?? 0,
    /// Points that are shown: while the view moves, fewer are drawn.
    total: (): number => sceneNow()?.total ?? 0,
    /// Frames drawn since the page was opened.
    drawn: (): number => sceneNow()?.pace.frames ?? 0,
    /// Frames drawn in the last second. It draws on demand: 0 where nothing changes.
    fps: (): number => sceneNow()?.pace.fps(performance.now()) ?? 0,
    /// What the frame drawn last took [ms].
    cost: (): number => sceneNow()?.pace.cost_ms ?? 0,
    /// "": it does not say; what draws, e.g. "ANGLE (... SwiftShader ...)".
    renderer: (): string => sceneNow()?.renderer ?? "",
    /// A point of the shown frame [m] to pixels of the window, as a mouse has them.
    project: (x: number, y: number, z: number) => sceneNow()?.project([x, y, z]) ?? null,
    look: (view: ViewName): void => sceneNow()?.look(view),
    /// As a tap on that pixel of the window; the picked point's values, null where there is none.
    pickAt: (x: number, y: number): PointValues | null => pickAt(x, y),
  },
};

declare global {
  interface Window { rgbdt: typeof access }
}
window.rgbdt = access;
