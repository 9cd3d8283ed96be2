#include "calib/methods/natural/scene_problem.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace rgbdt {
namespace {

constexpr double kPlaneM = 4;                  // how far away the board hangs
const Eigen::Vector3d kLidar(0.5, -0.4, 0.3);  // in the camera's frame [m], turned as it is

CameraSpec Spec() {
  CameraSpec spec;
  spec.name = "rgb";
  spec.width = 240;
  spec.height = 200;
  spec.lens.fx = 210;
  spec.lens.fy = 205;
  spec.lens.cx = 118;
  spec.lens.cy = 103;
  spec.lens.distortion = {-0.08, 0.03, 0.001, -0.001, 0};
  return spec;
}

// A bright quadrangle's corners [m] on the plane z = kPlaneM of the camera.
const std::vector<Eigen::Vector2d> kCorners = {{-1.4, -1.1}, {1.2, -1.3}, {1.5, 0.9}, {-1.0, 1.2}};

Eigen::Vector2d PixelOf(const Lens& lens, const Eigen::Vector3d& p) {
  const double x = p.x() / p.z(), y = p.y() / p.z(), r2 = x * x + y * y;
  const auto& k = lens.distortion;
  const double radial = 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  return {lens.fx * (x * radial + 2 * k[2] * x * y + k[3] * (r2 + 2 * x * x)) + lens.cx,
          lens.fy * (y * radial + k[2] * (r2 + 2 * y * y) + 2 * k[3] * x * y) + lens.cy};
}

// Painted eight times finer, then blurred as a lens does; a slow rise elsewhere.
cv::Mat Painted() {
  constexpr int kFine = 8, kSteps = 40;
  const CameraSpec spec = Spec();
  std::vector<cv::Point> outline;
  for (std::size_t k = 0; k < kCorners.size(); ++k) {
    const Eigen::Vector2d from = kCorners[k], to = kCorners[(k + 1) % kCorners.size()];
    for (int i = 0; i < kSteps; ++i) {
      const Eigen::Vector2d at = from + (to - from) * i / kSteps;
      const Eigen::Vector2d pixel = PixelOf(spec.lens, {at.x(), at.y(), kPlaneM});
      outline.emplace_back(static_cast<int>(std::lround((pixel.x() + 0.5) * kFine - 0.5)),
                           static_cast<int>(std::lround((pixel.y() + 0.5) * kFine - 0.5)));
    }
  }
  cv::Mat fine(kFine * spec.height, kFine * spec.width, CV_32FC1, cv::Scalar(60));
  cv::fillPoly(fine, std::vector<std::vector<cv::Point>>{outline}, cv::Scalar(160));
  cv::Mat image;
  cv::resize(fine, image, {spec.width, spec.height}, 0, 0, cv::INTER_AREA);
  cv::GaussianBlur(image, image, {0, 0}, 0.8);
  for (int y = 0; y < image.rows; ++y) image.row(y) += 0.2 * y;
  return image;
}

// The quadrangle's rim, as a LIDAR beside the camera meets it.
std::shared_ptr<const SceneShot> QuadrangleShot() {
  auto shot = std::make_shared<SceneShot>();
  for (std::size_t k = 0; k < kCorners.size(); ++k) {
    const Eigen::Vector2d from = kCorners[k], to = kCorners[(k + 1) % kCorners.size()];
    for (int i = 2; i < 38; ++i) {
      const Eigen::Vector2d at = from + (to - from) * i / 40;
      SceneEdge edge;
      edge.point = Eigen::Vector3d(at.x(), at.y(), kPlaneM) - kLidar;
      edge.along.head<2>() = (to - from).normalized();
      // Hardly any room between the beams: rims are where they are.
      edge.across = 1e-7 * Eigen::Vector3d(edge.along.y(), -edge.along.x(), 0);
      edge.reach = i % 2 == 0 ? 0.6 : -0.2;
      edge.place = i;
      edge.thing = edge.rim = static_cast<int>(k);
      edge.kind = static_cast<SceneEdgeKind>(k % kSceneEdgeKinds);
      shot->edges.push_back(edge);
    }
  }
  shot->pictures.emplace_back(Painted(), 0);
  return shot;
}

class SceneProblemTest : public ::testing::Test {
 protected:
  SceneProblemTest() : problem_(Spec(), {QuadrangleShot()}) {
    state_.lens = Spec().lens;
    state_.beam_rad = state_.farther_m = 0;
    Vector6d off;
    off << 0.004, -0.003, 0.005, 0.01, 0.008, 0.02;
    state_.camera_from_lidar = Exp(off) * Rigid3{Eigen::Quaterniond::Identity(), kLidar};
    look_.sigma_px = 2;
    look_.matched = {0.7, 0.7};
    look_.thing_sigma_rad = look_.rim_sigma_rad = 1e-9;  // nothing is eliminated
  }
  double LogLikelihoodAt(const SceneVector& x) const {
    return problem_.SumsAt(state_.Moved(x), look_).log_likelihood;
  }
  static SceneVector Along(int k, double by) { return by * SceneVector::Unit(k); }

  SceneProblem problem_;
  SceneState state_;
  SceneLook look_;
};

// Over moves of half a pixel and more: below that the likelihood is rough, as an edge's place
// between an image's pixels is, and its slope says nothing.
const std::vector<double> kSigmas = {3, 4, 5, 6};

TEST_F(SceneProblemTest, TheGradientIsThatOfTheLogLikelihood) {
  const SceneSums sums = problem_.SumsAt(state_, look_);
  EXPECT_GT(sums.All().matched, 100);
  for (int k = 0; k < kSceneUnknowns; ++k) {
    ASSERT_GT(sums.information(k, k), 0) << k;
    const double sigma = 1 / std::sqrt(sums.information(k, k));
    double numeric = 0;  // for two sigma
    for (const double many : kSigmas) {
      numeric +=
          (LogLikelihoodAt(Along(k, many * sigma)) - LogLikelihoodAt(Along(k, -many * sigma))) /
          many / static_cast<double>(kSigmas.size());
    }
    EXPECT_NEAR(numeric, 2 * sigma * sums.gradient[k], 0.15 * std::abs(numeric) + 0.3) << k;
  }
}

TEST_F(SceneProblemTest, TheObservedInformationIsItsCurvature) {
  look_.observed = true;
  const SceneSums sums = problem_.SumsAt(state_, look_);
  const double here = LogLikelihoodAt(SceneVector::Zero());
  for (int k = 0; k < 6; ++k) {
    const double sigma = 1 / std::sqrt(sums.information(k, k));
    double numeric = 0;
    for (const double many : kSigmas) {
      numeric += (2 * here - LogLikelihoodAt(Along(k, many * sigma)) -
                  LogLikelihoodAt(Along(k, -many * sigma))) /
                 (many * many) / static_cast<double>(kSigmas.size());
    }
    EXPECT_NEAR(numeric, 1, 0.2) << k;
  }
}

TEST_F(SceneProblemTest, NewtonsStepsEndWhereTheRimIsPainted) {
  for (int i = 0; i < 10; ++i) {
    const SceneSums sums = problem_.SumsAt(state_, look_);
    const Matrix6d h = sums.information.topLeftCorner<6, 6>();
    SceneVector step = SceneVector::Zero();
    step.head<6>() = h.ldlt().solve(sums.gradient.head<6>());
    state_ = state_.Moved(step);
  }
  const SceneSums sums = problem_.SumsAt(state_, look_);
  EXPECT_LT(std::sqrt(sums.squares / sums.All().matched), 0.2);  // px
  EXPECT_LT(RotationDistance(state_.camera_from_lidar, Rigid3()), 2e-3);
}

TEST_F(SceneProblemTest, ARimThatSeveralShotsShowCountsOnce) {
  look_.thing_sigma_rad = look_.rim_sigma_rad = 2e-3;  // more than what an image tells of a rim
  const auto one = QuadrangleShot();
  auto moved = std::make_shared<SceneShot>(*one);
  moved->place.world = 1;
  const SceneSums alone = problem_.SumsAt(state_, look_);
  const SceneSums twice = SceneProblem(Spec(), {one, one}).SumsAt(state_, look_);
  const SceneSums apart = SceneProblem(Spec(), {one, moved}).SumsAt(state_, look_);
  EXPECT_EQ(twice.parts.size(), alone.parts.size());
  EXPECT_EQ(apart.parts.size(), 2 * alone.parts.size());
  for (int k = 0; k < 6; ++k) {
    EXPECT_NEAR(apart.information(k, k), 2 * alone.information(k, k),
                1e-6 * apart.information(k, k));
    if (k == 2) continue;  // a turn about the view is no shift of a rim
    EXPECT_LT(twice.information(k, k), 1.3 * alone.information(k, k)) << k;
  }
}

TEST_F(SceneProblemTest, WhereSaysInWhichPartOfTheImage) {
  const SceneSums sums = problem_.SumsAt(state_, look_);
  double all = 0;
  for (const double part : sums.where) all += part;
  EXPECT_NEAR(all, sums.All().matched, 1e-9);
  for (const std::size_t inner : {5U, 6U}) {  // the rim runs round them
    EXPECT_LT(sums.where[inner], 0.05 * all) << inner;
  }
}

}  // namespace
}  // namespace rgbdt
