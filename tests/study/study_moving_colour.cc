// Whether points of a rig that drives are coloured as if it stood still: one image, and the sweep
// after it, at SPEED [m/s] and TURN [rad/s]. POSES: at the ends of sweeps, `true` ones, or
// `odometry`, rgbdt-odometry's own.
//   study_moving_colour SEED SPEED_MPS TURN_RADPS POSES CSV
// Standing still: the same points in the LIDAR's frame of the image's time, by the true motion. A
// point is coloured alike where it has a colour in both cases, no channel more than 16 of 255
// apart, or in neither. A line of CSV: points that have a colour in either case, and those of them
// that are alike.
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "calib/fuse/sweep_fuser.h"
#include "calib/model/errors.h"
#include "calib/scan_assembly/sweep_chunks.h"
#include "calib/simulate/internal/natural_scene.h"
#include "calib/simulate/internal/world.h"
#include "calib/simulate/simulator.h"
#include "services/nodes/odometry_node.h"
#include "tests/study/drives.h"
#include "tests/study/study_main.h"

namespace rgbdt::study {
namespace {

constexpr Utime kImage = 1'700'000'000'000'000;  // when it is taken
constexpr int kSweeps = 12;                      // before it, for the odometry
constexpr int kMostApart = 16;                   // of 255

using Colours = std::vector<std::array<std::uint8_t, 3>>;

bool HasColour(const std::array<std::uint8_t, 3>& rgb) { return rgb[0] + rgb[1] + rgb[2] > 0; }

Colours Fused(SweepFuser* fuser, const Cloud& sweep) {
  for (const CloudChunk& chunk : SplitSweep(sweep)) fuser->FuseChunk(chunk.cloud);
  Colours colours;
  for (const RgbdtCloud& part : fuser->EndSweep()) {
    colours.insert(colours.end(), part.rgb.begin(), part.rgb.end());
  }
  return colours;
}

/// The colour camera alone, where it truly is.
SweepFuser FuserOf(const simulate::Simulator& simulator) {
  const CameraSpec& spec = simulator.rig().Camera("rgb");
  SweepFuser fuser({spec}, simulator.rig().lidar.range_sigma_m);
  const Rigid3& pose = simulator.truth().camera_from_lidar.at(spec.name);
  fuser.SetCalibration(0, {spec.name, pose, std::nullopt, SolveStatus::kConverged, ""}, 1);
  fuser.camera(0).AddImage(Prepare(spec, simulator.TakeImage(spec.name, kImage)));
  return fuser;
}

void Run(const std::vector<std::string>& a) {
  const double speed = std::stod(a[1]), turn = std::stod(a[2]);
  simulate::Options options;
  options.seed = std::stoull(a[0]);
  options.scene = options.seed % 2 == 0 ? simulate::Scene::kIndoor : simulate::Scene::kOutdoor;
  options.natural.on = true;
  options.natural.people = 0;
  simulate::UseLidar(32, &options);
  simulate::Simulator simulator(options);
  simulator.ShowView(0, "0");
  const simulate::World world(
      std::make_shared<simulate::SceneModel>(simulate::MakeNaturalScene(options, 0)), std::nullopt,
      options);
  // The world's frame is the LIDAR's at the image's time.
  const auto world_from_lidar = [&](Utime utime) {
    Vector6d way = Vector6d::Zero();
    way[2] = turn, way[3] = speed;
    return Exp(Vector6d(ToSeconds(utime - kImage) * way));
  };
  const Utime revolution = FromSeconds(options.spinning->revolution_s);
  OdometryNode odometry;
  const bool true_poses = a[3] == "true";
  SweepFuser driving = FuserOf(simulator);
  Cloud sweep;
  for (int i = -kSweeps; i <= 0; ++i) {
    sweep = MovingSweep(world, *options.spinning, options.seed, kImage + i * revolution,
                        world_from_lidar);
    for (const CloudChunk& chunk : SplitSweep(sweep)) {
      for (const Message& message : odometry.Handle(chunk)) {
        const auto* found = std::get_if<StampedPose>(&message);
        if (found == nullptr) continue;
        StampedPose pose = *found;
        if (true_poses) pose.map_from_lidar = world_from_lidar(pose.utime);
        driving.AddPose(pose);
      }
    }
  }
  const Colours colours = Fused(&driving, sweep);
  Cloud still = sweep;
  for (std::size_t i = 0; i < still.size(); ++i) {
    still.points[i] =
        (world_from_lidar(sweep.utime[i]) * sweep.points[i].cast<double>()).cast<float>();
  }
  SweepFuser standing = FuserOf(simulator);
  const Colours expected = Fused(&standing, still);
  if (colours.size() != expected.size()) throw InputError("points got lost");
  std::int64_t seen = 0, alike = 0;
  for (std::size_t i = 0; i < colours.size(); ++i) {
    if (!HasColour(colours[i]) && !HasColour(expected[i])) continue;
    ++seen;
    bool same = HasColour(colours[i]) == HasColour(expected[i]);
    for (std::size_t c = 0; c < 3; ++c) {
      same = same && std::abs(colours[i][c] - expected[i][c]) <= kMostApart;
    }
    alike += same ? 1 : 0;
  }
  std::ofstream csv(a[4]);
  csv << "seed,speed_mps,turn_radps,poses,seen,alike\n"
      << a[0] << ',' << speed << ',' << turn << ',' << a[3] << ',' << seen << ',' << alike << '\n';
  if (!csv.flush()) throw InputError(a[4] + ": cannot be written");
}

}  // namespace
}  // namespace rgbdt::study

int main(int argc, char** argv) {
  return rgbdt::study::StudyMain(
      {"study_moving_colour", "SEED SPEED_MPS TURN_RADPS true|odometry CSV", 5, 5,
       rgbdt::study::Run},
      argc, argv);
}
