// How far a view's board edge lies from the outline, as a bar, with what is expected (1 sigma).
import type { SessionFrame, ViewCamera } from "../../protocol";
import { millimetres, px, sigmas } from "../words";

const kLeastPx = 1; // what a whole bar stands for at least

/// What a whole bar stands for [px]: the worst of a camera's views, and all that is expected of them.
export function barLength(views: SessionFrame["views"], camera: string): number {
  const own = views.flatMap((view) => view.cameras.filter((each) => each.camera === camera));
  return Math.max(kLeastPx, ...own.flatMap((each) => [each.edge_rms_px ?? 0, expectedPx(each) ?? 0]));
}

/// 1 sigma [px]; null: not known.
export function expectedPx({ edge_rms_px: rms, edge_rms_sigmas: many }: ViewCamera): number | null {
  return rms === null || many === null || !(many > 0) ? null : rms / many;
}

function gradeOf(many: number | null): string {
  return many === null ? "" : many > 2 ? "bad" : many > 1.4 ? "caution" : "good";
}

/// `length`: of barLength.
export function ResidualBar({ own, length, testid }: { own: ViewCamera; length: number; testid: string }) {
  if (own.edge_rms_px === null) return null;
  const expected = expectedPx(own);
  const percent = (value: number): string => `${(100 * Math.min(1, value / length)).toFixed(1)}%`;
  const words = [
    `outline error ${px(own.edge_rms_px)}`,
    own.edge_rms_mm === null ? "" : millimetres(own.edge_rms_mm, 1),
    own.edge_rms_sigmas === null ? "" : sigmas(own.edge_rms_sigmas),
    own.plane_rms_mm === null ? "" : `points ${millimetres(own.plane_rms_mm, 1)} from the plane`,
  ];
  return (
    <div class="residual" data-testid={testid}>
      <div class="residual-track" aria-hidden="true">
        <div class={`residual-bar ${gradeOf(own.edge_rms_sigmas)}`} style={{ width: percent(own.edge_rms_px) }} />
        {expected !== null && <div class="residual-sigma" style={{ left: percent(expected) }} title={`1 sigma: ${px(expected)}`} />}
      </div>
      <span class="residual-words">{words.filter(Boolean).join(", ")}</span>
    </div>
  );
}
