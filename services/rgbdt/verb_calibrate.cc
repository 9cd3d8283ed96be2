#include <cstdio>
#include <memory>

#include "calib/methods/calibrate_by_views.h"
#include "calib/methods/detect_session.h"
#include "calib/present/session/report_files.h"
#include "services/rgbdt/print_report.h"
#include "services/rgbdt/verbs.h"

namespace rgbdt {
namespace {

struct Flags {
  std::string dir, out, truth;
  CalibrateOptions options;
};

int Run(const Flags& flags) {
  flags.options.Check();
  const Session session = OpenSession(flags.dir);
  const std::filesystem::path out = PathOr(flags.out, session.root);
  const SessionDetection detection = DetectSession(session, flags.options.method, PrintProgress);
  std::fprintf(stderr, "solving ...\n");
  Report report = Calibrate(session.rig, detection.views, flags.options);
  const std::string wrote = WriteIfSolved(out, report);
  const auto truth = TruthPath(flags.truth, session.root);
  if (!truth.empty()) AddTruth(ReadTruth(truth), &report);
  const auto reports = CalibrateByViews(session.rig, detection.views, report);
  WriteReportFiles(out, {session, detection.views, reports});
  PrintReport(report, wrote, detection.unreadable);
  return detection.unreadable.empty() && Summary(report).converged() ? 0 : 1;
}

}  // namespace

void AddCalibrate(CLI::App* app, int* exit_code) {
  CLI::App* verb = app->add_subcommand(
      "calibrate",
      "Finds each camera's pose relative to the LIDAR from a session directory.\n"
      "Writes calibration.textproto, report.json and report.html. Exit code 1: a camera did not\n"
      "converge, or a view could not be read.\n"
      "Example: rgbdt calibrate out/demo/session --out out/again");
  auto flags = std::make_shared<Flags>();
  verb->add_option("DIR", flags->dir, "session directory (rig.textproto, views/)")->required();
  verb->add_option("--out", flags->out, "where to write; default: DIR");
  verb->add_option("--method", flags->options.method, kMethodHelp)->capture_default_str();
  verb->add_flag("--range-offset", flags->options.first_guess.range_offset,
                 "auto: also estimate a constant offset of the LIDAR's ranges");
  verb->add_flag_callback(
      "--separate", [flags] { flags->options.joint = false; },
      "auto: solve each camera by itself, not all in one problem");
  verb->add_flag("--smooth-field", flags->options.smooth_field,
                 "paper: extend the distance field beyond the images' borders, so that points\n"
                 "outside are drawn back; otherwise half of them must lie inside");
  verb->add_option("--truth", flags->truth, "truth.textproto; default: DIR's, where there is one");
  verb->callback([flags, exit_code] { *exit_code = Run(*flags); });
}

}  // namespace rgbdt
