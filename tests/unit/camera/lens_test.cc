#include "calib/camera/lens.h"

#include <ceres/jet.h>

#include <opencv2/calib3d.hpp>

#include "calib/camera/pixel_by_point.h"
#include "tests/unit/camera/lenses.h"
#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

Eigen::Vector2d Projected(const Lens& lens, const Eigen::Vector3d& point) {
  Eigen::Vector2d pixel;
  ProjectUnchecked(lens, point.x(), point.y(), point.z(), &pixel.x(), &pixel.y());
  return pixel;
}

Eigen::Vector2d ProjectedByOpenCv(const Lens& lens, const Eigen::Vector3d& point) {
  const std::vector<cv::Point3d> points = {{point.x(), point.y(), point.z()}};
  const cv::Matx33d matrix(lens.fx, 0, lens.cx, 0, lens.fy, lens.cy, 0, 0, 1);
  const cv::Vec3d zero(0, 0, 0);
  std::vector<cv::Point2d> pixels;
  if (lens.model == Lens::Model::kFisheye) {
    const std::vector<double> k(lens.distortion.begin(), lens.distortion.begin() + 4);
    cv::fisheye::projectPoints(points, pixels, zero, zero, matrix, k);
  } else {
    // Five where five are used: that OpenCV reads the others as zero is part of what is tested.
    const bool rational = lens.distortion[5] != 0;
    const std::vector<double> k(lens.distortion.begin(),
                                lens.distortion.begin() + (rational ? 8 : 5));
    cv::projectPoints(points, zero, zero, matrix, k, pixels);
  }
  return {pixels[0].x, pixels[0].y};
}

class LensModel : public testing::TestWithParam<NamedLens> {
 protected:
  const Lens& lens() const { return GetParam().spec.lens; }

  // Points in front of the camera, the axis among them, up to `slope` off it.
  static std::vector<Eigen::Vector3d> Points(double slope) {
    std::vector<Eigen::Vector3d> points = {{0, 0, 2}};
    Random random(7);
    for (int i = 0; i < 300; ++i) {
      const double z = random.Uniform(0.2, 20);
      points.emplace_back(random.Uniform(-slope, slope) * z, random.Uniform(-slope, slope) * z, z);
    }
    return points;
  }
};

TEST_P(LensModel, IsOpenCvs) {
  for (const Eigen::Vector3d& point : Points(0.8)) {
    EXPECT_THAT(Projected(lens(), point), EigenNear(ProjectedByOpenCv(lens(), point), 1e-9))
        << point.transpose();
  }
}

// The lens's own numbers as what is solved for.
TEST_P(LensModel, AJetHasTheDerivativesByTheLensToo) {
  using Jet = ceres::Jet<double, 12>;
  for (const Eigen::Vector3d& p : Points(0.6)) {
    Jet f[2] = {Jet(lens().fx, 0), Jet(lens().fy, 1)};
    Jet c[2] = {Jet(lens().cx, 2), Jet(lens().cy, 3)};
    Jet k[8];
    for (int i = 0; i < 8; ++i) k[i] = Jet(lens().distortion[static_cast<size_t>(i)], 4 + i);
    Jet u;
    Jet v;
    ProjectUnchecked(lens().model, f, c, k, Jet(p.x()), Jet(p.y()), Jet(p.z()), &u, &v);
    EXPECT_THAT(Eigen::Vector2d(u.a, v.a), EigenNear(Projected(lens(), p), 1e-10));
    const auto moved = [&](int i, double step) {
      Lens lens = this->lens();
      double* const first[4] = {&lens.fx, &lens.fy, &lens.cx, &lens.cy};
      (i < 4 ? *first[i] : lens.distortion[static_cast<size_t>(i - 4)]) += step;
      return Projected(lens, p);
    };
    for (int i = 0; i < 12; ++i) {
      const double step = 1e-6;
      const Eigen::Vector2d slope = (moved(i, step) - moved(i, -step)) / (2 * step);
      // Rounding: 1e-13 of up to 1e3 px over the step.
      EXPECT_THAT(Eigen::Vector2d(u.v[i], v.v[i]), EigenNear(slope, 1e-3)) << i;
    }
  }
}

// A Jet is what automatic differentiation runs through the same text.
TEST_P(LensModel, AJetHasTheSameValueAndTheDerivativesOfCentralDifferences) {
  using Jet = ceres::Jet<double, 3>;
  for (const Eigen::Vector3d& p : Points(0.6)) {
    Jet u;
    Jet v;
    ProjectUnchecked(lens(), Jet(p.x(), 0), Jet(p.y(), 1), Jet(p.z(), 2), &u, &v);
    const Eigen::Vector2d pixel = Projected(lens(), p);
    EXPECT_NEAR(u.a, pixel.x(), 1e-10);
    EXPECT_NEAR(v.a, pixel.y(), 1e-10);
    // Rounding costs 1e-13 px / step, truncation f * (step / z)^2: both below 1e-5 of f / z.
    const double step = 1e-5 * p.z();
    const double tolerance = 1e-5 * lens().fx / p.z();
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d d = step * Eigen::Vector3d::Unit(axis);
      const Eigen::Vector2d slope =
          (Projected(lens(), p + d) - Projected(lens(), p - d)) / (2 * step);
      EXPECT_NEAR(u.v[axis], slope.x(), tolerance) << p.transpose();
      EXPECT_NEAR(v.v[axis], slope.y(), tolerance) << p.transpose();
    }
  }
}

TEST_P(LensModel, TheAxisMeetsTheImageAtThePrincipalPoint) {
  EXPECT_THAT(Projected(lens(), {0, 0, 3}),
              EigenNear(Eigen::Vector2d(lens().cx, lens().cy), 1e-12));
}

INSTANTIATE_TEST_SUITE_P(Lenses, LensModel, testing::ValuesIn(Lenses()), NameOf);

TEST(FisheyeLens, NearTheAxisTheSeriesContinuesTheFormula) {
  const Lens lens = Lenses().back().spec.lens;
  // Either side of where r^2 falls below 1e-24: the image moves by f / z * r.
  for (const double r : {0.9e-12, 1.1e-12, 1e-9}) {
    const double z = 1e-3;
    EXPECT_NEAR(Projected(lens, {r, 0, z}).x() - lens.cx, lens.fx * r / z, 1e-12);
  }
}

TEST(FisheyeLens, SeesBesideAndBehind) {
  const Lens lens{Lens::Model::kFisheye, 100, 100, 0, 0, {}};
  EXPECT_THAT(Projected(lens, {2, 0, 0}), EigenNear(Eigen::Vector2d(100 * M_PI / 2, 0), 1e-10));
  EXPECT_THAT(Projected(lens, {0, 1, -1}), EigenNear(Eigen::Vector2d(0, 100 * 0.75 * M_PI), 1e-10));
}

TEST_P(LensModel, DerivativesByPointAndLensAreThoseOfTheProjection) {
  const Eigen::Vector3d point(0.4, -0.3, 1.2);
  const PixelDerivatives by = PixelByPointAndLens(lens(), point);
  EXPECT_LT((by.leftCols<3>() - PixelByPoint(lens(), point)).norm(), 1e-9);
  const LensNumbers numbers = NumbersOf(lens());
  for (Eigen::Index i = 0; i < kLensNumbers; ++i) {
    const double step = i < 4 ? 1e-2 : 1e-5;
    const auto at = [&](double off) {
      LensNumbers moved = numbers;
      moved[i] += off;
      return Projected(WithNumbers(lens(), moved), point);
    };
    const Eigen::Vector2d expected = (at(step) - at(-step)) / (2 * step);
    const bool unused = lens().model == Lens::Model::kFisheye && i == 8;
    if (unused) {
      EXPECT_EQ(by.col(3 + i).norm(), 0);
    } else {
      EXPECT_LT((by.col(3 + i) - expected).norm(), 1e-5 * (1 + expected.norm())) << i;
    }
  }
}

}  // namespace
}  // namespace rgbdt
