// Lines over whole numbers (views, seconds), on a logarithmic axis.
import { useEffect, useRef } from "preact/hooks";
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { theme } from "../../theme";
import { logMarks } from "./log_scale";

export interface Line { name: string; values: (number | null)[] }

interface Props {
  title: string; // with the unit
  x: number[]; // whole, growing
  lines: Line[];
  text(value: number): string; // with the unit
  testid: string;
}

const kColours = ["--accent", "--caution", "--good", "--text", "--bad"];
const kDashes = [[], [8, 5], [2, 4], [12, 4, 2, 4]];
const kHeight = 200; // [px]

function styleOf(index: number): { colour: string; dash: number[] } {
  const colours = getComputedStyle(document.documentElement);
  return {
    colour: colours.getPropertyValue(kColours[index % kColours.length]!).trim(),
    dash: kDashes[index % kDashes.length]!,
  };
}

function axisOf(more: uPlot.Axis): uPlot.Axis {
  const colours = getComputedStyle(document.documentElement);
  const stroke = colours.getPropertyValue("--text").trim(), line = colours.getPropertyValue("--line").trim();
  return { stroke, font: "14px system-ui, sans-serif", grid: { stroke: line, width: 1 }, ticks: { stroke: line, width: 1 }, ...more };
}

function optionsOf({ x, lines, text }: Props, width: number): uPlot.Options {
  const marks = logMarks(lines.flatMap((line) => line.values.filter((value) => value !== null)));
  const every = Math.ceil(x.length / Math.max(2, width / 60));
  return {
    width, height: kHeight,
    legend: { show: false }, // our own one says the newest values
    cursor: { show: false },
    scales: {
      x: { time: false, range: [Math.min(...x) - 0.5, Math.max(...x) + 0.5] },
      y: { distr: 3, range: [marks[0] ?? 1, marks[marks.length - 1] ?? 10] },
    },
    axes: [
      axisOf({ splits: () => x.filter((_, i) => i % every === 0), values: (_, at) => at.map(String) }),
      axisOf({ size: 76, splits: () => marks, filter: (_, at) => at, values: (_, at) => at.map(text) }),
    ],
    series: [{}, ...lines.map((line, i) => {
      const { colour, dash } = styleOf(i);
      return { label: line.name, stroke: colour, width: 2.5, dash, points: { show: true, size: 7, fill: colour } };
    })],
  };
}

function dataOf({ x, lines }: Props): uPlot.AlignedData {
  return [x, ...lines.map((line) => line.values.map((value) => (value !== null && value > 0 ? value : null)))];
}

function LineLegend({ lines, text }: Props) {
  return (
    <ul class="legend">
      {lines.map((line, i) => {
        const newest = line.values[line.values.length - 1];
        const { colour, dash } = styleOf(i);
        return (
          <li key={line.name}>
            <svg class="mark line" viewBox="0 0 36 8" aria-hidden="true">
              <path d="M0 4H36" stroke={colour} stroke-width="3" stroke-dasharray={dash.join(" ")} />
            </svg>
            {" "}{line.name}: {newest === null || newest === undefined ? "–" : text(newest)}
          </li>
        );
      })}
    </ul>
  );
}

export function LineChart(props: Props) {
  const box = useRef<HTMLDivElement>(null);
  const key = JSON.stringify([props.x, props.lines, theme.value]);
  useEffect(() => {
    const element = box.current;
    if (!element) return;
    let plot: uPlot | null = null;
    // Made anew with the width: marks and labels depend on it.
    const draw = (): void => {
      if (element.clientWidth === 0 || plot?.width === element.clientWidth) return;
      plot?.destroy();
      plot = new uPlot(optionsOf(props, element.clientWidth), dataOf(props), element);
    };
    const observer = new ResizeObserver(draw);
    observer.observe(element);
    draw();
    return () => { observer.disconnect(); plot?.destroy(); };
  }, [key]);
  return (
    <figure class="chart" data-testid={props.testid}>
      <figcaption>{props.title}</figcaption>
      <div ref={box} class="chart-plot" role="img" aria-label={props.title} />
      <LineLegend {...props} />
    </figure>
  );
}
