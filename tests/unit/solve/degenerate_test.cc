#include "calib/solve/internal/degenerate.h"

#include "calib/methods/calibrate.h"
#include "tests/unit/solve/solve_world.h"

namespace rgbdt {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

std::vector<Rigid3> Boards() { return SolveWorld().lidar_from_target; }

TEST(WhyDegenerate, OfATiltedAndMovedBoardThereIsNothingToSay) {
  EXPECT_EQ(WhyDegenerate(Boards()), "");
}

TEST(WhyDegenerate, OneView) {
  EXPECT_THAT(WhyDegenerate({Boards()[0]}), StartsWith("only one view"));
  EXPECT_THAT(WhyDegenerate({}), StartsWith("no view"));
}

TEST(WhyDegenerate, ParallelBoardsWhoseRollSaysNothing) {
  auto boards = Boards();
  for (std::size_t i = 0; i < boards.size(); ++i) {
    boards[i].rotation =
        (boards[0] * RotationAbout({0, 0, 1}, 0.2 * static_cast<double>(i))).rotation;
  }
  EXPECT_THAT(WhyDegenerate(boards), AllOf(HasSubstr("parallel"), HasSubstr(" 10 views")));
  boards[3] = boards[3] * RotationAbout({1, 0, 0}, 0.3);
  EXPECT_EQ(WhyDegenerate(boards), "");
}

TEST(WhyDegenerate, OnePlace) {
  auto boards = Boards();
  for (Rigid3& board : boards) board.translation = {3, 0.5, 0};
  EXPECT_THAT(WhyDegenerate(boards),
              AllOf(StartsWith("the board was at one place"), HasSubstr("x 3.0, y 0.5, z 0.0 m")));
  boards[3].translation.y() += 0.4;
  EXPECT_EQ(WhyDegenerate(boards), "");
}

TEST(WhyLoose, NamesTheDirectionThatIsLoosest) {
  Matrix6d covariance = 1e-8 * Matrix6d::Identity();
  EXPECT_EQ(WhyLoose(covariance), "");
  covariance(4, 4) = 0.15 * 0.15;
  EXPECT_THAT(WhyLoose(covariance),
              StartsWith("shifts along the camera's y (down) are known to 150 mm only"));
  covariance(2, 2) = 0.1 * 0.1;  // 5.7 deg
  EXPECT_THAT(WhyLoose(covariance),
              StartsWith("turns about the camera's z (forward) are known to 5.7 deg"));
}

// Through Calibrate.

void ExpectDegenerate(const Report& report, const std::string& why) {
  for (const CameraReport& camera : report.cameras) {
    EXPECT_THAT(camera.calibration.StatusText(), AllOf(StartsWith("degenerate: "), HasSubstr(why)));
    EXPECT_FALSE(camera.calibration.converged());
    EXPECT_FALSE(camera.calibration.covariance);
    EXPECT_FALSE(camera.sigma);
  }
}

SolveWorld WorldOf(const std::vector<Rigid3>& boards) {
  SolveWorldOptions options;
  options.views = 0;
  SolveWorld world(options);
  for (const Rigid3& board : boards) world.AddView(board);
  return world;
}

class DegenerateBy : public testing::TestWithParam<const char*> {
 public:
  Report Solve(const SolveWorld& world) const {
    CalibrateOptions options;
    options.method = GetParam();
    return Calibrate(world.rig, world.observations, options);
  }
};
INSTANTIATE_TEST_SUITE_P(Methods, DegenerateBy, testing::Values(kAutoMethod, kPlaneMethod));

TEST_P(DegenerateBy, ASessionOfOneView) {
  ExpectDegenerate(Solve(WorldOf({SolveWorld().lidar_from_target[0]})), "only one view");
}

TEST_P(DegenerateBy, ASessionOfParallelBoards) {
  SolveWorld world = WorldOf({});
  Rigid3 board = world.AnyBoard();
  const Eigen::Vector3d place = board.translation;
  for (int i = 0; i < 6; ++i) {
    board.translation = (1 + 0.15 * i) * place;
    world.AddView(board * RotationAbout({0, 0, 1}, 0.1 * i));
  }
  ExpectDegenerate(Solve(world), "parallel");
}

TEST_P(DegenerateBy, ASessionAtOnePlace) {
  SolveWorld world = WorldOf({});
  const Eigen::Vector3d place(3, 0.1, 0);
  while (world.lidar_from_target.size() < 6) {
    Rigid3 board = world.AnyBoard();
    board.translation = place;
    if (world.Seen(board)) world.AddView(board);
  }
  ExpectDegenerate(Solve(world), "at one place");
}

}  // namespace
}  // namespace rgbdt
