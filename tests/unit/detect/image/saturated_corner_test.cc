#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "calib/detect/image/internal/corner_fit.h"
#include "calib/detect/image/internal/lower_bound.h"
#include "calib/detect/image/saturation.h"

namespace rgbdt {
namespace {

constexpr int kSize = 70;        // of an image [px]
constexpr double kLevel = 250;   // of 8 bits
constexpr double kBlurPx = 1.1;  // sigma
constexpr int kTrials = 300;

// A corner seen through a lens and then by a sensor: blurred, brightened, with noise, clipped and
// rounded, in that order. Squares of 22 to 30 px, each edge slanted by up to 0.4 rad.
class Corners {
 public:
  Corners(double exposure, double noise) : exposure_(exposure), noise_(noise) {}

  struct Shot {
    cv::Mat image;
    Eigen::Vector2d truth;
    Eigen::Matrix2d steps;
  };

  Shot Next() {
    Shot shot{cv::Mat(kSize, kSize, CV_32F), {35 + Even(), 35 + Even()}, {}};
    const double a = 0.4 * Even();
    const double b = 1.5708 + 0.4 * Even();
    const Eigen::Vector2d first(std::cos(a), std::sin(a));  // across the edges
    const Eigen::Vector2d second(std::cos(b), std::sin(b));
    const double step = 26 + 4 * Even();
    shot.steps << step * second.y(), -step * first.y(), -step * second.x(), step * first.x();
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        const Eigen::Vector2d off = Eigen::Vector2d(x, y) - shot.truth;
        const double pattern = Edge(off.dot(first)) * Edge(off.dot(second));
        const double value = exposure_ * (112 + 88 * pattern) + noise_ * normal_(random_);
        shot.image.at<float>(y, x) = static_cast<float>(std::clamp(std::round(value), 0.0, 255.0));
      }
    }
    return shot;
  }
  double Even() { return even_(random_); }

 private:
  static double Edge(double distance) { return std::erf(distance / (std::sqrt(2.0) * kBlurPx)); }

  double exposure_, noise_;
  std::mt19937 random_{7};
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> even_{-1, 1};
};

struct SaturatedFigures {
  int lost = 0;
  double rms_px = 0;  ///< of an error along x or y
  double nees = 0;    ///< of the error along x or y by the stated sigma, mean
  Eigen::Vector2d mean_error{0, 0};
};

SaturatedFigures Measure(double exposure, double noise, double level, bool blur_known) {
  Corners corners(exposure, noise);
  SaturatedFigures f;
  int count = 0;
  for (int i = 0; i < kTrials; ++i) {
    const Corners::Shot shot = corners.Next();
    const Eigen::Vector2d start =
        shot.truth + 0.6 * Eigen::Vector2d(corners.Even(), corners.Even());
    const auto fit = FitCorner(shot.image, start, shot.steps, Eigen::Matrix2d::Zero(),
                               blur_known ? std::optional<double>(kBlurPx) : std::nullopt, level);
    if (!fit) {
      ++f.lost;
      continue;
    }
    const Eigen::Vector2d error = fit->place - shot.truth;
    ++count;
    f.rms_px += 0.5 * error.squaredNorm();
    f.nees += 0.5 * error.squaredNorm() / (fit->sigma_px * fit->sigma_px);
    f.mean_error += error;
  }
  f.rms_px = std::sqrt(f.rms_px / count);
  f.nees /= count;
  f.mean_error /= count;
  return f;
}

// White at 200 (below the level) to 1000 (four times beyond it).
TEST(SaturatedCorner, IsWhereItIsAndItsSigmaIsTheError) {
  for (const double noise : {1.0, 4.0}) {
    const double clear_px = Measure(1, noise, kLevel, true).rms_px;
    for (const double exposure : {1.0, 1.2, 1.3, 1.6, 2.0, 3.0, 5.0}) {
      for (const bool blur_known : {false, true}) {
        SCOPED_TRACE(testing::Message() << "noise " << noise << ", exposure " << exposure
                                        << ", blur known " << blur_known);
        const SaturatedFigures f = Measure(exposure, noise, kLevel, blur_known);
        EXPECT_LE(f.lost, kTrials / 100);
        EXPECT_LT(f.rms_px,
                  1.15 * clear_px);  // what is clipped costs nothing: the edges are steeper
        // The sigma is the worst direction's: without saturation this is 0.7.
        EXPECT_GT(f.nees, 0.55);
        EXPECT_LT(f.nees, 0.95);
        EXPECT_LT(f.mean_error.norm(), 4 * f.rms_px / std::sqrt(kTrials));
      }
    }
  }
}

// What it is for.
TEST(SaturatedCorner, TakenForValuesSaturationMovesIt) {
  for (const double exposure : {1.6, 2.0, 3.0}) {
    const SaturatedFigures bounds = Measure(exposure, 1, kLevel, true);
    const SaturatedFigures values = Measure(exposure, 1, kNeverSaturated, true);
    EXPECT_GT(values.rms_px, 4 * bounds.rms_px) << exposure;
  }
}

TEST(SaturatedCorner, BelowTheLevelNothingChangesABit) {
  Corners corners(1, 2);
  for (int i = 0; i < 10; ++i) {
    const Corners::Shot shot = corners.Next();
    for (const std::optional<double> blur : {std::optional<double>(), {kBlurPx}}) {
      const auto with =
          FitCorner(shot.image, shot.truth, shot.steps, Eigen::Matrix2d::Zero(), blur, kLevel);
      const auto without =
          FitCorner(shot.image, shot.truth, shot.steps, Eigen::Matrix2d::Zero(), blur);
      ASSERT_TRUE(with && without);
      EXPECT_EQ(with->place, without->place);
      EXPECT_EQ(with->sigma_px, without->sigma_px);
      EXPECT_FALSE(with->saturated);
    }
  }
}

TEST(SaturatedCorner, AllWhiteIsNoCorner) {
  Corners corners(40, 1);
  const Corners::Shot shot = corners.Next();
  EXPECT_FALSE(
      FitCorner(shot.image, shot.truth, shot.steps, Eigen::Matrix2d::Zero(), kBlurPx, kLevel));
}

TEST(LowerBound, ItsDerivativesAreThoseOfItsCost) {
  for (const double z : {-40.0, -12.0, -5.01, -4.99, -2.0, 0.0, 1.5, 6.0}) {
    constexpr double kStep = 1e-4;
    const double slope = (LowerBound(z + kStep).cost - LowerBound(z - kStep).cost) / (2 * kStep);
    const double bend =
        (LowerBound(z + kStep).residual - LowerBound(z - kStep).residual) / (2 * kStep);
    EXPECT_NEAR(LowerBound(z).residual, -slope, 1e-5 * (1 + std::abs(slope))) << z;
    EXPECT_NEAR(LowerBound(z).weight, -bend, 1e-5) << z;
  }
  EXPECT_NEAR(LowerBound(-30).residual, 30, 0.05);  // as a value
  EXPECT_NEAR(LowerBound(10).residual, 0, 1e-20);
}

TEST(Saturation, IsToldByTheFormat) {
  Image image;
  image.pixels = cv::Mat(40, 40, CV_8UC3, cv::Scalar(9, 9, 9));
  EXPECT_EQ(SaturatedFrom(image), 250);
  image.pixels = cv::Mat(40, 40, CV_16U, cv::Scalar(9));
  for (int i = 0; i < 1600; ++i) image.pixels.at<std::uint16_t>(i / 40, i % 40) = i;
  EXPECT_EQ(SaturatedFrom(image), kNeverSaturated);
  image.pixels = cv::min(image.pixels, 1490);  // a plateau of 110 pixels
  EXPECT_EQ(SaturatedFrom(image), 1490);
}

}  // namespace
}  // namespace rgbdt
