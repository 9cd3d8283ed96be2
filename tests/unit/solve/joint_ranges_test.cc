#include "calib/model/range_errors.h"
#include "calib/solve/internal/joint_solve.h"
#include "tests/unit/solve/joint_reports.h"

namespace rgbdt {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;

// Measured 20 mm too long.
SolveWorldOptions LongRanges() {
  SolveWorldOptions options = Views(12);
  options.shared[kRangeOffset] = -0.02;
  return options;
}

TEST(CalibrateJointly, ARangeOffsetThatTheRigAllowsForIsFoundWithinItsSigma) {
  const SolveWorld world(LongRanges());
  const Report report = Calibrate(world.rig, world.detections, Brief());
  for (std::size_t c = 0; c < 2; ++c) {
    const CameraReport& camera = report.cameras[c];
    ASSERT_TRUE(camera.calibration.range_errors);
    const Estimate& offset = camera.calibration.range_errors->offset_m;
    EXPECT_LT(offset.sigma, 0.005);
    EXPECT_NEAR(offset.value, -0.02, 3.5 * offset.sigma);
    EXPECT_LT(Chi2(world, report, c), kMostChi2);
    EXPECT_THAT(camera.rejected, IsEmpty());
    EXPECT_THAT(camera.warnings, IsEmpty());
  }
}

TEST(CalibrateJointly, ARangeOffsetThatTheRigRulesOutIsFoundAllTheSameAndSaid) {
  SolveWorld world(LongRanges());
  world.rig.lidar.range_offset_sigma_m = 0;
  const Report report = Calibrate(world.rig, world.detections, Brief());
  for (std::size_t c = 0; c < 2; ++c) {
    const CameraReport& camera = report.cameras[c];
    ASSERT_TRUE(camera.calibration.range_errors);
    const Estimate& offset = camera.calibration.range_errors->offset_m;
    EXPECT_NEAR(offset.value, -0.02, 3.5 * offset.sigma);
    EXPECT_LT(Chi2(world, report, c), kMostChi2);
    EXPECT_THAT(camera.warnings,
                Contains(AllOf(HasSubstr("mm too long"), HasSubstr("lidar.range_offset_sigma_m"))));
  }
}

TEST(CalibrateJointly, ExactRangesStayExactWhateverOneViewSays) {
  SolveWorld world(Views(12));
  world.rig.lidar.range_offset_sigma_m = 0;
  // By 60 mm along its beam, between the sweep and the images.
  const Eigen::Vector3d move = 0.06 * world.lidar_from_target[4].translation.normalized();
  CloudEdges& cloud = world.CloudAt(4);
  cloud.pose->sensor_from_target.translation += move;
  cloud.centre += move;
  for (Crossing& crossing : cloud.crossings) crossing.point += move;
  const Report report = Calibrate(world.rig, world.detections, Brief());
  for (std::size_t c = 0; c < 2; ++c) {
    const CameraReport& camera = report.cameras[c];
    EXPECT_FALSE(camera.calibration.range_errors);
    EXPECT_EQ(camera.rejected.size(), 1U);
    EXPECT_LT(Chi2(world, report, c), kMostChi2);
  }
}

// Rings as a recorded VLP-16 has them, and dark surfaces that read farther.
SolveWorldOptions Uneven(std::uint32_t seed) {
  SolveWorldOptions options = Views(12);
  options.seed = seed;
  options.rings = {0.010, 0.015, 0.003, 0.030};
  return options;
}

TEST(SolveJointly, RingsIntensitiesAndWhereBeamsMeetAreFoundWithThePose) {
  for (const std::uint32_t seed : {1, 2, 3}) {
    const SolveWorld world(Uneven(seed));
    const JointResult result = SolveJointly(SolveSession(world).Joint(kUsualRangeOffsetSigmaM));
    const BoardProblem& problem = result.joint.problem;
    EXPECT_NEAR(problem.priors.ring_view_sigma_m, 0.003, 0.0012) << seed;
    EXPECT_NEAR(problem.priors.ring_sigma_m, 0.010, 0.005) << seed;
    const SharedPlaces places(problem);
    const auto sigma_at = [&](Eigen::Index at) {
      return std::sqrt(result.variance_factor * result.solution.covariance(at, at));
    };
    EXPECT_NEAR(result.solution.state.shared[kBeamsMeet], 0.030,
                3.5 * sigma_at(places.Of(kBeamsMeet)))
        << seed;
    EXPECT_LT(sigma_at(places.Of(kBeamsMeet)), 0.008) << seed;
    // All rings together are the common offset's.
    const RangeTerms& terms = problem.ranges;
    ASSERT_GE(terms.rings.size(), 8U) << seed;
    double common = 0;
    double squares = 0;
    for (std::size_t i = 0; i < terms.rings.size(); ++i) {
      const auto ring = static_cast<std::size_t>(terms.rings[i]);
      common += (result.solution.state.range_terms[i] - world.ring_offset_m[ring]) /
                static_cast<double>(terms.rings.size());
    }
    int told = 0;
    for (std::size_t i = 0; i < terms.rings.size(); ++i) {
      const auto ring = static_cast<std::size_t>(terms.rings[i]);
      if (sigma_at(places.RangeTerm(i)) > 0.005) continue;  // hardly on a board
      const double off = result.solution.state.range_terms[i] - world.ring_offset_m[ring] - common;
      squares += off * off;
      ++told;
    }
    ASSERT_GE(told, 6) << seed;
    EXPECT_LT(std::sqrt(squares / told), 0.003) << seed;
    // Dark points lie 15 mm behind bright ones: at 2^-3.4 and 2^-0.7.
    ASSERT_GE(terms.octaves, 4U) << seed;
    const auto at = [&](double log2_intensity) {
      const OctavePlace place = PlaceOf(log2_intensity, terms.first_octave, terms.octaves);
      const std::size_t lower = terms.rings.size() + place.lower;
      return (1 - place.share) * result.solution.state.range_terms[lower] +
             place.share * result.solution.state.range_terms[lower + 1];
    };
    EXPECT_NEAR(at(-0.7) - at(-3.4), 0.015, 0.002) << seed;
    for (std::size_t c = 0; c < 2; ++c) {
      EXPECT_LT(Chi2Of(world.camera_from_lidar[c], result.solution.state.camera_from_lidar[c],
                       CovarianceOf(result, c).topLeftCorner<6, 6>()),
                kMostChi2)
          << seed;
    }
  }
}

TEST(SolveJointly, WhereRingsAgreeNoneIsGivenAnOffset) {
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    SolveWorldOptions options = Uneven(seed);
    options.views = 8;
    options.rings = SolveWorldOptions::Rings{};
    const SolveWorld world(options);
    const JointResult result = SolveJointly(SolveSession(world).Joint(kUsualRangeOffsetSigmaM));
    EXPECT_EQ(result.joint.problem.ranges.Count(), 0U) << seed;
    const SharedPlaces places(result.joint.problem);
    EXPECT_NEAR(
        result.solution.state.shared[kBeamsMeet], 0,
        3.5 * std::sqrt(result.variance_factor *
                        result.solution.covariance(places.Of(kBeamsMeet), places.Of(kBeamsMeet))))
        << seed;
  }
}

TEST(CalibrateJointly, WhatTheLidarIsOffByStandsInTheReport) {
  const SolveWorld world(Uneven(4));
  const Report report = Calibrate(world.rig, world.detections, Brief());
  for (const CameraReport& camera : report.cameras) {
    ASSERT_TRUE(camera.calibration.range_errors);
    const RangeErrors& errors = *camera.calibration.range_errors;
    EXPECT_EQ(errors, *report.cameras[0].calibration.range_errors);
    ASSERT_GE(errors.rings.size(), 8U);
    for (const auto& [ring, offset_m] : errors.rings) {
      EXPECT_GT(offset_m.sigma, 0);
      EXPECT_NEAR(offset_m.value, world.ring_offset_m[static_cast<std::size_t>(ring)], 0.02);
    }
    EXPECT_NEAR(errors.beams_meet_m.value, 0.03, 3.5 * errors.beams_meet_m.sigma);
    EXPECT_GE(errors.intensities.size(), 4U);
    EXPECT_THAT(camera.nuisance,
                Contains(Field(&Nuisance::name, HasSubstr("at which the LIDAR's beams meet"))));
  }
}

TEST(CalibrateJointly, ViewsLeftOutAreJudgedWithTheRangesThatWereFound) {
  const SolveWorld world(Uneven(5));
  const Report report = Calibrate(world.rig, world.detections, {});
  for (const CameraReport& camera : report.cameras) {
    ASSERT_TRUE(camera.calibration.range_errors);
    ASSERT_GE(camera.calibration.range_errors->rings.size(), 8U);
    double misfit = 0;
    double expected = 0;
    for (const Fold& fold : camera.folds) {
      misfit += fold.misfit;
      expected += fold.expected_misfit;
    }
    ASSERT_GE(camera.folds.size(), 4U);
    EXPECT_LT(misfit, 1.5 * expected);
    ASSERT_TRUE(camera.halves);
    EXPECT_LT(camera.halves->chi2, kMostChi2);
  }
}

}  // namespace
}  // namespace rgbdt
