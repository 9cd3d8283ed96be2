#include "tests/study/livox_scenes.h"

#include <array>
#include <cmath>
#include <memory>

#include "calib/detect/cloud/board_in_cloud.h"
#include "calib/model/errors.h"
#include "calib/simulate/internal/board_poses.h"
#include "calib/simulate/internal/cloud_world.h"
#include "calib/simulate/internal/noise.h"
#include "calib/simulate/internal/rig_defaults.h"
#include "calib/simulate/internal/scene.h"
#include "tests/numbers.h"
#include "tests/study/sampled_images.h"
#include "tests/study/sampled_sessions.h"

namespace rgbdt::study {
namespace {

constexpr int kViewsPerSeed = 10;  // then scenery, clutter and noise are drawn afresh

int LidarOf(simulate::LivoxModel model) {
  return model == simulate::LivoxModel::kAvia ? simulate::kAvia : simulate::kMid360;
}

simulate::Options OptionsOf(simulate::LivoxModel model, int index, std::uint64_t seed) {
  // A second board of the same kind is none of these: to name it is no mistake.
  static const std::array<const char*, 6> kThings = {"door",  "poster", "table",
                                                     "panel", "person", "easel"};
  simulate::Options options;
  simulate::UseLidar(LidarOf(model), &options);
  options.seed = 1000 * seed + static_cast<std::uint64_t>(index / kViewsPerSeed);
  options.scene = static_cast<simulate::Scene>(index % 3);
  options.threads = 1;  // the study runs one model on each core
  options.pose.min_range_m = 3;
  options.pose.max_range_m = 8;
  options.pose.near_preference = 1;
  options.pose.max_roll_rad = M_PI;
  const auto i = static_cast<std::size_t>(index);
  if (i % 2 == 1) AddClutter(kThings[i / 2 % kThings.size()], &options.clutter);
  return options;
}

class SessionMaker {
 public:
  SessionMaker(simulate::LivoxModel model, std::uint64_t seed) {
    options_.seed = seed;
    options_.scene = static_cast<simulate::Scene>(seed % 3);
    options_.threads = 1;
    simulate::UseLidar(LidarOf(model), &options_);
    scene_ = std::make_shared<simulate::SceneModel>(MakeScene(options_));
    std::vector<Rigid3> mounts;
    for (const simulate::CameraOptions& camera : options_.cameras) {
      mounts.push_back(DrawCameraFromLidar(camera, seed));
      session_.truth.camera_from_lidar[camera.name] = mounts.back();
      renderers_.emplace_back(camera, mounts.back(), options_.supersampling, 1);
    }
    session_.rig = MakeRig(options_, Scanner(), *scene_, mounts);
  }

  std::vector<Rigid3> Poses(int views) const {
    const simulate::World empty(scene_, std::nullopt, options_);
    std::vector<Rigid3> poses;
    for (int i = 0; i < views; ++i) {
      poses.push_back(BoardPose(options_, empty, Scanner(), renderers_, i));
    }
    return poses;
  }

  LivoxSession Run(const std::vector<Rigid3>& poses) {
    for (const Rigid3& pose : poses) AddView(pose);
    return std::move(session_);
  }

 private:
  simulate::Scanner Scanner() const { return {options_.scanner, options_.seed}; }

  void AddView(const Rigid3& lidar_from_target) {
    const auto index = static_cast<int>(session_.detections.size());
    ViewDetection detection;
    detection.view = ViewName(index);
    detection.sweep_utime = kJune2015 + 7'654'321 * static_cast<Utime>(index);
    const simulate::CloudWorld world(options_, lidar_from_target);
    BoardInCloudOptions detector;
    detector.range_sigma_m = session_.rig.lidar.range_sigma_m;
    BoardsInCloud boards =
        FindBoards(world.Sweep(detection.sweep_utime), session_.rig.target, detector);
    if (boards.candidates.empty()) throw InputError("study: no board in a session: " + boards.why);
    detection.cloud.candidates = std::move(boards.candidates);
    for (const CameraSpec& camera : session_.rig.cameras) {
      ImageDetection image;
      image.camera = camera.name;
      image.utime = detection.sweep_utime;
      const simulate::Noise noise(options_.seed, index + 1, "sampled " + camera.name);
      image.edges =
          SampledEdges(camera, camera.lens, session_.rig.target,
                       session_.truth.camera_from_lidar.at(camera.name) * lidar_from_target, noise);
      if (!image.edges) image.why_not = "no pose from the corners";
      detection.images.push_back(std::move(image));
    }
    session_.truth.lidar_from_target[detection.view] = lidar_from_target;
    session_.detections.push_back(std::move(detection));
  }

  simulate::Options options_;
  std::shared_ptr<const simulate::SceneModel> scene_;
  std::vector<simulate::CameraRenderer> renderers_;  // only to ask what lies in an image
  LivoxSession session_;
};

}  // namespace

std::optional<LivoxSession> MakeLivoxSession(simulate::LivoxModel model, int views,
                                             std::uint64_t seed) {
  std::optional<SessionMaker> maker;
  std::vector<Rigid3> poses;
  try {
    maker.emplace(model, seed);
    poses = maker->Poses(views);
  } catch (const InputError&) {  // no room
    return std::nullopt;
  }
  return maker->Run(poses);
}

void RenderLivoxClouds(simulate::LivoxModel model, int count, std::uint64_t seed,
                       const std::function<void(int, const CloudScene&)>& take) {
  int made = 0;
  for (int index = 0; made < count; ++index) {
    if (index > 3 * count + 30) throw InputError("study: no room in the scenes");
    const simulate::Options options = OptionsOf(model, index, seed);
    CloudScene scene;
    try {
      const simulate::CloudWorld world(options, index);
      scene.cloud = world.Sweep(kJune2015 + 7'654'321 * static_cast<Utime>(index));
      scene.target = world.target();
      scene.lidar_from_target = world.lidar_from_target();
    } catch (const InputError&) {  // no room for the board, or for the clutter
      continue;
    }
    scene.range_sigma_m = options.livox->range_sigma_m;
    scene.form = index % 2 == 1 ? "cluttered" : "plain";
    for (const auto& [name, value] : simulate::kSceneNames) {
      if (value == options.scene) scene.scene = name;
    }
    take(index, scene);
    ++made;
  }
}

}  // namespace rgbdt::study
