#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "calib/camera/camera.h"
#include "calib/camera/intrinsics.h"
#include "tests/unit/camera/lenses.h"
#include "tests/unit/matchers.h"

namespace rgbdt {

/// The paper's board.
inline Target PaperTarget() {
  Target target;
  target.squares_x = 11;
  target.squares_y = 8;
  target.square_m = 0.1;
  target.width_m = 1.2192;
  target.height_m = 0.9144;
  return target;
}

/// Box and Muller: the standard library's distribution differs from one to the next.
inline double Gauss(Random* random) {
  const double radius = std::sqrt(-2 * std::log(random->Uniform(1e-12, 1)));
  return radius * std::cos(random->Uniform(0, 2 * M_PI));
}

/// What a camera would be shown: boards wholly in view.
class BoardViews {
 public:
  /// `bow_m`: the middle is so much nearer than the ends along the width and along the height, and
  /// of the corners two lie by the twist in front and two behind.
  BoardViews(const CameraSpec& spec, const Target& target, std::uint32_t seed,
             const Eigen::Vector3d& bow_m = Eigen::Vector3d::Zero())
      : camera_(spec), target_(target), random_(seed), bow_m_(bow_m) {}

  /// Tilted by `least_tilt` to `most_tilt` [rad] against the image.
  Rigid3 Pose(double least_tilt, double most_tilt) {
    for (;;) {
      // Towards any pixel, so near that the board covers a third to two thirds of the image.
      const auto direction = camera_.Unproject(
          {random_.Uniform(0, camera_.width()), random_.Uniform(0, camera_.height())});
      if (!direction) continue;
      const double size = random_.Uniform(0.35, 0.65) * camera_.width() / camera_.lens().fx;
      const double turn = random_.Uniform(0, 2 * M_PI);
      const Eigen::Vector3d axis(std::cos(turn), std::sin(turn), 0);
      Rigid3 pose = RotationAbout(axis, random_.Uniform(least_tilt, most_tilt)) *
                    RotationAbout(Eigen::Vector3d::UnitZ(), random_.Uniform(-0.7, 0.7));
      pose.translation = *direction * (target_.width_m / size);
      if (InView(pose) && FromTheFront(pose)) return pose;
    }
  }

  IntrinsicsView Corners(const Rigid3& camera_from_target, double sigma_px) {
    IntrinsicsView view;
    for (const Eigen::Vector3d& corner : target_.InnerCorners()) {
      view.corners.emplace_back(
          *camera_.Project(camera_from_target * Bent(corner)) +
          Eigen::Vector2d(sigma_px * Gauss(&random_), sigma_px * Gauss(&random_)));
    }
    return view;
  }

 private:
  Eigen::Vector3d Bent(const Eigen::Vector3d& corner) const {
    const double x = corner.x() / (target_.width_m / 2);
    const double y = corner.y() / (target_.height_m / 2);
    return corner +
           Eigen::Vector3d::UnitZ() * (bow_m_[0] * x * x + bow_m_[1] * y * y + bow_m_[2] * x * y);
  }

  // No flatter than 20 degrees.
  static bool FromTheFront(const Rigid3& pose) {
    const Eigen::Vector3d normal = pose.rotation * Eigen::Vector3d::UnitZ();
    return normal.dot(pose.translation.normalized()) > 0.34;
  }

  bool InView(const Rigid3& pose) const {
    for (const Eigen::Vector3d& corner : target_.InnerCorners()) {
      const auto pixel = camera_.Project(pose * corner);
      if (!pixel || !camera_.Contains(*pixel)) return false;
    }
    return true;
  }

  Camera camera_;
  Target target_;
  Random random_;
  Eigen::Vector3d bow_m_;
};

inline LensChoice ChoiceOf(const Lens& lens) {
  if (lens.model == Lens::Model::kFisheye) return LensChoice::kFisheye;
  return lens.distortion[5] != 0 ? LensChoice::kPinhole8 : LensChoice::kPinhole5;
}

inline IntrinsicsInput InputOf(const CameraSpec& spec, int views, double sigma_px,
                               std::uint32_t seed) {
  IntrinsicsInput input{ChoiceOf(spec.lens), spec.width, spec.height, PaperTarget(), {}};
  BoardViews boards(spec, input.target, seed);
  for (int i = 0; i < views; ++i) {
    input.views.push_back(boards.Corners(boards.Pose(0.35, 0.85), sigma_px));
    input.views.back().name = std::to_string(i + 1);
  }
  return input;
}

}  // namespace rgbdt
