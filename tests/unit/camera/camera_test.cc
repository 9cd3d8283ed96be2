#include "calib/camera/camera.h"

#include <cmath>
#include <limits>

#include "tests/unit/camera/lenses.h"
#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

class CameraOf : public testing::TestWithParam<NamedLens> {};

TEST_P(CameraOf, EveryPixelGoesOutAndComesBack) {
  const CameraSpec& spec = GetParam().spec;
  const Camera camera(spec);
  const auto check = [&](double u, double v) {
    const Eigen::Vector2d pixel(u, v);
    const auto direction = camera.Unproject(pixel);
    ASSERT_TRUE(direction) << pixel.transpose();
    EXPECT_NEAR(direction->norm(), 1, 1e-12);
    for (const double distance : {0.5, 30.0}) {
      const auto back = camera.Project(distance * *direction);
      ASSERT_TRUE(back) << pixel.transpose();
      EXPECT_THAT(*back, EigenNear(pixel, 1e-6));
    }
  };
  for (int v = 0; v < spec.height; v += 7) {
    for (int u = 0; u < spec.width; u += 7) check(u, v);
  }
  for (const double u : {-0.5, 0.0, spec.width - 1.0, spec.width - 0.5}) {
    for (const double v : {-0.5, 0.0, spec.height - 1.0, spec.height - 0.5}) check(u, v);
  }
  check(spec.lens.cx, spec.lens.cy);
}

TEST_P(CameraOf, EveryDirectionInViewComesBack) {
  const Camera camera(GetParam().spec);
  Random random(3);
  int seen = 0;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d direction =
        (Eigen::Vector3d(0, 0, 1) + random.Uniform(0, 1) * random.Direction()).normalized();
    const auto pixel = camera.Project(7 * direction);
    if (!pixel || !camera.Contains(*pixel)) continue;
    const auto back = camera.Unproject(*pixel);
    ASSERT_TRUE(back);
    EXPECT_THAT(*back, EigenNear(direction, 1e-9));  // 1e-6 px over any f here
    ++seen;
  }
  EXPECT_GT(seen, 500);
}

TEST_P(CameraOf, NothingIsSeenBehindNorAtTheCentreNorNowhere) {
  const Camera camera(GetParam().spec);
  EXPECT_TRUE(camera.Project({0.1, 0.1, 1}));
  EXPECT_FALSE(camera.Project({0, 0, 0}));
  EXPECT_FALSE(camera.Project({0, 0, -1}));
  EXPECT_FALSE(camera.Project({1e-6, 0, -1}));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(camera.Project({nan, 0, 1}));
  EXPECT_FALSE(camera.Project({0, 0, nan}));
}

INSTANTIATE_TEST_SUITE_P(Lenses, CameraOf, testing::ValuesIn(Lenses()), NameOf);

TEST(Camera, APinholeSeesNothingBesideOrBehindIt) {
  const Camera camera(Lenses().front().spec);
  EXPECT_FALSE(camera.Project({1, 0, 0}));
  EXPECT_FALSE(camera.Project({0.1, 0.1, -1}));  // would be mirrored into the image
}

TEST(Camera, ContainsWhereAllFourNeighboursLieInTheImage) {
  const Camera camera(SpecOf(640, 480, {Lens::Model::kPinhole, 500, 500, 320, 240, {}}));
  EXPECT_TRUE(camera.Contains({0, 0}));
  EXPECT_TRUE(camera.Contains({639, 479}));
  EXPECT_FALSE(camera.Contains({639.01, 479}));
  EXPECT_FALSE(camera.Contains({10, 479.01}));
  EXPECT_FALSE(camera.Contains({-0.01, 0}));
  EXPECT_FALSE(camera.Contains({0, -0.01}));
}

// r (1 + k1 r^2) grows up to r = 1 / sqrt(-3 k1) and then comes back.
class FoldBack : public testing::Test {
 protected:
  static constexpr double kK1 = -0.3;
  const CameraSpec spec_ =
      SpecOf(640, 480, {Lens::Model::kPinhole, 500, 500, 320, 240, {kK1, 0, 0, 0, 0}});
  const Camera camera_{spec_};
  const double fold_ = 1 / std::sqrt(-3 * kK1);
};

TEST_F(FoldBack, TheFoldIsWhereTheDerivativeVanishes) {
  EXPECT_NEAR(camera_.max_angle(), std::atan(fold_), 0.5 * M_PI / 4000);  // the search's step
}

TEST_F(FoldBack, BeyondTheFoldThereIsNoPixelThoughTheFormulaHasOneInTheImage) {
  const Eigen::Vector3d before(0.99 * fold_, 0, 1);
  const Eigen::Vector3d just_beyond(1.01 * fold_, 0, 1);
  EXPECT_TRUE(camera_.Project(before));
  EXPECT_FALSE(camera_.Project(just_beyond));
  const Eigen::Vector3d far_beyond(1.7, 0.2, 1);
  Eigen::Vector2d alias;
  ProjectUnchecked(spec_.lens, far_beyond.x(), far_beyond.y(), far_beyond.z(), &alias.x(),
                   &alias.y());
  ASSERT_TRUE(camera_.Contains(alias));  // the danger is real
  EXPECT_FALSE(camera_.Project(far_beyond));
}

TEST_F(FoldBack, APixelThatNoDirectionReachesHasNone) {
  const double largest = 500 * fold_ * (1 + kK1 * fold_ * fold_);
  EXPECT_TRUE(camera_.Unproject({320 + 0.999 * largest, 240}));
  EXPECT_FALSE(camera_.Unproject({320 + 1.001 * largest, 240}));
}

TEST_F(FoldBack, ADistanceChangesNothing) {
  for (const double distance : {0.1, 1.0, 100.0}) {
    EXPECT_FALSE(camera_.Project(distance * Eigen::Vector3d(1.01 * fold_, 0, 1)));
    EXPECT_TRUE(camera_.Project(distance * Eigen::Vector3d(0.99 * fold_, 0, 1)));
  }
}

TEST(FisheyeFoldBack, BeyondTheFoldThereIsNoPixel) {
  // theta (1 + k1 theta^2): the fold lies at theta = 1 / sqrt(-3 k1).
  const double k1 = -0.2;
  const double fold = 1 / std::sqrt(-3 * k1);
  const Camera camera(SpecOf(640, 480, {Lens::Model::kFisheye, 300, 300, 320, 240, {k1}}));
  EXPECT_NEAR(camera.max_angle(), fold, M_PI / 4000);
  const auto at = [](double angle) { return Eigen::Vector3d(0, std::sin(angle), std::cos(angle)); };
  EXPECT_TRUE(camera.Project(at(0.99 * fold)));
  EXPECT_FALSE(camera.Project(at(1.01 * fold)));
  EXPECT_FALSE(camera.Project(at(2.1)));
}

TEST(FisheyeFoldBack, ALensThatFoldsBeyondARightAngleSeesBehindIt) {
  const Camera camera(SpecOf(640, 480, {Lens::Model::kFisheye, 300, 300, 320, 240, {-0.05}}));
  EXPECT_GT(camera.max_angle(), 0.5 * M_PI);
  const auto pixel = camera.Project({1, 0, -0.1});
  ASSERT_TRUE(pixel);
  const auto back = camera.Unproject(*pixel);
  ASSERT_TRUE(back);
  EXPECT_THAT(*back, EigenNear(Eigen::Vector3d(1, 0, -0.1).normalized(), 1e-9));
}

TEST(RationalFoldBack, APoleOfTheDenominatorEndsTheLens) {
  // 1 / (1 - r^2): grows without bound towards r = 1, and is negative beyond.
  const Camera camera(
      SpecOf(640, 480, {Lens::Model::kPinhole, 500, 500, 320, 240, {0, 0, 0, 0, 0, -1, 0, 0}}));
  EXPECT_NEAR(camera.max_angle(), std::atan(1.0), 0.5 * M_PI / 4000);
  EXPECT_TRUE(camera.Project({0.9, 0, 1}));
  EXPECT_FALSE(camera.Project({1.5, 0, 1}));
}

TEST(ProjectSegment, IsAChainFromEndToEndAlongTheBentLine) {
  const Camera camera(Lenses()[1].spec);
  const Eigen::Vector3d from(-0.4, 0.3, 1);
  const Eigen::Vector3d to(0.6, 0.35, 2);
  const auto chain = ProjectSegment(camera, from, to, 10);
  ASSERT_EQ(chain.size(), 11U);
  EXPECT_EQ(chain.front(), *camera.Project(from));
  EXPECT_EQ(chain.back(), *camera.Project(to));
  EXPECT_THAT(chain[5], EigenNear(*camera.Project(0.5 * (from + to)), 1e-9));
}

TEST(ProjectSegment, LeavesOutWhatCannotBeSeen) {
  const Camera camera(Lenses().front().spec);
  const auto chain = ProjectSegment(camera, {0, 0, 1}, {0, 0, -1}, 10);
  EXPECT_EQ(chain.size(), 5U);  // z = 1, 0.8, 0.6, 0.4, 0.2; zero is the centre itself
}

}  // namespace
}  // namespace rgbdt
