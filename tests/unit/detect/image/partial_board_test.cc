// Boards of which a part is outside the image.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calib/camera/camera.h"
#include "calib/camera/pixels.h"
#include "calib/detect/image/checkerboard.h"
#include "calib/detect/image/image_edges.h"
#include "calib/detect/image/stillness.h"
#include "calib/detect/target_status.h"
#include "calib/simulate/simulator.h"
#include "tests/unit/detect/image/corner_errors.h"
#include "tests/unit/detect/image/overexposed_board.h"
#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

using ::testing::HasSubstr;

std::vector<Eigen::Vector2d> TrueCorners(const simulate::Simulator& simulator) {
  const CameraSpec& spec = simulator.rig().cameras[0];
  const Rigid3 camera_from_target = simulator.truth().camera_from_lidar.at(spec.name) *
                                    simulator.truth().lidar_from_target.at("0001");
  std::vector<Eigen::Vector2d> corners;
  for (const Eigen::Vector3d& corner : simulator.rig().target.InnerCorners()) {
    const Eigen::Vector2d outside = Eigen::Vector2d::Constant(-1e6);
    corners.push_back(Camera(spec).Project(camera_from_target * corner).value_or(outside));
  }
  return corners;
}

// Rendered thermal images.
TEST(PartialBoard, OutsideTheImageItIsUsedByWhatIsSeen) {
  for (const double share : {0.15, 0.45}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      simulate::Options options;
      options.seed = seed;
      options.cameras.erase(options.cameras.begin());  // thermal alone
      options.pose.outside_image = share;
      simulate::Simulator simulator(options);
      simulator.ShowView(0, "0001");
      const CheckerboardResult result = FindCheckerboard(
          ToGrey(simulator.TakeImage("thermal", 1'000'000)), simulator.rig().target);
      if (share < 0.2) {
        ASSERT_TRUE(result.board.has_value()) << seed << ": " << result.why;
        EXPECT_FALSE(
            std::all_of(result.board->corners.begin(), result.board->corners.end(), IsSeen));
        const Errors errors = Compare(result.board->corners, TrueCorners(simulator));
        EXPECT_LT(errors.worst, 1.0) << seed;
        EXPECT_LT(errors.rms, 0.3) << seed;
      } else {
        EXPECT_FALSE(result.board.has_value()) << seed;
        EXPECT_THAT(result.why, HasSubstr("10x7 inner corners")) << seed;
      }
    }
  }
}

// What is made of the corners that are seen: pose, sides, and whether the board stood still.
TEST(PartialBoard, ItsPoseSidesAndStillnessFollowFromWhatIsSeen) {
  simulate::Options options;
  options.seed = 1;
  options.cameras.erase(options.cameras.begin());  // thermal alone
  options.pose.outside_image = 0.15;
  simulate::Simulator simulator(options);
  simulator.ShowView(0, "0001");
  const CameraSpec& spec = simulator.rig().cameras[0];
  const Target& target = simulator.rig().target;
  const Camera camera(spec);
  const Image image = simulator.TakeImage("thermal", 1'000'000);
  const ImageEdgesResult found = DetectImageEdges(image, camera, target, nullptr, spec.kind);
  ASSERT_TRUE(found.edges.has_value()) << found.why;
  EXPECT_FALSE(found.edges->picked);
  ASSERT_TRUE(found.edges->pose.has_value());
  const Rigid3 truth = simulator.truth().camera_from_lidar.at(spec.name) *
                       simulator.truth().lidar_from_target.at("0001");
  EXPECT_THAT(found.edges->pose->sensor_from_target.translation,
              EigenNear(truth.translation, 0.05));
  const auto& sides = found.edges->sides;
  const auto seen = std::count_if(sides.begin(), sides.end(), [](const auto& s) { return s.seen; });
  EXPECT_GE(seen, 2);
  const cv::Mat grey = ToGrey(image);
  EXPECT_EQ(WhyNotStill(camera, target, grey, found.edges->corners, {{grey.clone(), 0.5}}), "");
  const TargetStatus status = LookForTarget(simulator.rig(), image);
  EXPECT_TRUE(status.seen) << status.text;
  EXPECT_TRUE(std::all_of(status.corners.begin(), status.corners.end(), IsSeen));
}

// Shifts a board until that share of it, its margin included, is outside the image.
void ShiftOut(double share, double direction, OverexposedBoard* board) {
  const Eigen::Vector2d along(std::cos(direction), std::sin(direction));
  const auto outside = [&](double shift) {
    board->pattern.centre = Eigen::Vector2d(320, 240) + shift * along;
    int out = 0;
    int all = 0;
    for (double x = -1.2; x <= board->pattern.squares_x + 1.2; x += 0.2) {
      for (double y = -1.2; y <= board->pattern.squares_y + 1.2; y += 0.2) {
        const Eigen::Vector2d p = board->pattern.Pixel(x, y);
        const bool inside = p.x() >= 0 && p.y() >= 0 && p.x() <= 639 && p.y() <= 479;
        out += inside ? 0 : 1;
        ++all;
      }
    }
    return static_cast<double>(out) / all;
  };
  double shift = 0;
  while (outside(shift) < share) shift += 1;
}

OverexposedBoard CutBoard(double share, int seed) {
  OverexposedBoard board = OverexposedBoard::Draw(seed);
  board.exposure = 1;
  cv::RNG random(static_cast<std::uint64_t>(seed + 1000));
  const double most = seed % 3 == 0 ? 0.08 : 3.1;
  board.pattern.angle = random.uniform(-most, most);
  ShiftOut(share, 1.5708 * seed + random.uniform(-0.3, 0.3), &board);
  return board;
}

// Nothing but the right row or column will do: one that is wrong puts corners a square off.
TEST(PartialBoard, WhichCornersAreOutsideTheImageIsNeverTakenWrongly) {
  int found = 0;
  int unseen = 0;
  constexpr int kBoards = 24;
  for (int seed = 0; seed < kBoards; ++seed) {
    const OverexposedBoard board = CutBoard(0.15 + 0.05 * (seed % 3), seed);
    const CheckerboardResult result = FindCheckerboard(board.Paint(), board.pattern.target(), 250);
    if (!result.board) {
      EXPECT_THAT(result.why, HasSubstr("7x5 inner corners")) << seed;
      continue;
    }
    ++found;
    EXPECT_LT(Compare(result.board->corners, board.pattern.Corners()).worst, 0.15) << seed;
    const auto& corners = result.board->corners;
    unseen += static_cast<int>(corners.size()) -
              static_cast<int>(std::count_if(corners.begin(), corners.end(), IsSeen));
  }
  EXPECT_GE(found, kBoards - 2);
  EXPECT_GE(unseen, 2 * kBoards);
}

// Along the side that is cut the number of squares cannot be told; along the other it is.
TEST(PartialBoard, ABoardOfAnotherSizePartlyOutsideTheImageIsRefused) {
  for (int seed = 0; seed < 12; seed += 3) {  // hardly turned: cut at one side
    const OverexposedBoard board = CutBoard(0.2, seed);
    const cv::Mat image = board.Paint();
    const bool columns_are_cut = seed % 2 == 0;
    for (const int more : {-2, -1, 1, 2}) {
      Target target = board.pattern.target();
      (columns_are_cut ? target.squares_y : target.squares_x) += more;
      EXPECT_FALSE(FindCheckerboard(image, target, 250).board.has_value()) << seed << " " << more;
    }
  }
}

}  // namespace
}  // namespace rgbdt
