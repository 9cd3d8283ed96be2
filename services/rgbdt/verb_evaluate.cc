#include <algorithm>
#include <cstdio>
#include <memory>

#include "calib/files/calibration_file.h"
#include "calib/files/report_file.h"
#include "calib/solve/calibrate.h"
#include "services/rgbdt/paths.h"
#include "services/rgbdt/session_detection.h"
#include "services/rgbdt/verbs.h"
#include "services/rgbdt/write_report.h"

namespace rgbdt {
namespace {

struct Flags {
  std::string dir, calibration, out, truth;
};

// What only the solve could tell is kept from the report that it wrote.
void KeepFromSolve(const std::filesystem::path& path, Report* report) {
  if (!std::filesystem::exists(path)) return;
  const Report before = ReadReport(path);
  for (CameraReport& camera : report->cameras) {
    const auto same =
        std::find_if(before.cameras.begin(), before.cameras.end(), [&](const CameraReport& other) {
          return other.calibration.camera == camera.calibration.camera &&
                 RotationDistance(other.calibration.camera_from_lidar,
                                  camera.calibration.camera_from_lidar) < 1e-9 &&
                 CentreDistance(other.calibration.camera_from_lidar,
                                camera.calibration.camera_from_lidar) < 1e-9;
        });
    if (same == before.cameras.end()) continue;
    camera.first_guess = same->first_guess;
    camera.range_offset = same->range_offset;
    camera.other_starts = same->other_starts;
    camera.solve_s = same->solve_s;
  }
}

int Run(const Flags& flags) {
  const Session session = OpenSession(flags.dir);
  const std::filesystem::path out = PathOr(flags.out, session.root);
  const Calibration calibration =
      ReadCalibration(PathOr(flags.calibration, session.root / "calibration.textproto"));
  // A calibration that was made elsewhere is judged on what is found without it.
  const bool by_paper = calibration.method == kPaperMethod;
  const SessionDetection detection = DetectSession(session, by_paper ? kPaperMethod : kAutoMethod);
  Report report = Evaluate(session.rig, detection.observations, calibration);
  KeepFromSolve(session.root / "report.json", &report);
  const std::string wrote = "wrote to " + out.string() + ":";
  return FinishReport(out, flags.truth, wrote, session, detection, &report) ? 0 : 1;
}

}  // namespace

void AddEvaluate(CLI::App* app, int* exit_code) {
  CLI::App* verb = app->add_subcommand(
      "evaluate",
      "Judges a calibration on a session's views, used and held out, and against truth where a\n"
      "simulator left it. Writes report.json and report.html.\n"
      "Example: rgbdt evaluate out/demo/session --calibration out/again/calibration.textproto");
  auto flags = std::make_shared<Flags>();
  verb->add_option("DIR", flags->dir, "session directory")->required();
  verb->add_option("--calibration", flags->calibration, "default: DIR/calibration.textproto");
  verb->add_option("--out", flags->out, "where to write; default: DIR");
  verb->add_option("--truth", flags->truth, "truth.textproto; default: DIR's, where there is one");
  verb->callback([flags, exit_code] { *exit_code = Run(*flags); });
}

}  // namespace rgbdt
