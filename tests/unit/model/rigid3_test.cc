#include "calib/model/rigid3.h"

#include <cmath>
#include <unsupported/Eigen/MatrixFunctions>

#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

Vector6d Delta(const Eigen::Vector3d& rotation, const Eigen::Vector3d& translation) {
  Vector6d delta;
  delta << rotation, translation;
  return delta;
}

// The definition: the exponential of the 4x4 twist matrix, by Eigen's general algorithm.
Eigen::Matrix4d ExpByDefinition(const Vector6d& d) {
  Eigen::Matrix4d twist;
  twist << 0, -d[2], d[1], d[3],  //
      d[2], 0, -d[0], d[4],       //
      -d[1], d[0], 0, d[5],       //
      0, 0, 0, 0;
  return twist.exp();
}

Eigen::Matrix4d MatrixOf(const Rigid3& motion) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = motion.rotation.toRotationMatrix();
  matrix.topRightCorner<3, 1>() = motion.translation;
  return matrix;
}

class ExpLog : public testing::TestWithParam<double> {};  // by angle

TEST_P(ExpLog, ExpIsTheMatrixExponential) {
  Random random(1);
  for (int i = 0; i < 20; ++i) {
    const Vector6d delta = Delta(GetParam() * random.Direction(), 2 * random.Direction());
    EXPECT_THAT(MatrixOf(Exp(delta)), EigenNear(ExpByDefinition(delta), 1e-13));
  }
}

TEST_P(ExpLog, LogUndoesExp) {
  Random random(2);
  for (int i = 0; i < 20; ++i) {
    const Vector6d delta = Delta(GetParam() * random.Direction(), 2 * random.Direction());
    EXPECT_THAT(Log(Exp(delta)), EigenNear(delta, 1e-12));
  }
}

// From identity over both sides of where the series take over (1e-5) to just below a half turn.
INSTANTIATE_TEST_SUITE_P(Angles, ExpLog,
                         testing::Values(0.0, 1e-12, 1e-8, 0.9e-5, 1.1e-5, 2.1e-5, 1e-4, 0.01, 0.7,
                                         1.5708, 3.0, M_PI - 1e-3, M_PI - 1e-7));

TEST(Rigid3, ExpOfZeroIsIdentity) {
  const Rigid3 identity = Exp(Vector6d::Zero());
  EXPECT_EQ(identity.rotation.coeffs(), Eigen::Quaterniond::Identity().coeffs());
  EXPECT_EQ(identity.translation, Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(Log(Rigid3()), Vector6d::Zero());
}

TEST(Rigid3, ExpUndoesLogOnEveryPoseTheHalfTurnIncluded) {
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    const Rigid3 pose = random.Pose();
    EXPECT_THAT(Exp(Log(pose)), Rigid3Near(pose, 1e-12, 1e-12));
  }
  Rigid3 half_turn = RotationAbout({1, 2, 3}, M_PI);
  half_turn.translation = {1, -2, 3};
  EXPECT_THAT(Exp(Log(half_turn)), Rigid3Near(half_turn, 1e-12, 1e-12));
}

TEST(Rigid3, LogTakesTheShortWayRound) {
  const Rigid3 more_than_half_a_turn = Exp(Delta({0, 0, 1.5 * M_PI}, {0, 0, 0}));
  EXPECT_THAT(Log(more_than_half_a_turn), EigenNear(Delta({0, 0, -0.5 * M_PI}, {0, 0, 0}), 1e-12));
}

// Not half of it: the trap of quaternion tangents.
TEST(Rigid3, DeltaRotatesByItsOwnLength) {
  const Rigid3 motion = Exp(Delta({0, 0, 0.1}, {0, 0, 0}));
  EXPECT_THAT(motion * Eigen::Vector3d(1, 0, 0),
              EigenNear(Eigen::Vector3d(std::cos(0.1), std::sin(0.1), 0), 1e-15));
}

TEST(Rigid3, CompositionAppliesTheRightOneFirst) {
  Rigid3 a_from_b = RotationAbout({0, 0, 1}, M_PI / 2);
  a_from_b.translation = {1, 0, 0};
  Rigid3 b_from_c;
  b_from_c.translation = {0, 2, 0};
  // c's origin lies at (0, 2, 0) in b; turned by 90 deg (-2, 0, 0), and shifted.
  EXPECT_THAT((a_from_b * b_from_c) * Eigen::Vector3d(0, 0, 0),
              EigenNear(Eigen::Vector3d(-1, 0, 0), 1e-15));
}

TEST(Rigid3, CompositionIsAGroup) {
  Random random(4);
  for (int i = 0; i < 50; ++i) {
    const Rigid3 a = random.Pose();
    const Rigid3 b = random.Pose();
    const Rigid3 c = random.Pose();
    const Eigen::Vector3d point = 3 * random.Direction();
    EXPECT_THAT((a * b) * point, EigenNear(a * (b * point), 1e-12));
    EXPECT_THAT((a * b) * c, Rigid3Near(a * (b * c), 1e-14, 1e-12));
    EXPECT_THAT(a * a.Inverse(), Rigid3Near(Rigid3(), 1e-14, 1e-12));
    EXPECT_THAT(a.Inverse() * (a * point), EigenNear(point, 1e-12));
    EXPECT_THAT((a * b).Inverse(), Rigid3Near(b.Inverse() * a.Inverse(), 1e-14, 1e-12));
  }
}

TEST(Rigid3, LongChainsStayNormalised) {
  const Rigid3 step = RotationAbout({1, 1, 0}, 0.01);
  Rigid3 pose;
  for (int i = 0; i < 100000; ++i) pose = pose * step;
  EXPECT_NEAR(pose.rotation.norm(), 1, 1e-15);
}

TEST(Rigid3, RotationAboutNormalisesItsAxis) {
  EXPECT_THAT(RotationAbout({0, 0, 7}, 0.3), Rigid3Near(RotationAbout({0, 0, 1}, 0.3), 1e-15, 0.0));
}

TEST(Rigid3, TheAdjointTakesADeltaFromOneFrameToTheOther) {
  Vector6d delta;
  delta << 0.1, -0.2, 0.3, 1, -2, 0.5;
  Vector6d pose;
  pose << -0.7, 0.4, 1.1, 3, 2, -4;
  const Rigid3 a_from_b = Exp(pose);
  const Rigid3 left = Exp(Adjoint(a_from_b) * delta) * a_from_b;
  const Rigid3 right = a_from_b * Exp(delta);
  EXPECT_LT(Log(left * right.Inverse()).norm(), 1e-12);
}

TEST(Rigid3, APointsCovarianceIsThatOfHowItMoves) {
  Matrix6d root = Matrix6d::Zero();
  for (int i = 0; i < 36; ++i) root(i / 6, i % 6) = std::sin(i * i + 1.0);
  const Eigen::Vector3d point(2, -1, 4);
  Eigen::Matrix3d expected = Eigen::Matrix3d::Zero();
  constexpr double kSmall = 1e-6;
  for (int i = 0; i < 6; ++i) {  // the columns of a root add up to the covariance
    const Eigen::Vector3d moved = (Exp(kSmall * root.col(i)) * point - point) / kSmall;
    expected += moved * moved.transpose();
  }
  EXPECT_LT((PointCovariance(root * root.transpose(), point) - expected).norm(),
            1e-4 * expected.norm());
}

TEST(RotationDistance, IsTheAngleBetweenTwoPoses) {
  Random random(5);
  for (const double angle : {0.0, 1e-9, 1e-4, 0.5, 3.0, M_PI}) {
    const Rigid3 a = random.Pose();
    const Rigid3 b = a * RotationAbout(random.Direction(), angle);
    EXPECT_NEAR(RotationDistance(a, b), angle, 1e-12);
    EXPECT_NEAR(RotationDistance(b, a), angle, 1e-12);
  }
}

TEST(RotationBetween, TakesOneDirectionToTheOtherTheShortestWay) {
  Random random(8);
  for (int trial = 0; trial < 100; ++trial) {
    const Eigen::Vector3d from = random.Direction();
    const Eigen::Vector3d to = random.Direction();
    const Eigen::Quaterniond rotation = RotationBetween(3 * from, 0.2 * to);
    EXPECT_THAT(rotation * from, EigenNear(to, 1e-14));
    const double angle = std::atan2(from.cross(to).norm(), from.dot(to));
    EXPECT_NEAR(RotationDistance({rotation, {}}, {}), angle, 1e-7);
  }
}

TEST(RotationBetween, OfOneDirectionIsNone) {
  const Eigen::Vector3d direction(1, 2, -3);
  EXPECT_NEAR(RotationDistance({RotationBetween(direction, 2 * direction), {}}, {}), 0, 1e-7);
}

TEST(RotationBetween, OfOppositeDirectionsIsAHalfTurn) {
  for (const Eigen::Vector3d& direction : {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(-1, 2, 5)}) {
    const Eigen::Quaterniond rotation = RotationBetween(direction, -direction);
    EXPECT_THAT(rotation * direction, EigenNear(-direction, 1e-12));
    EXPECT_NEAR(rotation.norm(), 1, 1e-15);
  }
}

TEST(RotationDistance, QuaternionsOfEitherSignAreOneRotation) {
  Rigid3 a = RotationAbout({1, 2, 3}, 0.7);
  Rigid3 b = a;
  b.rotation.coeffs() *= -1;
  EXPECT_NEAR(RotationDistance(a, b), 0, 1e-15);
}

TEST(CentreDistance, IsTheDistanceOfTheCamerasInTheLidarFrame) {
  // Two cameras with centres (1, 2, 3) and (1, 2, 3.5) in the LIDAR frame, looking elsewhere.
  const auto camera_at = [](const Eigen::Vector3d& centre, const Rigid3& rotation) {
    Rigid3 camera_from_lidar = rotation;
    camera_from_lidar.translation = -(rotation.rotation * centre);
    return camera_from_lidar;
  };
  const Rigid3 a = camera_at({1, 2, 3}, RotationAbout({1, 0, 2}, 1.0));
  const Rigid3 b = camera_at({1, 2, 3.5}, RotationAbout({0, 1, 1}, -2.0));
  EXPECT_NEAR(CentreDistance(a, b), 0.5, 1e-14);
  EXPECT_NEAR(CentreDistance(b, a), 0.5, 1e-14);
  // The difference of the translations is another thing.
  EXPECT_GT((a.translation - b.translation).norm(), 1);
}

}  // namespace
}  // namespace rgbdt
