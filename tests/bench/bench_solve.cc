// The calibration of both default cameras from detections, judging included but for diagnostics;
// beside it the 2015 method, which needs a hand-measured guess and gets one.
#include <map>
#include <memory>
#include <stdexcept>

#include "calib/methods/calibrate.h"
#include "calib/simulate/internal/rig_defaults.h"
#include "tests/bench/measure.h"
#include "tests/bench/stages.h"
#include "tests/study/paired_sessions.h"

namespace rgbdt::bench {
namespace {

// A session that has room for the board, with guesses in its rig.
const study::PairedSession& SessionOf(int views) {
  static std::map<int, study::PairedSession> sessions;  // each renders its clouds
  const auto known = sessions.find(views);
  if (known != sessions.end()) return known->second;
  study::PairedOptions options;
  options.views = views;
  for (std::uint64_t seed = 1; seed < 50; ++seed) {
    auto session = study::MakePairedSession(options, seed);
    if (!session) continue;
    for (std::size_t c = 0; c < session->rig.cameras.size(); ++c) {
      CameraSpec& camera = session->rig.cameras[c];
      camera.camera_from_lidar_guess =
          simulate::DrawGuess({}, camera.name, session->camera_from_lidar[c]);
    }
    return sessions.emplace(views, std::move(*session)).first->second;
  }
  throw std::runtime_error("no session has room for the board");
}

std::function<void()> Solve(int views, const char* method) {
  const study::PairedSession& session = SessionOf(views);
  CalibrateOptions options;
  options.method = method;
  options.diagnostics = false;
  const auto& detections = options.method == kPaperMethod ? session.by_paper : session.by_boards;
  return [=, &session, &detections] {
    Report report = Calibrate(session.rig, detections, options);
    benchmark::DoNotOptimize(report);
  };
}

}  // namespace

void RegisterSolve(std::int64_t most) {
  for (const int views : {8, 4, 16}) {
    if (views != 8 && most < 10'000'000) continue;  // the 2015 method takes seconds
    Register({"solve", "rgbdt", views, "views", 2}, [=] { return Solve(views, kAutoMethod); });
    Register({"solve", "--method paper", views, "views", 2},
             [=] { return Solve(views, kPaperMethod); });
  }
}

}  // namespace rgbdt::bench
