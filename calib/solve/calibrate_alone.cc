#include "calib/solve/calibrate_alone.h"

#include <utility>

#include "calib/model/stopwatch.h"
#include "calib/solve/closure.h"

namespace rgbdt {

CalibratedCameras CalibrateAlone(const Target& target, const CalibrateOptions& options,
                                 std::vector<CameraViews> cameras, const SolveAlone& solve) {
  std::vector<GuessedCamera> guessed = GuessCameras(options, std::move(cameras));
  const EdgeModel edges{target, BoardPriors().Means(), {}};
  for (auto& [views, guess] : guessed) {
    if (!guess.camera_from_lidar) continue;
    const Stopwatch watch;
    CameraReport& report = views.report;
    report.calibration = solve(&views, *guess.camera_from_lidar);
    report.calibration.camera = views.spec->name;
    report.solve_s += watch.Seconds();
    report.calibration = WithDegeneracy(views);
    report = JudgeViews(edges, views);
  }
  CalibratedCameras out;
  if (options.diagnostics) out.closure = CloseLoops(guessed);
  out.cameras = WithoutGuesses(std::move(guessed));
  return out;
}

}  // namespace rgbdt
