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

class SmoothDistanceField : public testing::TestWithParam<std::uint32_t> {
 protected:
  // Where a person stands on the border, and which way is out of the image.
  struct Place {
    Eigen::Vector2d border, outwards;
  };

  // All round, corners with slanted ways out included.
  static std::vector<Place> Places(std::uint32_t seed) {
    constexpr double kRight = kWidth - 1;
    constexpr double kBottom = kHeight - 1;
    Random random(seed);
    std::vector<Place> places;
    for (int i = 0; i < 100; ++i) {
      const double u = random.Uniform(0, kRight);
      const double v = random.Uniform(0, kBottom);
      places.push_back({{0, v}, {-1, 0}});
      places.push_back({{kRight, v}, {1, 0}});
      places.push_back({{u, 0}, {0, -1}});
      places.push_back({{u, kBottom}, {0, 1}});
      const double a = random.Uniform(0, M_PI / 2);
      places.push_back({{kRight, kBottom}, {std::cos(a), std::sin(a)}});
      places.push_back({{0, 0}, {-std::cos(a), -std::sin(a)}});
    }
    return places;
  }

  const Pixels edges_ = RandomEdges(8, GetParam());
  const DistanceField flat_{kWidth, kHeight, edges_};
  const DistanceField smooth_{kWidth, kHeight, edges_, FieldBeyond::kSmooth};
  const std::vector<Place> places_ = Places(GetParam());
};

TEST_P(SmoothDistanceField, ChangesNothingInTheImageToTheLastBit) {
  EXPECT_EQ(flat_.beyond(), FieldBeyond::kBorderValue);
  Random random(GetParam());
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector2d pixel(random.Uniform(0, kWidth - 1), random.Uniform(0, kHeight - 1));
    ASSERT_EQ(smooth_.Value(pixel), flat_.Value(pixel));
    const Eigen::Vector2d anywhere = 3 * pixel - Eigen::Vector2d(kWidth, kHeight);
    ASSERT_EQ(smooth_.Nearest(anywhere), flat_.Nearest(anywhere));
  }
  for (const Place& place : places_) {
    ASSERT_EQ(smooth_.Value(place.border), flat_.Value(place.border));
  }
}

// From just outside to the border: the distance alone makes the difference.
TEST_P(SmoothDistanceField, ItsValueGoesOnAcrossTheBorder) {
  for (const Place& place : places_) {
    for (const double step : {1e-3, 1e-6, 1e-9}) {
      // The surface's slope is below 2 px/px, even where the transform has a ridge.
      ASSERT_NEAR(smooth_.Value(place.border + step * place.outwards), smooth_.Value(place.border),
                  2 * step);
    }
  }
}

TEST_P(SmoothDistanceField, ItsSlopeGoesOnAcrossTheBorder) {
  constexpr double kStep = 1e-5;
  for (const Place& place : places_) {
    const auto at = [&](double step) {
      return smooth_.Value(place.border + step * place.outwards);
    };
    const double inside = (at(0) - at(-kStep)) / kStep;
    const double outside = (at(kStep) - at(0)) / kStep;
    // Second derivatives of some 0.2 per pixel at most, times the step; rounding of 1e-14 / step.
    ASSERT_NEAR(inside, outside, 1e-5) << place.border.transpose();
  }
}

// Neighbouring pixels' surfaces differ a little (by what two fits differ), so is asked how much is
// gained over some pixels: at the border as much as in the image at least, farther out nearly all.
TEST_P(SmoothDistanceField, GrowsWithTheDistanceFromTheBorder) {
  for (const Place& place : places_) {
    double before = smooth_.Value(place.border);
    for (const double distance : {5.0, 10.0, 20.0, 40.0, 80.0, 1000.0, 1e6, 1e12}) {
      const double value = smooth_.Value(place.border + distance * place.outwards);
      ASSERT_GT(value, before) << distance << " px from " << place.border.transpose();
      before = value;
    }
    const double far = smooth_.Value(place.border + 1000 * place.outwards);
    ASSERT_NEAR(far - smooth_.Value(place.border), 1000, 11);
    ASSERT_NEAR(smooth_.Value(place.border + 1001 * place.outwards) - far, 1, 1e-3);
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, SmoothDistanceField, testing::Range(1U, 5U));

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
