// The result first: verdict, pose and uncertainty of each camera.
import { signal } from "@preact/signals";
import type { ComponentChildren } from "preact";
import type { CameraState, SessionFrame } from "../../protocol";
import { degrees, metres, millimetres, px } from "../words";
import { LeftOutNote } from "./left_out";
import { PoseCard } from "./pose_card";
import { RefusedNote } from "./refused";
import { gradeClass, kGradeIcon, VerdictCard } from "./verdict";

const kDistancesM = [2, 5, 10];
const kNearestM = 0.3; // nearer than that there is no pose of interest
const chosenDistance = signal(20); // [m], beside those

/// The projection uncertainty (1 sigma, where it is worst in the image) so far away, in words.
export function projectionAt({ projection }: CameraState, distance_m: number): string {
  const variances = projection.map(([lasting, per_m, per_m2]) => lasting + per_m / distance_m + per_m2 / distance_m ** 2);
  return px(variances.length > 0 ? Math.sqrt(Math.max(0, ...variances)) : null);
}

function DistanceChoice() {
  return (
    <>
      <input type="number" min={kNearestM} step="any" value={chosenDistance.value} data-testid="projection-distance"
        aria-label="Distance of the point from the camera, m"
        onInput={(event) => {
          const typed = event.currentTarget.valueAsNumber; // NaN while nothing is there
          if (typed >= kNearestM) chosenDistance.value = typed;
        }} />{" m"}
    </>
  );
}

interface LineProps { cameras: CameraState[]; name: ComponentChildren; value(camera: CameraState): string; testid?: string }

function Line({ cameras, name, value, testid }: LineProps) {
  return <tr data-testid={testid}><th scope="row">{name}</th>{cameras.map((camera) => <td key={camera.camera}>{value(camera)}</td>)}</tr>;
}

function Uncertainty({ cameras }: { cameras: CameraState[] }) {
  return (
    <div class="scroll-x">
      <table class="answer-table" aria-label="Uncertainty, 1 sigma" data-testid="answer-uncertainty">
        <thead><tr><th scope="col">Uncertainty, 1 sigma</th>{cameras.map(({ camera }) => <th key={camera} scope="col">{camera}</th>)}</tr></thead>
        <tbody>
          <Line cameras={cameras} name="rotation, worst axis" value={(camera) => degrees(camera.rotation_sigma_deg)} />
          <Line cameras={cameras} name="position, worst axis" value={(camera) => millimetres(camera.centre_sigma_mm, 1)} />
          {kDistancesM.map((each) => (
            <Line key={each} cameras={cameras} name={`projection at ${metres(each, 0)}, up to`} value={(camera) => projectionAt(camera, each)} />
          ))}
          <Line cameras={cameras} name={<>projection at <DistanceChoice />, up to</>}
            value={(camera) => projectionAt(camera, chosenDistance.value)} testid="projection-chosen" />
        </tbody>
      </table>
    </div>
  );
}

/// Its reasons folded: those that speak against it stand in the verdict of all cameras.
function CameraVerdict({ camera, verdict }: CameraState) {
  return (
    <details data-testid={`verdict-${camera}`} data-grade={verdict.grade}>
      <summary><span class={gradeClass(verdict.grade)}><span aria-hidden="true">{kGradeIcon[verdict.grade]}</span> {camera}: {verdict.headline}</span></summary>
      <ul>{verdict.reasons.map((reason) => <li key={reason}>{reason}</li>)}</ul>
    </details>
  );
}

function CameraAnswer({ camera, several }: { camera: CameraState; several: boolean }) {
  return (
    <article class="camera-answer" aria-label={camera.camera}>
      {several && <CameraVerdict {...camera} />}
      {camera.poses.length > 0 && <PoseCard camera={camera.camera} poses={camera.poses} />}
    </article>
  );
}

export function Answer({ session }: { session: SessionFrame }) {
  const solved = session.cameras.filter(({ calibrated }) => calibrated);
  const several = session.cameras.length > 1;
  return (
    <section class="card" aria-label="Assessment">
      <h2>Assessment</h2>
      <VerdictCard verdict={session.verdict} testid="verdict" />
      <RefusedNote session={session} />
      <LeftOutNote session={session} />
      {solved.length > 0 && <Uncertainty cameras={solved} />}
      <div class="camera-answers">
        {session.cameras.map((camera) => <CameraAnswer key={camera.camera} camera={camera} several={several} />)}
      </div>
    </section>
  );
}
