// The report of a solve: figures, poses, and what was checked.
import { images } from "../../store";
import { count, degrees, metres, millimetres, number, px, seconds, sigmas } from "../words";
import { PoseCard } from "./pose_card";
import { matrixOf } from "./poses";
import type { CameraReport, PoseError, ReportMessage, TrainHeldout, SolveStatus } from "./report_message";
import { Table } from "./table";

// Above this by chance once in a thousand times (calib/files/verdict.h).
const kUnlikelyChi2 = 22.5;

function poseError(error: PoseError | undefined): string {
  if (!error || (error.rotation_deg === undefined && error.translation_mm === undefined)) return "–";
  return `${degrees(error.rotation_deg)} and ${millimetres(error.translation_mm, 1)}`;
}

function agreement(chi2: number | undefined) {
  if (chi2 === undefined) return "–";
  return chi2 > kUnlikelyChi2
    ? <span class="caution">! more than the sigmas allow</span>
    : <span class="good">✓ no more than the sigmas allow</span>;
}

function usedAndHeldout(name: string, value: TrainHeldout | undefined, unit: (value?: number) => string): string[][] {
  return value && (value.train !== undefined || value.heldout !== undefined)
    ? [[name, unit(value.train), unit(value.heldout)]] : [];
}

function Figures({ camera }: { camera: CameraReport }) {
  const rows = [
    ...usedAndHeldout("Board's edge against the outline, RMS", camera.edge_rms_px, px),
    ...usedAndHeldout("The same in sigmas (1 is as it should be)", camera.edge_rms_whitened, sigmas),
    ...usedAndHeldout("Distance transform, mean", camera.distance_transform_px, px),
  ];
  return <Table title="How well it fits" head={["", "Views used", "Views kept for the check"]} rows={rows} />;
}

const statusNames: Record<SolveStatus, string> = {
  NOT_SOLVED: "not calibrated", UNDETERMINED: "degenerate", NOT_CONVERGED: "not converged", DEGENERATE: "degenerate",
  FIRST_GUESS_KEPT: "converged; the first guess was kept", CONVERGED: "converged",
};

const ended = ({ status, detail }: { status?: SolveStatus; detail?: string }) =>
  statusNames[status ?? "NOT_SOLVED"] + (detail ? `: ${detail}` : "");

function Facts({ camera }: { camera: CameraReport }) {
  const times = camera.seconds ?? {};
  const offset = camera.range_offset_m;
  const rows = [
    ["Solve", ended(camera)],
    ["Views", `${count(camera.views?.used?.length ?? 0, "view")} used, ${camera.views?.heldout?.length ?? 0} kept for the check, ${camera.views?.rejected?.length ?? 0} rejected`],
    ["First guess away from the truth", poseError(camera.first_guess_error)],
    ["Result away from the truth", poseError(camera.truth_error)],
    ["LIDAR's range offset", offset?.value === undefined ? "–" : `${millimetres(1000 * offset.value, 1)} ± ${millimetres(1000 * (offset.sigma ?? NaN), 1)}`],
    ["Time", `images ${seconds(times.detect_image)}, clouds ${seconds(times.detect_cloud)}, solve ${seconds(times.solve, 3)}`],
  ].filter(([, value]) => value !== "–");
  return <Table title="The solve" head={["", ""]} rows={rows} />;
}

function Sigma({ camera }: { camera: CameraReport }) {
  const axes = (name: string, values: number[] | undefined, unit: (value: number) => string): string[][] =>
    values?.length === 3 ? [[name, ...values.map((value) => unit(value))]] : [];
  const colouring = camera.sigma?.colouring ?? [];
  return (
    <>
      <Table title="1 sigma of the pose" head={["", "x", "y", "z"]} rows={[
        ...axes("Rotation about the camera's axes (x right, y down, z forward)", camera.sigma?.rotation_deg, (value) => degrees(value, 4)),
        ...axes("Camera's centre along the LIDAR's axes (x forward, y left, z up)", camera.sigma?.centre_mm, millimetres),
      ]} />
      <Table title="What that does to the colours" note="How far off in the image a point's colour is taken from, 1 sigma."
        head={["Point this far from the camera", "In the image's middle", "Where it is worst"]}
        rows={colouring.map((at) => [metres(at.distance_m, 0), px(at.centre_px), px(at.worst_px)])} />
    </>
  );
}

function Views({ camera }: { camera: CameraReport }) {
  const rejected = camera.views?.rejected ?? [], warnings = camera.views?.warnings ?? [];
  const rows = (camera.view_quality ?? []).map((view) => [
    view.view, view.heldout ? "kept for the check" : "used", px(view.edge_rms_px), sigmas(view.edge_rms_whitened),
    px(view.distance_transform_px),
  ]);
  return (
    <>
      <Table title="Views" head={["View", "", "Edge RMS", "In sigmas", "Distance transform"]} rows={rows} />
      <Table title="Rejected views" head={["View", "Why"]} rows={rejected.map(({ view, why }) => [view, why])} />
      {warnings.length > 0 && <ul>{warnings.map((warning) => <li key={warning}>{warning}</li>)}</ul>}
    </>
  );
}

function Checks({ camera }: { camera: CameraReport }) {
  const halves = camera.halves;
  return (
    <>
      <Table title="Two halves of the views, each solved by itself" head={["They differ by", "Chi-square, 6 degrees of freedom", "So"]}
        rows={halves ? [[poseError(halves.difference), number(halves.chi2, 1), agreement(halves.chi2)]] : []} />
      <Table title="Each part of the views left out once"
        note="Solved without these views, then judged on them. Misfit: their chi-square; the solve should fit them no worse than the first guess from the same views does."
        head={["Views left out", "Edge RMS", "Misfit", "Misfit of the first guess", "Away from the result"]}
        rows={(camera.folds ?? []).map((fold) => [
          (fold.heldout ?? []).join(", "), sigmas(fold.edge_rms_whitened), number(fold.misfit, 2),
          number(fold.first_guess_misfit, 2), poseError(fold.from_result),
        ])} />
      <Table title="From other starts" head={["Start", "Ended", "Distance transform", "Away from the result"]}
        rows={(camera.other_starts ?? []).map((start) => [
          start.start, ended(start), px(start.distance_transform_px),
          poseError(start.from_result),
        ])} />
      <Table title="What was solved for besides the pose" head={["Unknown", "Value", "1 sigma"]}
        rows={(camera.nuisance ?? []).map(({ name, unit, estimate }) => [
          name, `${number(estimate?.value, 3)} ${unit}`, `${number(estimate?.sigma, 3)} ${unit}`,
        ])} />
    </>
  );
}

function CameraSection({ name, camera, open }: { name: string; camera: CameraReport; open: boolean }) {
  const matrix = matrixOf(camera.camera_from_lidar);
  return (
    <details class="card" open={open} data-testid={`report-${name}`}>
      <summary>{name}</summary>
      {matrix && <PoseCard camera={name} matrix={matrix} />}
      <Figures camera={camera} />
      <Sigma camera={camera} />
      <Views camera={camera} />
      <Checks camera={camera} />
      <Facts camera={camera} />
    </details>
  );
}

/// The report's pictures: how sure a colour is, all over the image.
export function SigmaPictures() {
  const pictures = [...images.value.values()].filter(({ header }) => header.view === "sigma");
  if (pictures.length === 0) return null;
  return (
    <section class="card">
      <h3>How sure a colour is</h3>
      <p class="muted">1 sigma of where in the image a point's colour is taken from, all over each camera's image.</p>
      <div class="pictures several">
        {pictures.map(({ header, url }) => (
          <figure key={header.camera} class="sigma-picture">
            <img src={url} alt={`How sure a colour of ${header.camera} is, all over its image`} />
            <figcaption>{header.camera}</figcaption>
          </figure>
        ))}
      </div>
    </section>
  );
}

/// `open`: unfolded, where there is nothing to do but to read.
export function ReportSection({ report, open }: { report: ReportMessage; open: boolean }) {
  const when = Number(report.utime ?? 0);
  return (
    <section aria-label="Report" data-testid="report">
      <h2>Report</h2>
      <p class="muted">
        Method {report.method || "unknown"}{report.rig_hash && `, rig ${report.rig_hash}`}
        {when > 0 && `, newest image ${new Date(when / 1000).toISOString().replace("T", " ").slice(0, 19)} UTC`}
      </p>
      {Object.entries(report.cameras ?? {}).map(([name, camera]) => <CameraSection key={name} name={name} camera={camera} open={open} />)}
      {(report.closure?.length ?? 0) > 0 && (
        <div class="card">
          <Table title="Camera against camera"
            note="How two cameras sit to each other, found twice: by way of the LIDAR, and from the images alone of views that both see."
            head={["Cameras", "Difference", "1 sigma to be expected", "Chi-square, 6 degrees of freedom", "So"]}
            rows={report.closure!.map((each) => [
              `${each.from} to ${each.to}`, poseError(each.difference), poseError(each.sigma), number(each.chi2, 1), agreement(each.chi2),
            ])} />
        </div>
      )}
    </section>
  );
}
