#include <cstdio>
#include <memory>
#include <utility>

#include "calib/methods/calibrate_by_views.h"
#include "calib/methods/detect_session.h"
#include "calib/model/beam_priors.h"
#include "calib/present/session/report_files.h"
#include "services/rgbdt/print_report.h"
#include "services/rgbdt/verbs.h"

namespace rgbdt {
namespace {

struct CalibrateFlags {
  std::string dir, out, truth;
  CalibrateOptions options;
  bool separate = false;
  bool range_offset = false;
};

int RunCalibrate(const CalibrateFlags& flags) {
  flags.options.Check();
  const Session session = OpenSession(flags.dir);
  const std::filesystem::path out = PathOr(flags.out, session.root);
  const SessionDetection detection = DetectSession(session, flags.options.method, PrintProgress);
  std::fprintf(stderr, "solving ...\n");
  Report report = Calibrate(session.rig, detection.views, flags.options);
  const std::string wrote = WriteIfSolved(out, report);
  const auto truth = TruthPath(flags.truth, session.root);
  if (!truth.empty()) report = WithTruth(std::move(report), ReadTruth(truth));
  const auto reports = CalibrateByViews(session.rig, detection.views, report);
  WriteReportFiles(out, {session, detection.views, reports});
  PrintReport(report, wrote, detection.unreadable);
  return detection.unreadable.empty() && Summary(report).converged() ? 0 : 1;
}

}  // namespace

void AddCalibrate(CommandLine* program) {
  auto flags = std::make_shared<CalibrateFlags>();
  CommandLine* verb = program->Verb(
      "calibrate",
      "Finds each camera's pose relative to the LIDAR from a session directory.\n"
      "Writes calibration.textproto, report.json and report.html. Exit code 1: a camera did not\n"
      "converge, or a view could not be read.\n"
      "Example: rgbdt calibrate out/demo/session --out out/again",
      [flags] {
        flags->options.joint = !flags->separate;
        if (flags->range_offset)
          flags->options.first_guess.range_offset_sigma_m = kRangeOffsetSigmaM;
        return RunCalibrate(*flags);
      });
  verb->Required("DIR", &flags->dir, "session directory (rig.textproto, views/)");
  verb->Option("--out", &flags->out, "where to write; default: DIR");
  verb->Option("--method", &flags->options.method, kMethodHelp);
  verb->Flag("--range-offset", &flags->range_offset,
             "auto: take the LIDAR's ranges to be off by any constant, whatever the rig file\n"
             "says of them (lidar.range_offset_sigma_m)");
  verb->Flag("--separate", &flags->separate,
             "auto: solve each camera by itself, not all in one problem");
  verb->Flag("--smooth-field", &flags->options.smooth_field,
             "paper: extend the distance field beyond the images' borders, so that points\n"
             "outside are drawn back; otherwise half of them must lie inside");
  verb->Option("--truth", &flags->truth, "truth.textproto; default: DIR's, where there is one");
}

}  // namespace rgbdt
