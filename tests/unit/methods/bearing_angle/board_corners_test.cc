#include "calib/methods/bearing_angle/board_corners.h"

#include <cmath>
#include <limits>

#include "calib/methods/bearing_angle/bearing_angle_image.h"
#include "tests/unit/matchers.h"
#include "tests/unit/methods/scanned_board.h"

namespace rgbdt {
namespace {

TEST(BearingAngles, OfAWallAreTheAnglesToIt) {
  // The board stands behind the wall: there is only the wall, across x.
  Rigid3 behind = BoardBefore(0, 0);
  behind.translation.x() = -3;
  const ScannedBoard scanned(behind);
  const RangeGrid grid(scanned.cloud);
  const cv::Mat angles = BearingAngles(grid, Trace::kColumns);
  ASSERT_EQ(angles.rows, scanned.cloud.lines);
  ASSERT_EQ(angles.cols, scanned.cloud.beams);
  EXPECT_TRUE(std::isnan(angles.at<float>(32, 0)));
  for (int column = 1; column < angles.cols; ++column) {
    // On the level ring steps go along -y: the angle between that and the beam.
    const double azimuth = ScannedBoard::kStepRad * (80 - column);
    EXPECT_NEAR(angles.at<float>(32, column), M_PI / 2 + azimuth, 1e-3) << column;
  }
}

TEST(BearingAngles, AtAStepAreNearToZeroOrAStraightAngle) {
  const ScannedBoard scanned(BoardBefore(0, 0));
  const RangeGrid grid(scanned.cloud);
  const cv::Mat angles = BearingAngles(grid, Trace::kColumns);
  double least = 9;
  double most = 0;
  for (int column = 1; column < angles.cols; ++column) {
    least = std::min<double>(least, angles.at<float>(32, column));
    most = std::max<double>(most, angles.at<float>(32, column));
  }
  // 4 m deep, less than 0.1 m wide: atan(0.1 / 4) = 1.4 degrees.
  EXPECT_LT(least, 0.03);
  EXPECT_GT(most, M_PI - 0.03);
}

class PickBoardCornersAt : public testing::TestWithParam<double> {};

TEST_P(PickBoardCornersAt, FindsEachCornerToABeamsSpacing) {
  const ScannedBoard scanned(BoardBefore(0.3, GetParam()));
  const RangeGrid grid(scanned.cloud);
  const CloudEdges board = scanned.Detected();
  const auto corners = PickBoardCorners(grid, board, scanned.target);
  ASSERT_EQ(corners.size(), 4U);
  const auto truth = scanned.target.OutlineCorners();
  for (std::size_t k = 0; k < 4; ++k) {
    const Eigen::Vector3d off = board.pose->sensor_from_target.Inverse() * corners[k] - truth[k];
    EXPECT_LT(std::abs(off.z()), 1e-4) << k;
    // One spacing along the row and one along the column, whichever way the board is turned.
    EXPECT_LT(off.norm(), std::sqrt(2.0) * board.spacing_m) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Turns, PickBoardCornersAt, testing::Values(-0.3, 0.0, 0.1, 0.5));

TEST(PickBoardCorners, ACornerThatIsNotSeenIsNotPicked) {
  ScannedBoard scanned(BoardBefore(0, 0));
  const CloudEdges board = scanned.Detected();
  const Eigen::Vector3d top_left =
      board.pose->sensor_from_target * scanned.target.OutlineCorners()[0];
  for (Eigen::Vector3f& point : scanned.cloud.points) {
    // Something stands before it.
    if (point.cast<double>().normalized().dot(top_left.normalized()) > std::cos(0.06)) {
      point *= 0.5F / point.norm();
    }
  }
  const RangeGrid grid(scanned.cloud);
  const auto corners = PickBoardCorners(grid, board, scanned.target);
  EXPECT_FALSE(corners[0].allFinite());
  for (std::size_t k = 1; k < 4; ++k) EXPECT_TRUE(corners[k].allFinite()) << k;
}

// How far inside of the board those lie that lie farthest inside [m].
double DeepestEdge(const ScannedBoard& scanned) {
  const RangeGrid grid(scanned.cloud);
  const CloudEdges board = scanned.Detected();
  const auto edges = BoardEdges(grid, board, scanned.target);
  EXPECT_GT(edges.size(), 30U);
  double deepest = 0;
  for (const Eigen::Vector3d& point : edges) {
    const Eigen::Vector3d on = board.pose->sensor_from_target.Inverse() * point;
    deepest = std::max(deepest, std::min(scanned.target.width_m / 2 - std::abs(on.x()),
                                         scanned.target.height_m / 2 - std::abs(on.y())));
  }
  return deepest;
}

TEST(BoardEdges, AreNotWithinTheBoard) {
  const ScannedBoard scanned(BoardBefore(0.3, 0.2));
  EXPECT_LT(DeepestEdge(scanned), std::sqrt(2.0) * scanned.Detected().spacing_m);
}

TEST(BoardEdges, AreNotBesideBeamsThatWereNotFired) {
  ScannedBoard scanned(BoardBefore(0.3, 0.2));
  Cloud missed = scanned.cloud;
  for (std::size_t i = 0; i < scanned.cloud.size(); i += 3) {
    missed.points[i].setConstant(std::numeric_limits<float>::quiet_NaN());
    scanned.cloud.points[i] = scanned.cloud.directions[i] = missed.points[i];
  }
  EXPECT_LT(DeepestEdge(scanned), std::sqrt(2.0) * scanned.Detected().spacing_m);
  scanned.cloud = missed;
  EXPECT_GT(DeepestEdge(scanned), 0.2);
}

}  // namespace
}  // namespace rgbdt
