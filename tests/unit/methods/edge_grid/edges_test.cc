#include <cmath>

#include "calib/methods/edge_grid/depth_jumps.h"
#include "calib/methods/edge_grid/edge_field.h"
#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

// Two rings, far apart, of beams a hundredth apart that meet something this far away.
Cloud RingsOf(const std::vector<double>& ranges) {
  Cloud cloud;
  cloud.lines = 2;
  cloud.beams = static_cast<int>(ranges.size());
  for (int ring = 0; ring < 2; ++ring) {
    for (int b = 0; b < cloud.beams; ++b) {
      const double azimuth = 0.01 * b;
      const double elevation = 0.1 * ring;
      const Eigen::Vector3d ray(std::cos(elevation) * std::cos(azimuth),
                                std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      const double range = ranges[static_cast<std::size_t>(b)];
      cloud.points.push_back((range * ray).cast<float>());
      cloud.directions.push_back(ray.cast<float>());
    }
  }
  return cloud;
}

TEST(DepthJumpsOf, TheNearSideOfAStepAlone) {
  const Cloud cloud = RingsOf({3, 3, 3, 5.25, 5.25, 5.25});
  const std::vector<DepthJump> edges = DepthJumpsOf(cloud, 0.3);
  ASSERT_EQ(edges.size(), 2);  // one a ring
  EXPECT_THAT(edges[0].point, EigenNear(cloud.points[2], 1e-6F));
  EXPECT_NEAR(edges[0].weight, 1.5, 1e-5);  // (5.25 - 3)^0.5
}

TEST(DepthJumpsOf, SmallStepsAreNoise) {
  const Cloud cloud = RingsOf({3, 3, 3.25, 3.25, 3.25});
  EXPECT_TRUE(DepthJumpsOf(cloud, 0.3).empty());
  EXPECT_EQ(DepthJumpsOf(cloud, 0.2).size(), 2);
}

TEST(DepthJumpsOf, ABeamThatReturnedNothingIsAsFarAsTheFarthest) {
  Cloud cloud = RingsOf({3, 3, NAN, NAN, 3, 12, 12});
  const std::vector<DepthJump> edges = DepthJumpsOf(cloud, 0.3);
  ASSERT_EQ(edges.size(), 4);
  EXPECT_THAT(edges[0].point, EigenNear(cloud.points[1], 1e-6F));
  EXPECT_NEAR(edges[0].weight, 3, 1e-5);  // (12 - 3)^0.5
  EXPECT_THAT(edges[1].point, EigenNear(cloud.points[4], 1e-6F));
  EXPECT_TRUE(DepthJumpsOf(RingsOf({3, 3, NAN, NAN, 3, 3}), 0.3).empty());
}

TEST(DepthJumpsOf, OfNothingIsNothing) { EXPECT_TRUE(DepthJumpsOf(Cloud(), 0.3).empty()); }

// As a turned scanner's: each line goes up, the next one stands beside it.
TEST(DepthJumpsOf, OfUprightLinesTheLinesBesideCount) {
  Cloud cloud;
  cloud.lines = 4;
  cloud.beams = 6;
  for (int line = 0; line < 4; ++line) {
    for (int b = 0; b < 6; ++b) {
      const Eigen::Vector3d ray = Eigen::Vector3d(1, 0.01 * line, 0.01 * b).normalized();
      // Two steps: between the second and the third line, and, up the lines, at the fourth beam.
      cloud.points.push_back(((line < 2 ? 3 : 4) + (b < 4 ? 0 : 2)) * ray.cast<float>());
      cloud.directions.push_back(ray.cast<float>());
    }
  }
  const std::vector<DepthJump> edges = DepthJumpsOf(cloud, 0.3);
  ASSERT_EQ(edges.size(), 6);  // the second line
  for (std::size_t b = 0; b < 6; ++b) {
    EXPECT_EQ(edges[b].point, cloud.points[6 + b]);
    EXPECT_NEAR(edges[b].weight, 1, 1e-5);
  }
}

TEST(EdgeImage, IsTheLargestDifferenceToANeighbour) {
  cv::Mat grey = cv::Mat::zeros(5, 5, CV_32FC1);
  grey.at<float>(2, 2) = 0.75F;
  const cv::Mat edges = EdgeImage(grey);
  EXPECT_FLOAT_EQ(edges.at<float>(2, 2), 0.75F);
  EXPECT_FLOAT_EQ(edges.at<float>(1, 1), 0.75F);
  EXPECT_FLOAT_EQ(edges.at<float>(3, 2), 0.75F);
  EXPECT_FLOAT_EQ(edges.at<float>(0, 0), 0);
  EXPECT_FLOAT_EQ(edges.at<float>(4, 2), 0);
}

TEST(InverseDistanceTransform, OfOnePixelFallsWithTheLargerDistance) {
  cv::Mat edges = cv::Mat::zeros(9, 12, CV_32FC1);
  edges.at<float>(4, 5) = 0.9F;
  const cv::Mat field = InverseDistanceTransform(edges, 1.0 / 3, 0.98);
  for (int y = 0; y < 9; ++y) {
    for (int x = 0; x < 12; ++x) {
      const int away = std::max(std::abs(x - 5), std::abs(y - 4));
      const double expected = (away == 0 ? 0.3 : 0) + 0.6 * std::pow(0.98, away);
      EXPECT_NEAR(field.at<float>(y, x), expected, 1e-5) << x << " " << y;
    }
  }
}

TEST(InverseDistanceTransform, IsTheFormulaOfThePaper) {
  Random random(7);
  cv::Mat edges(13, 17, CV_32FC1);
  for (int y = 0; y < 13; ++y) {
    for (int x = 0; x < 17; ++x) {
      edges.at<float>(y, x) = static_cast<float>(std::pow(random.Uniform(0, 1), 8));
    }
  }
  const cv::Mat field = InverseDistanceTransform(edges, 0.25, 0.8);
  for (int y = 0; y < 13; ++y) {
    for (int x = 0; x < 17; ++x) {
      double most = 0;
      for (int j = 0; j < 13; ++j) {
        for (int i = 0; i < 17; ++i) {
          const int away = std::max(std::abs(x - i), std::abs(y - j));
          most = std::max(most, edges.at<float>(j, i) * std::pow(0.8, away));
        }
      }
      EXPECT_NEAR(field.at<float>(y, x), 0.25 * edges.at<float>(y, x) + 0.75 * most, 1e-5);
    }
  }
}

}  // namespace
}  // namespace rgbdt
