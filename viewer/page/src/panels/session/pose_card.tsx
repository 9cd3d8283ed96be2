import { useSignal } from "@preact/signals";
import type { Pose } from "../../protocol";
import { copyText } from "./copy";

const rowsOf = (matrix: number[]): number[][] => [0, 4, 8, 12].map((start) => matrix.slice(start, start + 4));

/// As JSON, and so as Python and many others read it.
export function textOf(matrix: number[]): string {
  return `[${rowsOf(matrix).map((row) => `[${row.join(", ")}]`).join(",\n ")}]`;
}

function Matrix({ pose: { name, sentence, matrix }, testid }: { pose: Pose; testid: string }) {
  const message = useSignal("");
  const copy = async (): Promise<void> => {
    message.value = (await copyText(textOf(matrix))) ? "Copied." : "The browser does not allow copying.";
  };
  return (
    <div class="matrix" data-testid={testid}>
      <h4>{name}</h4>
      <p class="muted">{sentence}</p>
      <div class="scroll-x">
        <table class="mono" aria-label={name}>
          <tbody>{rowsOf(matrix).map((row, i) => (
            <tr key={i}>{row.map((value, j) => <td key={j} class="number">{value.toFixed(i === 3 ? 0 : 6)}</td>)}</tr>
          ))}</tbody>
        </table>
      </div>
      <div class="row">
        <button type="button" onClick={() => void copy()} data-testid={`${testid}-copy`}>Copy {name}</button>
        <span role="status">{message}</span>
      </div>
    </div>
  );
}

/// camera_from_lidar, and folded its inverse, each with the sentence that says which way it is.
export function PoseCard({ camera, poses: [first, ...others] }: { camera: string; poses: Pose[] }) {
  const matrix = (pose: Pose) => <Matrix key={pose.name} pose={pose} testid={`pose-${camera}-${pose.name}`} />;
  return (
    <div class="matrices">
      {first && matrix(first)}
      {others.length > 0 && <details><summary>The inverse</summary>{others.map(matrix)}</details>}
    </div>
  );
}
