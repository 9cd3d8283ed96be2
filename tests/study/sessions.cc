#include "tests/study/sessions.h"

#include <Eigen/Geometry>
#include <cmath>
#include <string>

#include "calib/camera/target_pose.h"
#include "calib/detect/cloud/board_in_cloud.h"
#include "calib/model/errors.h"
#include "calib/simulate/internal/cloud_world.h"
#include "calib/simulate/internal/noise.h"
#include "tests/numbers.h"
#include "tests/study/cloud_scenes.h"
#include "tests/study/sampled_images.h"

namespace rgbdt::study {
namespace {

using simulate::CloudWorld;
using simulate::kDegree;
using simulate::Noise;
using simulate::Options;

constexpr int kTriesPerView = 20;  // until the board lies in the image
constexpr double kCameraAsideM = 0.3;
constexpr double kCameraTiltRad = 5 * kDegree;

// Spread evenly over all rotations (K. Shoemake, Uniform random rotations, 1992).
Eigen::Quaterniond AnyRotation(const Noise& noise) {
  const double u = noise.Uniform(0);
  const double a = noise.Uniform(1, 0, 360 * kDegree);
  const double b = noise.Uniform(2, 0, 360 * kDegree);
  return {std::sqrt(u) * std::cos(b), std::sqrt(1 - u) * std::sin(a),
          std::sqrt(1 - u) * std::cos(a), std::sqrt(u) * std::sin(b)};
}

// Looks along the LIDAR's x, somewhat off, at any roll.
Rigid3 DrawMount(const Noise& noise) {
  Eigen::Matrix3d axes;  // rows: camera's x, y, z in the LIDAR frame
  axes << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  const double across = noise.Uniform(0, 0, 360 * kDegree);
  Rigid3 camera_from_lidar =
      RotationAbout({0, 0, 1}, noise.Uniform(1, 0, 360 * kDegree)) *
      RotationAbout({std::cos(across), std::sin(across), 0}, kCameraTiltRad * noise.Uniform(2));
  camera_from_lidar.rotation = camera_from_lidar.rotation * Eigen::Quaterniond(axes);
  Eigen::Vector3d centre;
  for (int k = 0; k < 3; ++k) {
    centre[k] = kCameraAsideM * noise.Uniform(static_cast<std::uint64_t>(3 + k), -1, 1);
  }
  camera_from_lidar.translation = -(camera_from_lidar.rotation * centre);
  return camera_from_lidar;
}

std::string NameOf(simulate::Holder holder) {
  switch (holder) {
    case simulate::Holder::kPerson:
      return "person";
    case simulate::Holder::kEasel:
      return "easel";
    default:
      return "stand";
  }
}

void Turn(const Eigen::Quaterniond& rotation, Cloud* cloud) {
  const Eigen::Matrix3f matrix = rotation.toRotationMatrix().cast<float>();
  for (auto* vectors : {&cloud->points, &cloud->directions, &cloud->origins}) {
    for (Eigen::Vector3f& v : *vectors) v = matrix * v;
  }
}

class SessionMaker {
 public:
  SessionMaker(const SessionOptions& options, std::uint64_t seed)
      : session_options_(options),
        seed_(seed),
        mount_(DrawMount(Noise(seed, 0, "session mount"))),
        turn_(AnyRotation(Noise(seed, 0, "session turn"))) {
    options_.seed = seed;
    options_.scene = static_cast<simulate::Scene>(seed % 3);
    options_.threads = 1;
    if (options.rings > 0) simulate::UseLidar(options.rings, &options_);
    if (options.clutter) {
      for (const char* thing : {"door", "poster", "table", "panel", "second_board"}) {
        AddClutter(thing, &options_.clutter);
      }
      options_.clutter.holder = static_cast<simulate::Holder>(seed / 3 % 3);
    }
    camera_ = seed % 2 == 0 ? simulate::DefaultColorCamera() : simulate::DefaultThermalCamera();
  }

  Session Make() {
    Session session;
    session.kind = camera_.kind;
    session.holder = NameOf(options_.clutter.holder);
    session.camera_from_lidar = mount_ * Rigid3{turn_.conjugate(), {0, 0, 0}};
    for (int i = 0; i < session_options_.views; ++i) session.views.push_back(MakeView(i));
    return session;
  }

 private:
  // The next place of the board that lies in the image.
  CloudWorld NextWorld() {
    for (int tries = 0; tries < kTriesPerView; ++tries) {
      CloudWorld world(options_, next_pose_++);
      if (TrueCorners(SpecOf(camera_), world.target(), mount_ * world.lidar_from_target())) {
        return world;
      }
    }
    throw InputError("study: no place for the board in the image");
  }

  SessionView MakeView(int index) {
    const CloudWorld world = NextWorld();
    SessionView view;
    view.detection.view = std::to_string(index);
    view.lidar_from_target = Rigid3{turn_, {0, 0, 0}} * world.lidar_from_target();
    view.detection.images = {LookAtImage(world, index)};
    view.wrong_cloud = index < session_options_.wrong_clouds;
    if (!view.wrong_cloud) {
      view.detection.cloud = LookAtCloud(world, index);
    } else if (index % 2 == 0) {
      view.detection.cloud = LookAtCloud(NextWorld(), index);
    } else {
      view.detection.cloud = LookAtCloud(CloudWorld(options_, std::nullopt), index);
    }
    return view;
  }

  ImageDetection LookAtImage(const CloudWorld& world, int index) const {
    const CameraSpec spec = SpecOf(camera_);
    const auto truth = TrueCorners(spec, world.target(), mount_ * world.lidar_from_target());
    const Noise noise(seed_, index + 1, "session corners");
    ImageEdges image;
    image.width = spec.width;
    image.height = spec.height;
    image.corners = SampledCorners(*truth, CornerSigma(camera_.kind), noise);
    const auto pose = PoseFromCorners(Camera(spec), world.target(), image.corners);
    if (!pose) return {camera_.name, 0, std::nullopt, "no pose from the corners", 0};
    image.pose = pose->pose;
    image.corner_sigma_px = pose->corner_sigma_px;
    return {camera_.name, 0, image, "", 0};
  }

  CloudDetection LookAtCloud(const CloudWorld& world, int index) const {
    Cloud cloud = world.Sweep(kJune2015 + index);
    Turn(turn_, &cloud);
    BoardInCloudOptions options;
    options.range_sigma_m =
        options_.spinning ? options_.spinning->range_sigma_m : options_.scanner.range_sigma_m;
    options.one_laser = !options_.spinning;
    BoardsInCloud boards = FindBoards(cloud, world.target(), options);
    const std::string why_not = boards.candidates.empty() ? boards.why : "";
    return {std::move(boards.candidates), why_not, 0};
  }

  SessionOptions session_options_;
  std::uint64_t seed_;
  Options options_;
  simulate::CameraOptions camera_;
  Rigid3 mount_;             // camera_from_lidar with the LIDAR upright
  Eigen::Quaterniond turn_;  // of the LIDAR, from upright
  int next_pose_ = 0;
};

}  // namespace

std::optional<Session> MakeSession(const SessionOptions& options, std::uint64_t seed) {
  try {
    return SessionMaker(options, seed).Make();
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace rgbdt::study
