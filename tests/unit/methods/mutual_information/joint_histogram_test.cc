#include "calib/methods/mutual_information/joint_histogram.h"

#include <cmath>
#include <opencv2/core.hpp>

#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

TEST(EntropiesOf, TwoValuesThatAreTheSame) {
  const cv::Mat joint = (cv::Mat_<double>(2, 2) << 3, 0, 0, 3);
  const Entropies e = EntropiesOf(joint);
  EXPECT_NEAR(e.x, std::log(2), 1e-12);
  EXPECT_NEAR(e.MutualInformation(), std::log(2), 1e-12);
  EXPECT_NEAR(e.Normalised(), 2, 1e-12);
}

TEST(EntropiesOf, IndependentValuesTellNothingOfEachOther) {
  const cv::Mat joint = (cv::Mat_<double>(2, 2) << 1, 2, 3, 6);
  EXPECT_NEAR(EntropiesOf(joint).MutualInformation(), 0, 1e-12);
  EXPECT_NEAR(EntropiesOf(joint).Normalised(), 1, 1e-12);
}

TEST(EntropiesOf, AThirdByHand) {
  // p = 1/2, 1/4, 0, 1/4: H(X) = -3/4 ln 3/4 - 1/4 ln 1/4, H(Y) = ln 2, H(X, Y) = 3/2 ln 2.
  const cv::Mat joint = (cv::Mat_<double>(2, 2) << 2, 1, 0, 1);
  EXPECT_NEAR(EntropiesOf(joint).MutualInformation(), 0.2157615543388, 1e-12);
}

TEST(EntropiesOf, OfNothingIsNothing) {
  EXPECT_EQ(EntropiesOf(cv::Mat::zeros(4, 4, CV_64FC1)).MutualInformation(), 0);
}

TEST(JointHistogram, SharesAGreyValueBetweenTwoBins) {
  JointHistogram histogram(5);
  histogram.Add(0.9, 0.3125);  // 0.3125 lies at 1.25 of 0 to 4
  EXPECT_NEAR(histogram.counts().at<double>(4, 1), 0.75, 1e-12);
  EXPECT_NEAR(histogram.counts().at<double>(4, 2), 0.25, 1e-12);
  histogram.Add(1, 1);
  EXPECT_NEAR(histogram.counts().at<double>(4, 4), 1, 1e-12);
}

TEST(JointHistogram, ItsDensityIsAsWideAsSilvermanSays) {
  // Two values, half each, a quarter from the middle: sigma is 0.25; n is 1024, so the bandwidth
  // is 1.06 * 0.25 / 4 of the whole, and a value spreads by that.
  constexpr int kBins = 128;
  JointHistogram histogram(kBins);
  for (int i = 0; i < 512; ++i) {
    histogram.Add(0.25 + 0.5 / kBins, 0.25);
    histogram.Add(0.75 + 0.5 / kBins, 0.75);
  }
  const cv::Mat density = histogram.Density();
  EXPECT_NEAR(cv::sum(density)[0], 1024, 1e-6);
  double sum = 0;
  double squares = 0;
  for (int r = 0; r < kBins / 2; ++r) {
    const double weight = cv::sum(density.row(r))[0];
    sum += weight;
    squares += weight * (r - 32) * (r - 32);
  }
  EXPECT_NEAR(std::sqrt(squares / sum) / kBins, 1.06 * 0.25 / 4, 0.002);
}

TEST(JointHistogram, SmoothingKeepsIndependentValuesIndependent) {
  JointHistogram independent(32);
  JointHistogram same(32);
  for (int x = 0; x <= 10; ++x) {
    for (int y = 0; y <= 10; ++y) {
      independent.Add(x / 10.0, y / 10.0);
      same.Add(x / 10.0, x / 10.0);
    }
  }
  EXPECT_NEAR(EntropiesOf(independent.Density()).MutualInformation(), 0, 1e-9);
  EXPECT_GT(EntropiesOf(same.Density()).MutualInformation(), 0.5);
}

}  // namespace
}  // namespace rgbdt
