// Time offsets, rolling shutters and poses from a waved board whose truth is known.
//   study_sync SEED CSV [SECONDS]
// A line of CSV for each camera of each case.
#include <fstream>
#include <string>
#include <vector>

#include "calib/model/stopwatch.h"
#include "calib/simulate/internal/dice.h"
#include "calib/sync/sync.h"
#include "tests/study/study_main.h"
#include "tests/study/waved_boards.h"

namespace rgbdt::study {
namespace {

// Clocks half a second off either way, shutters of up to 20 ms.
void DrawClocks(WavedScene* scene, bool rolling) {
  simulate::Dice draw(scene->options.seed, 0, "clocks");
  for (simulate::ClockOptions& clock : scene->clocks) {
    clock.offset_s = draw.Between(-0.5, 0.5);
    clock.rolling_s = rolling ? 0.02 : 0;
  }
}

void Solve(const std::string& name, const WavedScene& scene, bool known, std::ofstream* csv) {
  Truth truth;
  const Stopwatch sampling;
  WavedBoard board = SampleWavedBoard(scene, &truth);
  const double sample_s = sampling.Seconds();
  if (known) {
    BeginNearTruth(truth, 0.01, 0.02, &board);
  } else {
    AddSweepBoards(scene, &board);
  }
  const Stopwatch watch;
  const SyncResult result = Synchronise(board);
  const double solve_s = watch.Seconds();
  for (std::size_t i = 0; i < result.cameras.size(); ++i) {
    const SyncedCamera& camera = result.cameras[i];
    const simulate::ClockOptions& clock = scene.clocks[i];
    const Rigid3& pose = truth.camera_from_lidar.at(camera.camera);
    const Vector6d off = Log(pose * camera.camera_from_lidar.Inverse());
    const double nees = camera.why_not.empty() ? off.dot(camera.covariance.ldlt().solve(off)) : 0;
    *csv << name << ',' << scene.options.seed << ',' << camera.camera << ','
         << camera.why_not.empty() << ',' << clock.offset_s << ',' << camera.time_offset_s.value
         << ',' << camera.time_offset_s.sigma << ',' << clock.rolling_s << ','
         << camera.rolling_s.value << ',' << camera.rolling_s.sigma << ','
         << RotationDistance(pose, camera.camera_from_lidar) * 180 / M_PI << ','
         << 1000 * CentreDistance(pose, camera.camera_from_lidar) << ',' << nees << ','
         << camera.variance_factor << ',' << result.variance_factor << ','
         << (camera.drift ? camera.drift->value : 0) << ','
         << (camera.jump ? camera.jump->offset_s.value : 0) << ',' << result.sweeps << ','
         << 1000 * result.plane_rms_m << ',' << result.speed << ',' << result.turn_speed << ','
         << sample_s << ',' << solve_s << ",\"" << camera.why_not << "\"\n"
         << std::flush;
  }
}

void Run(const std::vector<std::string>& a) {
  std::ofstream csv(a[1]);
  csv.precision(12);
  csv << "case,seed,camera,given,true_offset_s,offset_s,offset_sigma_s,true_rolling_s,rolling_s,"
         "rolling_sigma_s,rotation_deg,translation_mm,pose_nees,image_factor,sweep_factor,drift,"
         "jump,sweeps,plane_rms_mm,speed,turn_speed,sample_s,solve_s,why_not\n";
  const std::uint64_t seed = std::stoull(a[0]);
  const double seconds = a.size() > 2 ? std::stod(a[2]) : 20;
  WavedScene scene = TwoCameras(seed);
  scene.seconds = seconds;
  DrawClocks(&scene, false);
  Solve("global", scene, true, &csv);
  DrawClocks(&scene, true);
  Solve("rolling", scene, false, &csv);
}

}  // namespace
}  // namespace rgbdt::study

int main(int argc, char** argv) {
  return rgbdt::study::StudyMain({"study_sync", "SEED CSV [SECONDS]", 2, 3, rgbdt::study::Run},
                                 argc, argv);
}
