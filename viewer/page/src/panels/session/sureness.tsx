// How sure the calibration is: sigma by the number of views, and the error on views held out.
import type { CameraState, SessionFrame } from "../../protocol";
import { degrees, millimetres, px, sigmas } from "../words";
import { LineChart } from "./line_chart";
import type { Line } from "./line_chart";

type Step = SessionFrame["sigma"][number]["cameras"][number];

function linesOf(sigma: SessionFrame["sigma"], value: (step: Step) => number): Line[] {
  const names = [...new Set(sigma.flatMap(({ cameras }) => cameras.map((each) => each.camera)))];
  return names.map((name) => ({
    name,
    values: sigma.map(({ cameras }) => {
      const own = cameras.find((each) => each.camera === name);
      return own ? value(own) : null;
    }),
  }));
}

export function SigmaCharts({ sigma }: { sigma: SessionFrame["sigma"] }) {
  if (sigma.length === 0) return <p class="muted">No calibration yet: its sigma is shown from the first one on.</p>;
  const x = sigma.map(({ views }) => views);
  return (
    <div class="charts">
      <LineChart title="Rotation, 1 sigma [°], by number of views" testid="chart-rotation" x={x}
        lines={linesOf(sigma, (step) => step.rotation_deg)} text={(value) => degrees(value)} />
      <LineChart title="Camera's centre, 1 sigma [mm], by number of views" testid="chart-centre" x={x}
        lines={linesOf(sigma, (step) => step.centre_mm)} text={(value) => millimetres(value, value < 10 ? 1 : 0)} />
    </div>
  );
}

// The verdict's own limits (calib/files/verdict.cc).
const kLeastSigmas = 0.7, kMostSigmas = 1.4;

export function sigmasWords(value: number): { grade: "good" | "caution"; words: string } {
  if (value > kMostSigmas) return { grade: "caution", words: "less exact than stated" };
  if (value < kLeastSigmas) return { grade: "caution", words: "more exact than stated" };
  return { grade: "good", words: "as it should be" };
}

function HeldoutRow({ camera }: { camera: CameraState }) {
  const value = camera.heldout_edge_sigmas;
  const judged = value === null ? null : sigmasWords(value);
  return (
    <tr data-testid={`heldout-${camera.camera}`}>
      <th scope="row">{camera.camera}</th>
      <td class="number">{px(camera.heldout_edge_px)}</td>
      <td class="number">{sigmas(value)}</td>
      <td>{judged ? <span class={judged.grade}>{judged.grade === "good" ? "✓" : "!"} {judged.words}</span> : "not judged yet"}</td>
    </tr>
  );
}

export function HeldoutErrors({ cameras }: { cameras: CameraState[] }) {
  if (cameras.length === 0) return null;
  return (
    <>
      <p class="muted">How far the cloud's edge misses the board's outline on views that the solver never saw (RMS). 1 sigma is as it should be.</p>
      <div class="scroll-x">
        <table>
          <thead><tr><th scope="col">Camera</th><th scope="col" class="number">Error</th><th scope="col" class="number">In sigmas</th><th scope="col">So</th></tr></thead>
          <tbody>{cameras.map((camera) => <HeldoutRow key={camera.camera} camera={camera} />)}</tbody>
        </table>
      </div>
    </>
  );
}
