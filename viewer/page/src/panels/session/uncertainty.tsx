// The calibration's uncertainty by the number of views.
import type { SessionFrame } from "../../protocol";
import { degrees, millimetres } from "../words";
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
  if (sigma.length === 0) return <p class="muted">No calibration yet.</p>;
  const x = sigma.map(({ views }) => views);
  return (
    <div class="charts">
      <LineChart title="Rotation, 1 sigma [°], by number of views" testid="chart-rotation" x={x}
        lines={linesOf(sigma, (step) => step.rotation_deg)} text={(value) => degrees(value)} />
      <LineChart title="Camera position, 1 sigma [mm], by number of views" testid="chart-centre" x={x}
        lines={linesOf(sigma, (step) => step.centre_mm)} text={(value) => millimetres(value, value < 10 ? 1 : 0)} />
    </div>
  );
}
