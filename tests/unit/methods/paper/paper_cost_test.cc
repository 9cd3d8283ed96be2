#include "calib/methods/paper/internal/paper_cost.h"

#include <cmath>

#include "tests/unit/solve/board_world.h"

namespace rgbdt {
namespace {

using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>;

class PaperCostTest : public testing::Test {
 protected:
  PaperCostTest()
      : world_(MakeBoardWorld(1)),
        camera_(world_.spec),
        view_(CameraViewOf(world_.spec.name, world_.views[0])),
        field_(view_.image->width, view_.image->height, view_.image->edge_pixels),
        // Off the truth, so that points lie off the edges where the surface has a slope.
        start_(GuessOff(world_.camera_from_lidar, 0.02, 0.03, 5)) {}

  std::size_t size() const { return points().size(); }
  const std::vector<Eigen::Vector3d>& points() const { return view_.cloud->boundary; }

  std::unique_ptr<ceres::CostFunction> Cost() const {
    return PaperCost::Create(&camera_, &field_, &points(), start_);
  }

  Eigen::VectorXd ResidualsAt(const Vector6d& delta) const {
    Eigen::VectorXd residuals(static_cast<Eigen::Index>(size()));
    const double* parameters[] = {delta.data()};
    EXPECT_TRUE(Cost()->Evaluate(parameters, residuals.data(), nullptr));
    return residuals;
  }

  Jacobian JacobianAt(const Vector6d& delta) const {
    Eigen::VectorXd residuals(static_cast<Eigen::Index>(size()));
    Jacobian jacobian(static_cast<Eigen::Index>(size()), 6);
    const double* parameters[] = {delta.data()};
    double* jacobians[] = {jacobian.data()};
    EXPECT_TRUE(Cost()->Evaluate(parameters, residuals.data(), jacobians));
    return jacobian;
  }

  Jacobian Differences(const Vector6d& delta, double step) const {
    Jacobian jacobian(static_cast<Eigen::Index>(size()), 6);
    for (int axis = 0; axis < 6; ++axis) {
      const Vector6d d = step * Vector6d::Unit(axis);
      jacobian.col(axis) = (ResidualsAt(delta + d) - ResidualsAt(delta - d)) / (2 * step);
    }
    return jacobian;
  }

  // Points that stay on their pixel, and thus on one surface, while a step moves them by up to
  // `margin` px.
  std::vector<Eigen::Index> OffBoundaries(const Vector6d& delta, double margin) const {
    std::vector<Eigen::Index> rows;
    for (std::size_t i = 0; i < size(); ++i) {
      const Eigen::Vector2d pixel = *camera_.Project(Exp(delta) * start_ * points()[i]);
      const Eigen::Vector2d off = pixel - pixel.array().round().matrix();
      if (off.cwiseAbs().maxCoeff() < 0.5 - margin) rows.push_back(static_cast<Eigen::Index>(i));
    }
    return rows;
  }

  BoardWorld world_;
  Camera camera_;
  CameraView view_;
  DistanceField field_;
  Rigid3 start_;
};

TEST_F(PaperCostTest, OneParameterBlockOfSixAndOneResidualAPoint) {
  const auto cost = Cost();
  EXPECT_EQ(cost->num_residuals(), static_cast<int>(size()));
  EXPECT_THAT(cost->parameter_block_sizes(), testing::ElementsAre(6));
}

// Everything from scratch: matrices for the pose, the distances pixel by pixel, the surface by the
// normal equations of a general solver.
TEST_F(PaperCostTest, ResidualsAreWhatBruteForceSays) {
  Vector6d delta;
  delta << 0.01, -0.02, 0.015, 0.03, -0.01, 0.02;
  const Eigen::VectorXd residuals = ResidualsAt(delta);
  const Rigid3 pose = Exp(delta) * start_;
  const auto distance_at = [&](int x, int y) {
    double best = 1e9;
    for (const Eigen::Vector2i& e : view_.image->edge_pixels) {
      best =
          std::min(best, std::hypot(e.x() - std::clamp(x, 0, 639), e.y() - std::clamp(y, 0, 479)));
    }
    return best;
  };
  for (std::size_t i = 0; i < size(); i += 7) {
    Eigen::Vector2d pixel;
    const Eigen::Vector3d p = pose.rotation.toRotationMatrix() * points()[i] + pose.translation;
    ProjectUnchecked(world_.spec.lens, p.x(), p.y(), p.z(), &pixel.x(), &pixel.y());
    ASSERT_TRUE(camera_.Contains(pixel));
    const int x = static_cast<int>(std::lround(pixel.x()));
    const int y = static_cast<int>(std::lround(pixel.y()));
    Eigen::MatrixXd design(100, 6);
    Eigen::VectorXd values(100);
    for (int k = 0; k < 100; ++k) {
      const int a = k % 10 - 5;
      const int b = k / 10 - 5;
      design.row(k) << 1, a, b, a * a, a * b, b * b;
      values[k] = distance_at(x + a, y + b);
    }
    const Eigen::VectorXd c = design.colPivHouseholderQr().solve(values);
    const double u = pixel.x() - x;
    const double v = pixel.y() - y;
    const double expected = c[0] + c[1] * u + c[2] * v + c[3] * u * u + c[4] * u * v + c[5] * v * v;
    EXPECT_NEAR(residuals[static_cast<Eigen::Index>(i)], expected, 1e-4);  // stored in float
  }
}

TEST_F(PaperCostTest, TheJacobianIsTheCentralDifferenceOfThePapersStep) {
  const Vector6d zero = Vector6d::Zero();
  EXPECT_EQ(PaperCost::kDelta, 1e-6);
  EXPECT_EQ(JacobianAt(zero), Differences(zero, 1e-6));
}

// Away from pixel boundaries the objective is smooth, and every step finds the same slope. At
// boundaries it jumps by what two fits differ: there a difference quotient means nothing, which is
// the paper's objective and not this test's business.
TEST_F(PaperCostTest, HalvingTheStepDoesNotChangeTheSlope) {
  const Vector6d zero = Vector6d::Zero();
  const Jacobian jacobian = JacobianAt(zero);
  // 4e-6 rad and 4e-6 m move a point by 500 px * 4e-6 * (1 + slope) and less: under 0.01 px.
  const auto rows = OffBoundaries(zero, 0.01);
  ASSERT_GT(rows.size(), 0.9 * static_cast<double>(size()));
  for (const double step : {0.5e-6, 0.25e-6, 2e-6, 4e-6}) {
    const Jacobian other = Differences(zero, step);
    for (const Eigen::Index row : rows) {
      // Rounding: 1e-13 px over the step. Slopes are of the order of f = 500 px per radian.
      ASSERT_THAT(other.row(row), EigenNear(jacobian.row(row), 1e-3)) << "step " << step;
    }
  }
}

TEST_F(PaperCostTest, CentralDifferencesConvergeWithTheSquareOfTheStep) {
  const Vector6d zero = Vector6d::Zero();
  const double step = 4e-4;                     // truncation well above rounding
  const auto rows = OffBoundaries(zero, 0.35);  // 500 px * 4e-4 * (1 + slope^2): under 0.35 px
  ASSERT_GT(rows.size(), 5U);
  const Jacobian exact = JacobianAt(zero);
  const Jacobian coarse = Differences(zero, step) - exact;
  const Jacobian fine = Differences(zero, step / 2) - exact;
  double coarse2 = 0;
  double fine2 = 0;
  for (const Eigen::Index row : rows) {
    coarse2 += coarse.row(row).squaredNorm();
    fine2 += fine.row(row).squaredNorm();
  }
  EXPECT_GT(std::sqrt(coarse2), 1e-5);  // there is an error to shrink
  EXPECT_NEAR(std::sqrt(coarse2 / fine2), 4, 0.4);
}

// Against the chain rule with the surface's and the lens's own slopes: steps in the image instead
// of steps in the pose.
TEST_F(PaperCostTest, TheSlopeFollowsFromTheImagesByTheChainRule) {
  const Vector6d zero = Vector6d::Zero();
  const Jacobian jacobian = JacobianAt(zero);
  for (const Eigen::Index row : OffBoundaries(zero, 0.01)) {
    const Eigen::Vector3d p = start_ * points()[static_cast<std::size_t>(row)];
    const Eigen::Vector2d pixel = *camera_.Project(p);
    const double h = 1e-3;
    const Eigen::RowVector2d surface((field_.Value(pixel + Eigen::Vector2d(h, 0)) -
                                      field_.Value(pixel - Eigen::Vector2d(h, 0))) /
                                         (2 * h),
                                     (field_.Value(pixel + Eigen::Vector2d(0, h)) -
                                      field_.Value(pixel - Eigen::Vector2d(0, h))) /
                                         (2 * h));
    Eigen::Matrix<double, 2, 3> lens;
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d d = 1e-5 * Eigen::Vector3d::Unit(axis);
      lens.col(axis) = (*camera_.Project(p + d) - *camera_.Project(p - d)) / 2e-5;
    }
    // d (Exp(delta) p) / d delta = [-[p]x | I]: rotation by its whole angle, in camera axes.
    Eigen::Matrix<double, 3, 6> motion;
    motion << 0, p.z(), -p.y(), 1, 0, 0,  //
        -p.z(), 0, p.x(), 0, 1, 0,        //
        p.y(), -p.x(), 0, 0, 0, 1;
    ASSERT_THAT(jacobian.row(row), EigenNear(Eigen::RowVectorXd(surface * lens * motion), 1e-3));
  }
}

TEST_F(PaperCostTest, BehindTheCameraCountsHalfTheImagesWidth) {
  EXPECT_EQ(PaperResidual(camera_, field_, {0.1, 0.1, -2}), 320);
  EXPECT_EQ(PaperResidual(camera_, field_, {0, 0, 0}), 320);
}

TEST_F(PaperCostTest, OutsideTheImageTheBorderPixelCounts) {
  const Eigen::Vector3d right(0.75, 0, 1);
  const Eigen::Vector2d pixel = *camera_.Project(right);
  ASSERT_GT(pixel.x(), 639);
  EXPECT_EQ(PaperResidual(camera_, field_, right), field_.Nearest({639, pixel.y()}));
}

class SmoothPaperCostTest : public PaperCostTest {
 protected:
  double Smooth(const Eigen::Vector3d& point_in_camera) const {
    const std::vector<Eigen::Vector3d> points{point_in_camera};
    const PaperCost cost(&camera_, &smooth_, &points, Rigid3());
    const Vector6d zero = Vector6d::Zero();
    const double* parameters[] = {zero.data()};
    double residual = -1;
    EXPECT_TRUE(cost.Evaluate(parameters, &residual, nullptr));
    return residual;
  }

  // Off the axis by an angle, towards the image's right and a little down.
  static Eigen::Vector3d Towards(double angle) {
    return 3 * Eigen::Vector3d(std::sin(angle) * std::cos(0.3), std::sin(angle) * std::sin(0.3),
                               std::cos(angle));
  }

  const DistanceField smooth_{view_.image->width, view_.image->height, view_.image->edge_pixels,
                              FieldBeyond::kSmooth};
};

TEST_F(SmoothPaperCostTest, InTheImageItIsThePapersToTheLastBit) {
  for (double u = 0.5; u < 638; u += 13.7) {
    const Eigen::Vector3d point = 2.5 * *camera_.Unproject({u, 0.7 * u});
    ASSERT_EQ(Smooth(point), PaperResidual(camera_, field_, point)) << u;
  }
}

TEST_F(SmoothPaperCostTest, GrowsAllTheWayRoundToStraightBehind) {
  double before = Smooth(Towards(35 * M_PI / 180));  // outside the image
  for (double degrees = 37; degrees < 180; degrees += 2) {
    const double here = Smooth(Towards(degrees * M_PI / 180));
    ASSERT_GT(here, before + 5) << degrees;  // f = 500 px: 17 px in 2 degrees
    before = here;
  }
  // Nowhere more than some image widths: behind is far, not everything.
  EXPECT_LT(Smooth({0, 0, -2}), 6 * 640);
}

TEST_F(SmoothPaperCostTest, IsFiniteEverywhere) {
  for (const Eigen::Vector3d& point :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0, 0, -1), Eigen::Vector3d(1e-12, 0, -1e-12),
        Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, -1, 1e-15), Eigen::Vector3d(1e9, 1e9, -1e9)}) {
    EXPECT_TRUE(std::isfinite(Smooth(point))) << point.transpose();
    EXPECT_GE(Smooth(point), 0) << point.transpose();
  }
}

}  // namespace
}  // namespace rgbdt
