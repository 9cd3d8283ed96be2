#include <algorithm>
#include <memory>
#include <utility>

#include "calib/files/schema/calibration_file.h"
#include "calib/files/schema/report_file.h"
#include "calib/methods/calibrate_by_views.h"
#include "calib/methods/detect_session.h"
#include "calib/present/session/report_files.h"
#include "services/rgbdt/print_report.h"
#include "services/rgbdt/verbs.h"

namespace rgbdt {
namespace {

struct EvaluateFlags {
  std::string dir, calibration, out, truth;
  bool anyway = false;
  bool json = false;
};

// The same camera with the same pose; nothing where there is none.
const CameraReport* FindSame(const Report& report, const CameraCalibration& calibration) {
  const auto same =
      std::find_if(report.cameras.begin(), report.cameras.end(), [&](const CameraReport& other) {
        const Rigid3& pose = other.calibration.camera_from_lidar;
        return other.calibration.camera == calibration.camera &&
               RotationDistance(pose, calibration.camera_from_lidar) < 1e-9 &&
               CentreDistance(pose, calibration.camera_from_lidar) < 1e-9;
      });
  return same == report.cameras.end() ? nullptr : &*same;
}

void KeepFromSolve(const CameraReport& before, CameraReport* camera) {
  camera->first_guess = before.first_guess;
  if (camera->contradiction.empty()) camera->contradiction = before.contradiction;
  camera->cannot_tell = before.cannot_tell;
  camera->causes = before.causes;
  camera->view_scatter = before.view_scatter;
  camera->variance_factor = before.variance_factor;
  camera->other_starts = before.other_starts;
  camera->sigma = before.sigma;
  camera->nuisance = before.nuisance;
  camera->folds = before.folds;
  camera->halves = before.halves;
  camera->edges_planes = before.edges_planes;
  camera->solve_s = before.solve_s;
}

// What only the solve tells of a LIDAR beside the reference, where its pose is the same.
void KeepFromSolve(const LidarReport& before, bool same_session, LidarReport* lidar) {
  const Rigid3& pose = before.calibration.reference_from_lidar;
  const Rigid3& given = lidar->calibration.reference_from_lidar;
  if (RotationDistance(pose, given) > 1e-9 || CentreDistance(pose, given) > 1e-9) return;
  lidar->first_guess = before.first_guess;
  lidar->nuisance = before.nuisance;
  if (!same_session) return;
  lidar->rejected = before.rejected;
  for (const std::string& warning : before.warnings) {
    const auto said = std::find(lidar->warnings.begin(), lidar->warnings.end(), warning);
    if (said == lidar->warnings.end()) lidar->warnings.push_back(warning);
  }
}

// Those without a pose have their reason in the report alone.
void KeepFromSolve(const Report& before, bool same_session, std::vector<LidarReport>* lidars) {
  for (const LidarReport& other : before.lidars) {
    const auto same = std::find_if(lidars->begin(), lidars->end(), [&](const LidarReport& lidar) {
      return lidar.calibration.lidar == other.calibration.lidar;
    });
    if (same != lidars->end()) {
      KeepFromSolve(other, same_session, &*same);
    } else if (!other.calibration.solved()) {
      lidars->push_back(other);
    }
  }
}

constexpr char kNoReport[] =
    "Beside the calibration lies no report of its solve: what that has found (causes, halves, "
    "scatter of the views) is not known here.";

// What only the solve could tell is kept from the report that it wrote, beside the calibration or,
// where that lies elsewhere, in the session; what it tells of the cameras together, where all of
// them are still the same.
void KeepFromSolve(const CalibrationFiles& files, const std::filesystem::path& session,
                   Report* report) {
  std::filesystem::path path = files.calibration.parent_path() / "report.json";
  if (!std::filesystem::exists(path)) path = session / "report.json";
  const Report before = std::filesystem::exists(path) ? ReadReport(path) : Report();
  // Of another session's report: its views have the same names, and are others.
  const bool same_session = std::filesystem::weakly_canonical(path.parent_path()) ==
                            std::filesystem::weakly_canonical(session);
  bool all_same = true;
  for (CameraReport& camera : report->cameras) {
    const CameraReport* same = FindSame(before, camera.calibration);
    if (same != nullptr) {
      KeepFromSolve(*same, &camera);
      if (same_session) camera.warnings = same->warnings;
    } else if (report->method == kAutoMethod) {
      camera.cannot_tell = kNoReport;
    }
    all_same = all_same && same != nullptr;
  }
  KeepFromSolve(before, same_session, &report->lidars);
  if (!all_same) return;
  report->closure = before.closure;
  report->next_view = before.next_view;
}

int RunEvaluate(const EvaluateFlags& flags) {
  const Session session = OpenSession(flags.dir);
  const std::filesystem::path out = PathOr(flags.out, session.root);
  CheckWritable(out / "report.json");
  const std::optional<Truth> truth = ReadTruthOf(flags.truth, session.root);  // before the work
  const CalibrationFiles files = FilesOf(session.root, flags.calibration, flags.anyway);
  const Calibration calibration = ReadCalibrationOf(files);
  PrintWarnings(RequireSameRig(calibration, session.rig, files.Names(), files.HowToUse()));
  // A calibration that was made elsewhere is judged on what is found without it.
  const bool by_paper = calibration.method == kPaperMethod;
  const SessionDetection detection =
      DetectSession(session, by_paper ? kPaperMethod : kAutoMethod, PrintProgress);
  RequireReadable(session, detection.unreadable);
  Report report = Evaluate(session.rig, detection.views, calibration);
  KeepFromSolve(files, session.root, &report);
  report = WithUnlisted(std::move(report), session, detection.views);
  if (truth) report = WithTruth(std::move(report), *truth);
  const auto reports = CalibrateByViews(session.rig, detection.views, report);
  const Session listed = ListedOnly(session, detection.views);
  WriteReportFiles(out, {listed, detection.views, reports});
  PrintReport(flags.json, report, out, "wrote to " + out.string() + ":", detection.unreadable);
  PrintUnreadable(detection.unreadable);
  return static_cast<int>(WorseOf(EndsIf(detection.unreadable.empty()), EndOf(report)));
}

}  // namespace

void AddEvaluate(CommandLine* program) {
  auto flags = std::make_shared<EvaluateFlags>();
  CommandLine* verb = program->Verb(
      "evaluate",
      "Judges a calibration on a session's views, used and held out, and against the truth of a\n"
      "simulated session. Writes report.json and report.html over those of calibrate, whose "
      "findings\n"
      "it keeps. A calibration that was made with another rig is refused.\n"
      "Example: rgbdt evaluate out/demo/session --calibration out/again/calibration.textproto",
      [flags] { return RunEvaluate(*flags); });
  verb->Ends(ExitCode::kFailed,
             "failed, the solve of a camera had not converged, or a view could not be read");
  AddVerdictEnds(verb);
  verb->Required("DIR", &flags->dir, "session directory");
  verb->Option("--calibration", &flags->calibration, "default: DIR/calibration.textproto");
  verb->Option("--out", &flags->out, "where to write; default: DIR");
  verb->Option("--truth", &flags->truth, "truth.textproto; default: DIR's, where there is one");
  AddJson(verb, &flags->json);
  AddAnyway(verb, &flags->anyway, "the rig is another");
}

}  // namespace rgbdt
