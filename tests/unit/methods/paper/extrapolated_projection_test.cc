#include "calib/methods/paper/internal/extrapolated_projection.h"

#include <cmath>

#include "tests/numbers.h"
#include "tests/unit/solve/board_world.h"

namespace rgbdt {
namespace {

Eigen::Vector3d Towards(double angle, double side) {
  return {std::sin(angle) * std::cos(side), std::sin(angle) * std::sin(side), std::cos(angle)};
}

CameraSpec FisheyeCamera() {
  CameraSpec spec = WorldCamera();
  spec.lens = {Lens::Model::kFisheye, 200, 200, 320, 240, {-0.01, 0.002, 0, 0}};
  return spec;
}

// Its polynomial folds back at 51 degrees, not far from the image's corners.
CameraSpec FoldingCamera() {
  CameraSpec spec = WorldCamera();
  spec.lens.distortion = {-0.22, 0, 0, 0};
  return spec;
}

CameraSpec CameraNamed(const std::string& lens) {
  return lens == "fisheye" ? FisheyeCamera() : lens == "folding" ? FoldingCamera() : WorldCamera();
}

class ExtrapolatedProjectionOf : public testing::TestWithParam<std::string> {
 protected:
  const Camera camera_{CameraNamed(GetParam())};
  const ExtrapolatedProjection extrapolated_{&camera_};
};

TEST_P(ExtrapolatedProjectionOf, EveryPixelOfTheImageIsTheCamerasOwn) {
  for (double u = 0; u <= 639; u += 639.0 / 16) {
    for (double v = 0; v <= 479; v += 479.0 / 16) {
      const auto direction = camera_.Unproject({u, v});
      ASSERT_TRUE(direction);
      const Eigen::Vector3d point = 2.7 * 0.999999 * *direction;
      ASSERT_EQ(extrapolated_.Project(point), *camera_.Project(point)) << u << ", " << v;
    }
  }
}

TEST_P(ExtrapolatedProjectionOf, ValueAndSlopeGoOnAtTheLimit) {
  constexpr double kStep = 1e-6;
  for (double side = 0; side < 2 * M_PI; side += 0.1) {
    const auto at = [&](double step) {
      return extrapolated_.Project(Towards(extrapolated_.limit() + step, side));
    };
    ASSERT_THAT(at(kStep), EigenNear(at(0), 2e-3));  // some 500 to 1000 px/rad
    const Eigen::Vector2d inside = (at(0) - at(-kStep)) / kStep;
    const Eigen::Vector2d outside = (at(kStep) - at(0)) / kStep;
    // The slope's own change within the step, and rounding of 1e-13 px over it.
    ASSERT_THAT(outside, EigenNear(inside, 0.02)) << side;
  }
}

TEST_P(ExtrapolatedProjectionOf, FartherOffTheAxisIsFartherOutToStraightBehind) {
  const Eigen::Vector2d centre = extrapolated_.Project({0, 0, 1});
  for (double side = 0; side < 2 * M_PI; side += 0.3) {
    double before = 0;
    for (double angle = 1 * kDegree; angle < M_PI; angle += 1 * kDegree) {
      const double here = (extrapolated_.Project(Towards(angle, side)) - centre).norm();
      ASSERT_GT(here, before) << angle / kDegree << " deg";
      before = here;
    }
    ASSERT_LT(before, 10 * 640);
  }
}

INSTANTIATE_TEST_SUITE_P(Lenses, ExtrapolatedProjectionOf,
                         testing::Values("pinhole", "fisheye", "folding"));

}  // namespace
}  // namespace rgbdt
