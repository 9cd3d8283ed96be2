// Whether corners that are sampled are as good as corners that are detected in rendered images.
//   study_corner_noise COUNT SEED CSV
// renders COUNT scenes with both cameras; a line of CSV for each camera and scene: the corners'
// error, detected and sampled, and what it makes of the board's pose.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "calib/camera/pixels.h"
#include "calib/camera/target_pose.h"
#include "calib/detect/image/checkerboard.h"
#include "calib/simulate/simulator.h"
#include "tests/study/cloud_scenes.h"
#include "tests/study/sampled_images.h"
#include "tests/study/study_main.h"

namespace rgbdt::study {
namespace {

constexpr Utime kUtime = 1'433'160'013'000'000;
constexpr int kViewsPerSeed = 4;  // they share the empty scene, which takes longest

struct Corners {
  double rms_px = 0;
  PoseError pose;
};

Corners Judge(const CameraSpec& spec, const Target& target, const Rigid3& camera_from_target,
              const std::vector<Eigen::Vector2d>& corners,
              const std::vector<Eigen::Vector2d>& truth) {
  Corners judged;
  judged.rms_px = CornerRms(corners, truth);
  const std::optional<CornerPose> pose = PoseFromCorners(Camera(spec), target, corners);
  if (pose) judged.pose = ErrorOf(pose->pose, camera_from_target);
  return judged;
}

void Write(const Corners& corners, std::ofstream* csv) {
  *csv << ',' << corners.rms_px << ',' << corners.pose.rotation_deg << ',' << corners.pose.centre_mm
       << ',' << corners.pose.chi2;
}

void WriteLine(const simulate::Simulator& simulator, const CameraSpec& spec, int index,
               std::uint64_t seed, std::ofstream* csv) {
  const Target& target = simulator.rig().target;
  const Rigid3& lidar_from_target = simulator.truth().lidar_from_target.at(std::to_string(index));
  const Rigid3 camera_from_target =
      simulator.truth().camera_from_lidar.at(spec.name) * lidar_from_target;
  const auto truth = TrueCorners(spec, target, camera_from_target);
  const CheckerboardResult found =
      FindCheckerboard(ToGrey(simulator.TakeImage(spec.name, kUtime + index)), target);
  if (!truth || !found.board) return;
  const double range = lidar_from_target.translation.norm();
  const simulate::Noise noise(seed, index, spec.name + " corners");
  const auto sampled = SampledCorners(*truth, CornerSigma(spec.kind), noise);
  *csv << (spec.kind == CameraKind::kColor ? "color" : "thermal") << ',' << index << ',' << range;
  Write(Judge(spec, target, camera_from_target, found.board->corners, *truth), csv);
  Write(Judge(spec, target, camera_from_target, sampled, *truth), csv);
  *csv << '\n';
}

void Run(int count, std::uint64_t seed, const std::string& path) {
  std::ofstream csv(path);
  csv << "kind,scene,range_m,rendered_px,rendered_deg,rendered_mm,rendered_chi2,sampled_px,"
         "sampled_deg,sampled_mm,sampled_chi2\n";
  std::unique_ptr<simulate::Simulator> simulator;
  for (int index = 0; index < count; ++index) {
    if (index % kViewsPerSeed == 0) {
      simulate::Options options;
      options.seed = 1000 * seed + static_cast<std::uint64_t>(index);
      options.scene = static_cast<simulate::Scene>(index / kViewsPerSeed % 3);
      simulator = std::make_unique<simulate::Simulator>(options);
    }
    simulator->ShowView(index % kViewsPerSeed, std::to_string(index));
    for (const CameraSpec& spec : simulator->rig().cameras) {
      WriteLine(*simulator, spec, index, seed, &csv);
    }
  }
  if (!csv.flush()) throw std::runtime_error("cannot write " + path);
  std::printf("corner noise: %d scenes rendered\n", count);
}

}  // namespace
}  // namespace rgbdt::study

int main(int argc, char** argv) {
  const auto run = [](const std::vector<std::string>& arguments) {
    rgbdt::study::Run(std::stoi(arguments[0]), std::stoull(arguments[1]), arguments[2]);
  };
  return rgbdt::study::StudyMain({"study_corner_noise", "COUNT SEED CSV", 3, 3, run}, argc, argv);
}
