import { useSignal } from "@preact/signals";
import { copyText } from "./copy";
import { inverse, rowsOf, textOf } from "./poses";

interface MatrixProps { name: string; sentence: string; matrix: number[]; testid: string }

function Matrix({ name, sentence, matrix, testid }: MatrixProps) {
  const said = useSignal("");
  const copy = async (): Promise<void> => {
    said.value = (await copyText(textOf(matrix))) ? "Copied." : "The browser does not let this page copy.";
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
        <span role="status">{said}</span>
      </div>
    </div>
  );
}

/// Both ways, each with the sentence that says which way it is.
export function PoseCard({ camera, matrix }: { camera: string; matrix: number[] }) {
  return (
    <div class="matrices">
      <Matrix name="camera_from_lidar" matrix={matrix} testid={`pose-${camera}`}
        sentence={`A point in the LIDAR's frame becomes one in the frame of ${camera}: point_in_camera = camera_from_lidar · point_in_lidar. Translations in metres.`} />
      <Matrix name="lidar_from_camera" matrix={inverse(matrix)} testid={`pose-inverse-${camera}`}
        sentence={`The other way: point_in_lidar = lidar_from_camera · point_in_camera. Its last column is where the centre of ${camera} sits in the LIDAR's frame.`} />
    </div>
  );
}
