#include "calib/solve/colouring.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "tests/unit/matchers.h"
#include "tests/unit/solve/board_world.h"

namespace rgbdt {
namespace {

constexpr int kDraws = 20'000;  // the RMS of so many is known to half a percent
constexpr double kShare = 0.02;

CameraSpec Fisheye() {
  CameraSpec spec;
  spec.name = "rgb";
  spec.width = 800;
  spec.height = 600;
  spec.lens = {Lens::Model::kFisheye, 330, 331, 402.7, 296.1, {-0.02, 0.004, -1e-3, 2e-4}};
  return spec;
}

// Some 0.01 deg and 1 mm, no two axes alike, rotation and translation bound to each other as a
// board 5 m away leaves them.
Matrix6d Covariance() {
  Matrix6d root = Matrix6d::Zero();
  root.diagonal() << 2e-4, 1.5e-4, 3e-4, 3e-4, 4e-4, 8e-4;
  root(3, 1) = -5 * 1.5e-4;
  root(4, 0) = 5 * 2e-4;
  root(5, 2) = 3e-4;
  return root * root.transpose();
}

// The same with a lens that is known to some pixels; its centre and the camera's turns take each
// other's place.
PoseAndLensCovariance WithLens() {
  PoseAndLensCovariance root = WithExactLens(Covariance().llt().matrixL());
  root.diagonal().tail<kLensNumbers>() << 2, 1.5, 1, 2, 3e-3, 2e-3, 1e-4, 2e-4, 1e-3;
  root(8, 1) = 0.3;
  root(9, 0) = -0.2;
  return root * root.transpose();
}

CameraCalibration CalibrationWith(const Matrix6d& covariance) {
  return {"rgb", WorldTruth(), covariance, SolveStatus::kConverged, ""};
}

/// Draws of delta and of the lens's numbers with a covariance; the same on every machine.
class Deltas {
 public:
  using Vector = Eigen::Matrix<double, kPoseAndLens, 1>;

  explicit Deltas(PoseAndLensCovariance covariance) {
    covariance.diagonal().array() += 1e-24;  // where the lens is exact
    root_ = covariance.llt().matrixL();
  }

  Vector Draw() {
    Vector standard;
    for (double& value : standard) value = Normal();
    return root_ * standard;
  }

 private:
  // Box and Muller.
  double Normal() {
    return std::sqrt(-2 * std::log(random_.Uniform(1e-12, 1))) *
           std::cos(random_.Uniform(0, 2 * M_PI));
  }

  PoseAndLensCovariance root_;
  Random random_{5};
};

// The same by drawing poses and lenses: each moves the point that the pixel shows.
double DrawnSigma(const CameraSpec& spec, const PoseAndLensCovariance& covariance,
                  const Eigen::Vector2d& pixel, double distance_m) {
  const Eigen::Vector3d point = distance_m * Camera(spec).Unproject(pixel).value();
  Deltas deltas(covariance);
  double sum = 0;
  for (int i = 0; i < kDraws; ++i) {
    const Deltas::Vector drawn = deltas.Draw();
    CameraSpec other = spec;
    other.lens = WithNumbers(spec.lens, NumbersOf(spec.lens) + drawn.tail<kLensNumbers>());
    const Eigen::Vector3d moved = Exp(drawn.head<6>()) * point;
    Eigen::Vector2d seen;
    ProjectUnchecked(other.lens, moved.x(), moved.y(), moved.z(), &seen.x(), &seen.y());
    sum += (seen - pixel).squaredNorm();
  }
  return std::sqrt(sum / kDraws);
}

TEST(ColouringSigma, IsTheScatterOfDrawnPosesAndLenses) {
  for (const CameraSpec& spec : {WorldCamera(), Fisheye()}) {
    const Camera camera(spec);
    for (const double distance_m : {2.0, 10.0}) {
      for (const Eigen::Vector2d& share :
           {Eigen::Vector2d(0.5, 0.5), Eigen::Vector2d(0, 0), Eigen::Vector2d(0.95, 0.3)}) {
        const Eigen::Vector2d pixel(share.x() * (spec.width - 1), share.y() * (spec.height - 1));
        for (const auto& covariance : {WithExactLens(Covariance()), WithLens()}) {
          const double drawn = DrawnSigma(spec, covariance, pixel, distance_m);
          EXPECT_NEAR(ColouringSigmaAt(camera, covariance, pixel, distance_m).value(), drawn,
                      kShare * drawn)
              << "pixel " << pixel.transpose() << ", " << distance_m << " m, " << spec.width;
        }
      }
    }
  }
}

// f = 500 px: 1 mrad about y or 5 mm along x are 0.5 px at 5 m; at 10 m the rotation still is.
TEST(ColouringSigma, ARotationIsTheSameAtEveryDistanceAndATranslationShrinks) {
  CameraSpec spec = WorldCamera();
  spec.lens = {Lens::Model::kPinhole, 500, 500, 319.5, 239.5, {}};
  const auto middle = [&](int axis, double sigma, double distance_m) {
    Matrix6d covariance = Matrix6d::Zero();
    covariance(axis, axis) = sigma * sigma;
    return ColouringSigmaAt(Camera(spec), WithExactLens(covariance), {319.5, 239.5}, distance_m)
        .value();
  };
  EXPECT_NEAR(middle(1, 1e-3, 5), 0.5, 1e-9);
  EXPECT_NEAR(middle(1, 1e-3, 10), 0.5, 1e-9);
  EXPECT_NEAR(middle(3, 5e-3, 5), 0.5, 1e-9);
  EXPECT_NEAR(middle(3, 5e-3, 10), 0.25, 1e-9);
  EXPECT_NEAR(middle(2, 1e-3, 5), 0, 1e-9);  // a roll leaves the middle where it is
}

TEST(ColouringSigma, IsAbsentWhereNoDirectionMapsToThePixel) {
  CameraSpec spec = Fisheye();
  spec.width = 6000;  // from its middle on the image lies beyond the lens
  EXPECT_FALSE(ColouringSigmaAt(Camera(spec), WithExactLens(Covariance()), {5999, 300}, 5));
  const PoseSigma sigma = SigmaOf(spec, CalibrationWith(Covariance()));
  EXPECT_TRUE(std::isnan(sigma.colouring[1].centre_px));
  EXPECT_TRUE(std::isfinite(sigma.colouring[1].worst_px));
}

TEST(PoseSigma, RotationAndCentreAreThoseOfDrawnPoses) {
  const Rigid3 estimate = WorldTruth();
  const Eigen::Vector3d centre = estimate.Inverse().translation;
  Deltas deltas(WithExactLens(Covariance()));
  Eigen::Array3d turned = Eigen::Array3d::Zero();
  Eigen::Array3d moved = Eigen::Array3d::Zero();
  for (int i = 0; i < kDraws; ++i) {
    const Rigid3 drawn = Exp(deltas.Draw().head<6>()) * estimate;
    turned += Log(drawn * estimate.Inverse()).head<3>().array().square();
    moved += (drawn.Inverse().translation - centre).array().square();
  }
  const Eigen::Array3d degrees = (turned / kDraws).sqrt() * 180 / M_PI;
  const Eigen::Array3d millimetres = (moved / kDraws).sqrt() * 1000;
  const PoseSigma sigma = SigmaOf(WorldCamera(), CalibrationWith(Covariance()));
  for (int axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<std::size_t>(axis);
    EXPECT_NEAR(sigma.rotation_deg[at], degrees[axis], kShare * degrees[axis]) << axis;
    EXPECT_NEAR(sigma.centre_mm[at], millimetres[axis], kShare * millimetres[axis]) << axis;
  }
}

TEST(PoseSigma, TheWorstIsNoBetterThanTheMiddleAndEachCorner) {
  const CameraSpec spec = WorldCamera();
  const PoseSigma sigma = SigmaOf(spec, CalibrationWith(Covariance()));
  ASSERT_EQ(sigma.colouring.size(), std::size(kColouringDistancesM));
  for (std::size_t i = 0; i < sigma.colouring.size(); ++i) {
    const ColouringSigma& at = sigma.colouring[i];
    EXPECT_EQ(at.distance_m, kColouringDistancesM[i]);
    EXPECT_GE(at.worst_px, at.centre_px);
    for (const Eigen::Vector2d& corner :
         {Eigen::Vector2d(0, 0), Eigen::Vector2d(639, 0), Eigen::Vector2d(639, 479)}) {
      EXPECT_GE(at.worst_px,
                ColouringSigmaAt(Camera(spec), WithExactLens(Covariance()), corner, at.distance_m)
                    .value());
    }
  }
}

TEST(PoseSigma, WhatIsUnknownIsNotZero) {
  const PoseSigma sigma = SigmaOf(
      WorldCamera(), CalibrationWith(Matrix6d::Constant(std::numeric_limits<double>::quiet_NaN())));
  EXPECT_TRUE(std::isnan(sigma.rotation_deg[0]));
  EXPECT_TRUE(std::isnan(sigma.centre_mm[2]));
  EXPECT_TRUE(std::isnan(sigma.colouring[0].centre_px));
  EXPECT_TRUE(std::isnan(sigma.colouring[0].worst_px));
}

}  // namespace
}  // namespace rgbdt
