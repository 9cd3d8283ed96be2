#include "calib/solve/distance_field.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

using Pixels = std::vector<Eigen::Vector2i>;

constexpr int kWidth = 80;
constexpr int kHeight = 60;

Pixels RandomEdges(int count, std::uint32_t seed) {
  Random random(seed);
  Pixels edges;
  for (int i = 0; i < count; ++i) {
    edges.emplace_back(static_cast<int>(random.Uniform(0, kWidth)),
                       static_cast<int>(random.Uniform(0, kHeight)));
  }
  return edges;
}

double BruteForce(const Pixels& edges, int x, int y) {
  double best = 1e9;
  for (const Eigen::Vector2i& e : edges) best = std::min(best, std::hypot(e.x() - x, e.y() - y));
  return best;
}

// The distance of the nearest pixel of the image, for places outside of it.
double BruteForceClamped(const Pixels& edges, int x, int y) {
  return BruteForce(edges, std::clamp(x, 0, kWidth - 1), std::clamp(y, 0, kHeight - 1));
}

// The paper's surface, fitted with another algorithm, in absolute image coordinates.
double SurfaceByQr(const Pixels& edges, int x, int y, double u, double v) {
  Eigen::MatrixXd design(100, 6);
  Eigen::VectorXd values(100);
  int row = 0;
  for (int dy = -5; dy <= 4; ++dy) {
    for (int dx = -5; dx <= 4; ++dx) {
      const double a = x + dx;
      const double b = y + dy;
      design.row(row) << 1, a, b, a * a, a * b, b * b;
      values[row++] = BruteForceClamped(edges, x + dx, y + dy);
    }
  }
  const Eigen::VectorXd c = design.colPivHouseholderQr().solve(values);
  return c[0] + c[1] * u + c[2] * v + c[3] * u * u + c[4] * u * v + c[5] * v * v;
}

TEST(DistanceField, NearestIsTheDistanceToTheNearestEdgePixel) {
  const Pixels edges = RandomEdges(12, 1);
  const DistanceField field(kWidth, kHeight, edges);
  EXPECT_EQ(field.width(), kWidth);
  EXPECT_EQ(field.height(), kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      ASSERT_NEAR(field.Nearest(Eigen::Vector2d(x, y)), BruteForce(edges, x, y), 1e-5);
    }
  }
}

TEST(DistanceField, APixelReachesHalfWayToTheNext) {
  const Pixels edges = {{10, 10}};
  const DistanceField field(kWidth, kHeight, edges);
  EXPECT_EQ(field.Nearest({10.49, 9.51}), 0);
  EXPECT_EQ(field.Nearest({10.51, 10}), 1);
  EXPECT_EQ(field.Nearest({9.49, 10}), 1);
}

TEST(DistanceField, ValueIsTheLeastSquaresSurfaceOfThePixelsWindow) {
  const Pixels edges = RandomEdges(12, 2);
  const DistanceField field(kWidth, kHeight, edges);
  Random random(3);
  for (int i = 0; i < 300; ++i) {  // near the borders, too, where the window repeats border pixels
    const int x = static_cast<int>(random.Uniform(0, kWidth));
    const int y = static_cast<int>(random.Uniform(0, kHeight));
    const double u = std::clamp(x + random.Uniform(-0.499, 0.499), 0.0, kWidth - 1.0);
    const double v = std::clamp(y + random.Uniform(-0.499, 0.499), 0.0, kHeight - 1.0);
    // The transform is stored in float: 1e-6 of up to 100 px.
    ASSERT_NEAR(field.Value({u, v}), SurfaceByQr(edges, x, y, u, v), 1e-4) << u << ", " << v;
  }
}

TEST(DistanceField, IsExactWhereTheTransformIsASecondDegreePolynomial) {
  // A whole column of edge pixels: to the right of it the distance is x - 20.
  Pixels edges;
  for (int y = 0; y < kHeight; ++y) edges.emplace_back(20, y);
  const DistanceField field(kWidth, kHeight, edges);
  for (const double u : {25.5, 30.2, 44.9, 60.0, 73.4}) {  // windows clear of the edge and border
    EXPECT_NEAR(field.Value({u, 17.3}), u - 20, 1e-5);
  }
  EXPECT_NEAR(field.Value({7.3, 17.3}), 20 - 7.3, 1e-5);
}

TEST(DistanceField, TheLookUpTableChangesNothing) {
  const Pixels edges = RandomEdges(12, 2);
  const DistanceField used(kWidth, kHeight, edges);
  const auto pixel = [](int i) { return Eigen::Vector2d(0.37 * i, 0.29 * i); };
  for (int i = 0; i < 200; ++i) used.Value(pixel(i));
  for (int i = 0; i < 200; i += 10) {
    const DistanceField fresh(kWidth, kHeight, edges);
    EXPECT_EQ(used.Value(pixel(i)), fresh.Value(pixel(i)));
  }
}

TEST(DistanceField, OutsideTheImageTheBorderPixelCounts) {
  const Pixels edges = RandomEdges(5, 4);
  const DistanceField field(kWidth, kHeight, edges);
  const auto expect = [&](double u, double v, int x, int y) {
    EXPECT_NEAR(field.Value({u, v}), BruteForce(edges, x, y), 1e-5) << u << ", " << v;
    EXPECT_NEAR(field.Nearest({u, v}), BruteForce(edges, x, y), 1e-5) << u << ", " << v;
  };
  expect(-0.6, 30, 0, 30);
  expect(-1e9, 30.4, 0, 30);
  expect(kWidth + 5, 12.6, kWidth - 1, 13);
  expect(40, -100, 40, 0);
  expect(40, kHeight + 1e12, 40, kHeight - 1);
  expect(-3, -3, 0, 0);
  expect(1e15, 1e15, kWidth - 1, kHeight - 1);
}

TEST(DistanceField, EdgePixelsOutsideTheImageDoNotCount) {
  const DistanceField field(kWidth, kHeight, {{-1, 5}, {kWidth, 5}, {5, kHeight}, {40, 5}});
  EXPECT_EQ(field.Nearest({0, 5}), 40);
}

TEST(DistanceField, WithoutAnEdgePixelInTheImageIsAnInputError) {
  EXPECT_THAT(InputErrorOf([] { DistanceField(kWidth, kHeight, {}); }),
              testing::HasSubstr("none of 0 edge pixels"));
  EXPECT_THAT(InputErrorOf([] {
                DistanceField(kWidth, kHeight, {{-1, 3}, {80, 3}});
              }),
              testing::AllOf(testing::HasSubstr("none of 2"), testing::HasSubstr("80x60")));
}

}  // namespace
}  // namespace rgbdt
