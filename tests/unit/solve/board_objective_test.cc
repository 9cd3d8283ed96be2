#include "calib/solve/internal/board_objective.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include "calib/solve/first_guess.h"
#include "tests/numbers.h"
#include "tests/unit/solve/board_world.h"

namespace rgbdt {
namespace {

constexpr double kSigma = 0.01;  // of a point's distance from the plane [m]

Target WorldTarget() { return {11, 8, 0.1, 1.2, 0.9, {0, 0}, {}}; }

// What a cloud without noise tells of a board that stands there.
CloudEdges IdealCloud(const Rigid3& lidar_from_target) {
  CloudEdges cloud;
  cloud.pose = TargetPose{lidar_from_target, Matrix6d::Identity() * 1e-6, false};
  cloud.centre = lidar_from_target.translation;
  const auto corners = WorldTarget().OutlineCorners();
  for (int side = 0; side < 4; ++side) {
    const Eigen::Vector3d& from = corners[static_cast<std::size_t>(side)];
    const Eigen::Vector3d& to = corners[static_cast<std::size_t>((side + 1) % 4)];
    for (double t = 0.02; t < 1; t += 0.04) {
      Crossing crossing;
      crossing.point = lidar_from_target * Eigen::Vector3d(from + t * (to - from));
      crossing.side = side;
      crossing.half_width_m = 0.01;
      crossing.sigma_m = 0.01;
      cloud.crossings.push_back(crossing);
    }
  }
  for (double x = -0.58; x < 0.6; x += 0.04) {
    for (double y = -0.43; y < 0.45; y += 0.04) {
      Eigen::Vector4d q;
      q << lidar_from_target * Eigen::Vector3d(x, y, 0) - cloud.centre, 1;
      cloud.scatter += q * q.transpose();
    }
  }
  cloud.raw_scatter = cloud.scatter;
  cloud.scatter_sigma_m = kSigma;
  return cloud;
}

// An ideal world of boards: cameras and clouds without noise, sides without shifts.
class BoardObjectiveTest : public testing::Test {
 protected:
  void MakeViews(int count) {
    problem_.target = WorldTarget();
    problem_.cameras = {Camera(WorldCamera())};
    problem_.priors.thickness_m = 0;
    Random random(7);
    for (int i = 0; i < count; ++i) {
      Rigid3 camera_from_target = RotationAbout(random.Direction(), random.Uniform(0.2, 0.7)) *
                                  RotationAbout({0, 0, 1}, random.Uniform(-0.8, 0.8));
      const double z = random.Uniform(2, 4.5);
      camera_from_target.translation = {random.Uniform(-0.5, 0.5) * z,
                                        random.Uniform(-0.4, 0.4) * z, z};
      ImageEdges& image = images_.emplace_back();
      image.pose = TargetPose{camera_from_target, Matrix6d::Identity() * 1e-6, false};
      BoardView& view = problem_.views.emplace_back();
      view.name = std::to_string(i);
      view.cloud = IdealCloud(truth_.Inverse() * camera_from_target);
      view.images.push_back({0, &image, false});
    }
    state_ = StartOf(problem_, {truth_});
  }

  double At(const Rigid3& camera_from_lidar) const {
    return BoardObjective(problem_, state_, {camera_from_lidar});
  }

  const Rigid3 truth_ = WorldTruth();
  std::deque<ImageEdges> images_;
  BoardProblem problem_;
  BoardState state_;
};

TEST_F(BoardObjectiveTest, IsNothingAtTheTruth) {
  MakeViews(5);
  EXPECT_NEAR(At(truth_), 0, 1e-8);  // of some 4000 residuals: rounding
}

TEST_F(BoardObjectiveTest, IsMoreEverywhereElse) {
  MakeViews(5);
  Random random(3);
  for (int i = 0; i < 2000; ++i) {
    const double size = std::pow(10, random.Uniform(-4, 0.4));
    Vector6d delta;
    delta << random.Uniform(0, 1) * size * random.Direction(), size * random.Direction();
    ASSERT_GT(At(Exp(delta) * truth_), 0) << delta.transpose();
  }
}

TEST_F(BoardObjectiveTest, ASliceHasOneMinimum) {
  MakeViews(10);
  constexpr int kSteps = 60;
  for (int axis = 0; axis < 6; ++axis) {
    std::vector<double> slice;
    for (int i = -kSteps; i <= kSteps; ++i) {
      const double most = axis < 3 ? 30 * kDegree : 3;
      slice.push_back(At(truth_ * Exp(most * i / kSteps * Vector6d::Unit(axis))));
    }
    int minima = 0;
    for (std::size_t i = 1; i + 1 < slice.size(); ++i) {
      minima += slice[i] < slice[i - 1] && slice[i] < slice[i + 1] ? 1 : 0;
    }
    EXPECT_EQ(minima, 1) << "axis " << axis;
    EXPECT_EQ(std::min_element(slice.begin(), slice.end()) - slice.begin(), kSteps) << axis;
  }
}

// The camera 1 mm farther along a board's normal: so many points, each a tenth of a sigma off, and
// crossings that stay on their sides but for a slant.
TEST_F(BoardObjectiveTest, PointsCountByTheirSigma) {
  MakeViews(1);
  problem_.views[0].cloud.crossings.clear();
  const Eigen::Vector3d normal =
      images_[0].pose->sensor_from_target.rotation * Eigen::Vector3d::UnitZ();
  Rigid3 moved = truth_;
  moved.translation += 0.1 * kSigma * normal;
  EXPECT_NEAR(At(moved), 0.01 * problem_.views[0].cloud.scatter(3, 3), 1e-6);
}

// One crossing, 2 of its sigmas beyond its side.
TEST_F(BoardObjectiveTest, CrossingsCountByTheirSigmaAndShare) {
  MakeViews(1);
  CloudEdges& cloud = problem_.views[0].cloud;
  cloud.scatter_sigma_m = 0;
  Crossing crossing = cloud.crossings[30];
  ASSERT_EQ(crossing.side, 1);
  const auto residual = [&] {
    return ResidualOf(problem_.target, problem_.priors, crossing, cloud.pose->sensor_from_target,
                      state_.shared, 0);
  };
  const double own_sigma = residual().sigma_m;
  crossing.point += cloud.pose->sensor_from_target.rotation * Eigen::Vector3d(2 * own_sigma, 0, 0);
  crossing.sigma_m = 3 * own_sigma;  // its neighbours tell the same: a ninth of it is new
  cloud.crossings = {crossing};
  EXPECT_NEAR(At(truth_), 4.0 / 9, 1e-3);
  problem_.views[0].sides[1] = false;
  EXPECT_EQ(At(truth_), 0);
}

TEST_F(BoardObjectiveTest, WhichEndOfTheBoardIsUpDoesNotMatter) {
  MakeViews(4);
  const Rigid3 near = Exp(0.02 * Vector6d::Ones()) * truth_;
  const double before = At(near);
  for (ImageEdges& image : images_) {
    image.pose->sensor_from_target = image.pose->sensor_from_target * kHalfTurn;
  }
  EXPECT_NEAR(At(near), before, 1e-9 * before);
}

TEST_F(BoardObjectiveTest, IsFiniteAndBoundedWhereNoBeamMeetsTheBoard) {
  MakeViews(3);
  double residuals = 0;
  for (const BoardView& view : problem_.views) {
    residuals += static_cast<double>(view.cloud.crossings.size()) + view.cloud.scatter(3, 3);
  }
  // 10,000 sigmas: 9 (1 + log(1e8 / 9)) = 155.
  const double most = 156 * residuals;
  Random random(5);
  for (int i = 0; i < 2000; ++i) {
    const double value = At(random.Pose() * truth_);
    ASSERT_TRUE(std::isfinite(value));
    ASSERT_GT(value, residuals);
    ASSERT_LT(value, most);
  }
  // Edge-on, behind, and infinitely far as good as.
  for (double angle = 0; angle < 2 * M_PI; angle += 0.01) {
    ASSERT_LT(At(truth_ * RotationAbout({0, 0, 1}, angle)), most);
  }
  Rigid3 far = truth_;
  far.translation.x() = 1e12;
  EXPECT_LT(At(far), most);
}

}  // namespace
}  // namespace rgbdt
