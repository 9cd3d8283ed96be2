#include "calib/camera/target_pose.h"
#include "calib/solve/internal/joint_solve.h"
#include "tests/unit/solve/joint_reports.h"

namespace rgbdt {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;

// The rig's lenses are off by so much; boards were detected with them.
SolveWorld LensesOff(double focal_share, double centre_px) {
  SolveWorld world(Views(12));
  for (std::size_t c = 0; c < 2; ++c) {
    CameraSpec& camera = world.rig.cameras[c];
    camera.lens_uncertainty.reset();
    camera.lens.fx *= 1 + focal_share;
    camera.lens.fy *= 1 + focal_share;
    camera.lens.cx += centre_px;
    camera.lens.cy -= centre_px;
    for (std::size_t v = 0; v < world.detections.size(); ++v) {
      ImageEdges& image = world.ImageAt(v, c);
      const auto found = PoseFromCorners(Camera(camera), world.rig.target, image.corners);
      image.pose->sensor_from_target = found->pose.sensor_from_target;
      image.pose->covariance = found->pose.covariance;
    }
  }
  return world;
}

LensNumbers LensError(const SolveWorld& world, const CameraCalibration& found, std::size_t camera) {
  return NumbersOf(found.lens->lens) - NumbersOf(world.TrueLens(camera));
}

TEST(CalibrateJointly, ALensThatIsOffAsIsUsualIsFoundWithThePose) {
  const SolveWorld world(LensesOff(0.004, 3));
  const Report report = Calibrate(world.rig, world.detections, Brief());
  for (std::size_t c = 0; c < 2; ++c) {
    const CameraReport& camera = report.cameras[c];
    const CameraCalibration& found = camera.calibration;
    ASSERT_TRUE(found.converged()) << found.StatusText();
    ASSERT_TRUE(found.lens);
    EXPECT_LT(Chi2(world, report, c), kMostChi2);
    const LensNumbers error = LensError(world, found, c);
    for (Eigen::Index i = 0; i < 4; ++i) {
      const double sigma = std::sqrt(found.lens->covariance(i, 6 + i));
      EXPECT_LT(std::abs(error[i]), 4 * sigma) << i;
    }
    EXPECT_LT(std::abs(error[0]), 0.5 * 0.004 * world.TrueLens(c).fx);
    EXPECT_THAT(camera.warnings, IsEmpty());
    EXPECT_THAT(camera.rejected, IsEmpty());
  }
}

TEST(CalibrateJointly, ALensThatTheViewsContradictIsSaidAndFoundAllTheSame) {
  const SolveWorld world(LensesOff(0.05, 0));
  const Report report = Calibrate(world.rig, world.detections, Brief());
  for (std::size_t c = 0; c < 2; ++c) {
    const CameraReport& camera = report.cameras[c];
    ASSERT_TRUE(camera.calibration.lens);
    EXPECT_LT(Chi2(world, report, c), kMostChi2);
    EXPECT_THAT(camera.causes,
                Contains(Field(&Cause::words, AllOf(HasSubstr("contradicts these views"),
                                                    HasSubstr("rgbdt intrinsics")))));
  }
}

TEST(CalibrateJointly, TheViewsTogetherTellAPlainSquaresTurns) {
  SolveWorldOptions options = Views(8);
  options.plain = true;
  const SolveWorld world(options);
  const Report report = Calibrate(world.rig, world.detections, Brief());
  for (std::size_t c = 0; c < 2; ++c) {
    const CameraReport& camera = report.cameras[c];
    ASSERT_TRUE(camera.calibration.converged()) << camera.calibration.StatusText();
    EXPECT_LT(Chi2(world, report, c), kMostChi2);
    EXPECT_THAT(camera.rejected, IsEmpty());
  }
}

// A white board looks too large by a length, at any range: as an angle it would move the camera.
TEST(CalibrateJointly, HowMuchTooLargeAPlainBoardLooksIsFoundWithThePose) {
  constexpr double kTooLargeM = 0.028;
  SolveWorldOptions options = Views(12);
  options.plain = true;
  options.shared[kFringe] = kTooLargeM;
  const SolveWorld world(options);
  const Report report = Calibrate(world.rig, world.detections, Brief());
  for (std::size_t c = 0; c < 2; ++c) {
    const CameraReport& camera = report.cameras[c];
    EXPECT_LT(Chi2(world, report, c), kMostChi2);
    EXPECT_FALSE(camera.edges_planes.value().sigma_enlarged);
    const auto fringe =
        std::find_if(camera.nuisance.begin(), camera.nuisance.end(),
                     [](const Nuisance& line) { return line.name == "beam edge, at any range"; });
    ASSERT_NE(fringe, camera.nuisance.end());
    EXPECT_NEAR(fringe->estimate.value, 1000 * kTooLargeM, 4 * fringe->estimate.sigma);
    EXPECT_LT(fringe->estimate.sigma, 10);
  }
}

// A board's sides are not straight to a tenth of a pixel, and show their rims.
TEST(CalibrateJointly, SidesInImagesThatAreOffCountLess) {
  for (const std::uint32_t seed : {1, 2, 3}) {
    SolveWorldOptions options = Views(10);
    options.seed = seed;
    SolveWorld world(options);
    for (std::size_t v = 0; v < world.detections.size(); ++v) {
      for (ImageSide& side : world.ImageAt(v, 0).sides) {
        const Eigen::Vector2d along = (side.curve.back() - side.curve.front()).normalized();
        const double off_px = world.Normal();
        for (Eigen::Vector2d& p : side.curve) p += off_px * Eigen::Vector2d(-along.y(), along.x());
      }
    }
    const Report report = Calibrate(world.rig, world.detections, Brief());
    EXPECT_LT(Chi2(world, report, 0), kMostChi2) << seed;
    EXPECT_LT(report.cameras[0].variance_factor, 1.3) << seed;
    EXPECT_THAT(report.cameras[0].rejected, IsEmpty()) << seed;
  }
}

// A bulge makes the focal length seem another, and leans boards that are seen at a slant.
TEST(CalibrateJointly, ABoardThatIsNotFlatIsFoundWithThePose) {
  SolveWorldOptions options = Views(12);
  options.lens_uncertainty.reset();
  options.print_sigma = kUsualPrintSigma;
  options.shared[kBowX] = 0.0015;
  options.shared[kTwist] = -0.001;
  options.shared[kBowY] = 0.0005;
  const SolveWorld world(options);
  const Report report = Calibrate(world.rig, world.detections, Brief());
  constexpr std::pair<const char*, double> kShape[] = {
      {"board's shape, its ends behind its middle along its width", 1.5},
      {"board's shape, twist", -1},
      {"board's shape, its ends behind its middle along its height", 0.5}};
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_LT(Chi2(world, report, c), kMostChi2);
    const auto& lines = report.cameras[c].nuisance;
    for (const auto& of : kShape) {
      const auto found = std::find_if(lines.begin(), lines.end(),
                                      [&](const Nuisance& line) { return line.name == of.first; });
      ASSERT_NE(found, lines.end()) << of.first;
      EXPECT_NEAR(found->estimate.value, of.second, 4 * found->estimate.sigma) << of.first;
      EXPECT_LT(found->estimate.sigma, 0.3) << of.first;
    }
  }
}

// Squares that are not square lean every board in the images.
TEST(CalibrateJointly, APatternThatThePrinterStretchedIsFoundWithThePose) {
  SolveWorldOptions options = Views(12);
  options.print_sigma = kUsualPrintSigma;
  options.shared[kPrintWidth] = 0.001;
  options.shared[kPrintHeight] = -0.004;
  SolveWorld world(options);
  const Report found = Calibrate(world.rig, world.detections, Brief());
  world.rig.target.print_sigma = 0;
  const Report exact = Calibrate(world.rig, world.detections, Brief());
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_LT(Chi2(world, found, c), kMostChi2);
    // Off by more than the views state, and by less than is stated in the end.
    const double enlarged = exact.cameras[c].edges_planes.value().sigma_enlarged.value();
    EXPECT_GT(Chi2(world, exact, c) * enlarged * enlarged, kMostChi2);
    EXPECT_LT(Chi2(world, exact, c), kMostChi2);
    const auto& lines = found.cameras[c].nuisance;
    const auto height = std::find_if(lines.begin(), lines.end(), [](const Nuisance& line) {
      return line.name == "pattern's height, found less given";
    });
    ASSERT_NE(height, lines.end());
    EXPECT_NEAR(height->estimate.value, -4, 4 * height->estimate.sigma);
    EXPECT_LT(height->estimate.sigma, 2);
  }
}

// What is stated of a lens made from these very images is theirs again: as if nothing were stated.
TEST(CalibrateJointly, ALensMadeFromTheSameImagesIsNotCountedTwice) {
  SolveWorld world(LensesOff(0, 0));
  const Report usual = Calibrate(world.rig, world.detections, Brief());
  for (std::size_t c = 0; c < 2; ++c) {
    LensUncertainty stated = world.rig.cameras[c].LensUncertaintyOrUsual();
    stated.covariance *= 1e-4;
    world.rig.cameras[c].lens_uncertainty = stated;
  }
  const Report other_images = Calibrate(world.rig, world.detections, Brief());
  for (std::size_t c = 0; c < 2; ++c) {
    for (std::size_t v = 0; v < world.detections.size(); ++v) {
      world.rig.cameras[c].lens_uncertainty->made_from.push_back(
          MiddleOf(world.ImageAt(v, c).corners));
    }
  }
  const Report same_images = Calibrate(world.rig, world.detections, Brief());
  for (std::size_t c = 0; c < 2; ++c) {
    const Matrix6d wide = *usual.cameras[c].calibration.covariance;
    const Matrix6d same = *same_images.cameras[c].calibration.covariance;
    EXPECT_LT((same - wide).norm(), 1e-6 * wide.norm());
    EXPECT_LT(other_images.cameras[c].calibration.covariance->trace(), 0.5 * wide.trace());
  }
}

}  // namespace
}  // namespace rgbdt
