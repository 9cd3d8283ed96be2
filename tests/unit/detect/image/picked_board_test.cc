#include "calib/detect/image/internal/picked_board.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "calib/camera/pixels.h"
#include "calib/detect/image/checkerboard.h"
#include "tests/unit/detect/image/covered_board.h"
#include "tests/unit/detect/image/posed_board.h"

namespace rgbdt {
namespace {

using ::testing::HasSubstr;

constexpr std::array<Cover, 4> kCovers{Cover::kPerson, Cover::kBar, Cover::kHalf, Cover::kBranch};
constexpr double kHalfTurn = 3.14159265358979323846;

Rigid3 AnyPose(Random* random, double nearest_m, double farthest_m) {
  const Eigen::Vector3d axis(random->Uniform(-1, 1), random->Uniform(-1, 1), 0);
  Rigid3 pose = RotationAbout(axis.normalized(), random->Uniform(0.15, 0.6)) *
                RotationAbout({0, 0, 1}, random->Uniform(-0.6, 0.6));
  const Eigen::Vector3d aside(random->Uniform(-0.1, 0.1), random->Uniform(-0.1, 0.1), 1);
  pose.translation = random->Uniform(nearest_m, farthest_m) * aside;
  return pose;
}

// Error of a pose against the truth, which may be half a turn off where that is not known.
Vector6d ErrorOf(const Rigid3& truth, const TargetPose& pose) {
  const Rigid3 target_from_camera = pose.sensor_from_target.Inverse();
  const Vector6d straight = Log(truth * target_from_camera);
  const Vector6d turned = Log(truth * RotationAbout({0, 0, 1}, kHalfTurn) * target_from_camera);
  return !pose.half_turn_known && turned.norm() < straight.norm() ? turned : straight;
}

double Nees(const Vector6d& error, const TargetPose& pose) {
  return error.dot(pose.covariance.ldlt().solve(error));
}

// A board partly hidden, and what a person clicks.
struct Shot {
  cv::Mat grey;
  Rigid3 truth;
  CornerSelection picks;
};

class Shots {
 public:
  Shots(const simulate::CameraOptions& options, double farthest_m)
      : board_(options), camera_(board_.spec()), farthest_m_(farthest_m), random_(3) {}

  const Camera& camera() const { return camera_; }
  Target target() const { return board_.target(); }
  bool color() const { return board_.spec().kind == CameraKind::kColor; }
  Random& random() { return random_; }

  Shot Next(Cover cover, double picks_off_px) {
    Shot shot;
    shot.truth = AnyPose(&random_, 2.2, farthest_m_);
    board_.Show(shot.truth);
    Image image = board_.Take(shots_++);
    const double aside = (cover == Cover::kHalf ? 0.02 : 0.25) * random_.Uniform(-1, 1);
    PaintCover(camera_, target(), shot.truth, cover, aside, &random_, &image.pixels);
    shot.grey = ToGrey(image);
    shot.picks = PicksNear(camera_, target(), shot.truth, picks_off_px, &random_);
    return shot;
  }

  PickedBoardResult Find(const Shot& shot) const {
    return FindPickedBoard(shot.grey, kNeverSaturated, camera_, target(), shot.picks.corners,
                           color());
  }

 private:
  PosedBoard board_;
  Camera camera_;
  double farthest_m_;
  Random random_;
  int shots_ = 0;
};

simulate::CameraOptions Thermal(double netd_k) {
  simulate::CameraOptions options = simulate::DefaultThermalCamera();
  options.netd_k = netd_k;
  return options;
}

// The farthest of the corners that are said to be seen from where the truth has it [px].
double WorstCorner(const Shots& shots, const Shot& shot, const PickedBoard& board) {
  const auto points = shots.target().InnerCorners();
  double straight = 0;
  double turned = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!IsSeen(board.corners[i])) continue;
    const auto off = [&](const Eigen::Vector3d& point) {
      return (board.corners[i] - *shots.camera().Project(shot.truth * point)).norm();
    };
    straight = std::max(straight, off(points[i]));
    turned = std::max(turned, off(points[points.size() - 1 - i]));
  }
  return board.pose.pose.half_turn_known ? straight : std::min(straight, turned);
}

struct Figures {
  int trials = 0, alone = 0, found = 0, seen = 0;
  double nees = 0, worst_nees = 0, worst_corner_sigmas = 0;
};

Figures FiguresOf(Shots* shots, int trials) {
  Figures f;
  for (; f.trials < trials; ++f.trials) {
    const Shot shot = shots->Next(kCovers[static_cast<std::size_t>(f.trials) % 4], 4);
    // Each kind of cover once: looking for what is not there takes longest.
    if (f.trials < 4 && FindCheckerboard(shot.grey, shots->target()).board) ++f.alone;
    const PickedBoardResult found = shots->Find(shot);
    if (!found.board) continue;
    const CornerPose& pose = found.board->pose;
    const double nees = Nees(ErrorOf(shot.truth, pose.pose), pose.pose);
    ++f.found;
    f.seen += static_cast<int>(
        std::count_if(found.board->corners.begin(), found.board->corners.end(), IsSeen));
    f.nees += nees;
    f.worst_nees = std::max(f.worst_nees, nees);
    f.worst_corner_sigmas = std::max(
        f.worst_corner_sigmas, WorstCorner(*shots, shot, *found.board) / pose.corner_sigma_px);
  }
  f.nees /= std::max(1, f.found);
  return f;
}

void Record(const std::string& name, const Figures& f) {
  ::testing::Test::RecordProperty(name + "_found", f.found);
  ::testing::Test::RecordProperty(name + "_seen_each", f.seen / std::max(1, f.found));
  ::testing::Test::RecordProperty(name + "_nees", std::to_string(f.nees));
  ::testing::Test::RecordProperty(name + "_worst_nees", std::to_string(f.worst_nees));
  ::testing::Test::RecordProperty(name + "_worst_corner_sigmas",
                                  std::to_string(f.worst_corner_sigmas));
}

// Measured over 48 of each: colour 4.8, thermal 3.5, at 8 and 16 times the default NETD 6.7; whole
// boards found without picks have 4.6, 3.6 and 9.3 in the same scenes. Below 6: sigma has a floor.
void ExpectAsExactAsStated(const Figures& f) {
  EXPECT_EQ(f.alone, 0);  // the covers are such that picks are needed
  EXPECT_EQ(f.found, f.trials);
  EXPECT_GT(f.seen, 25 * f.found);
  // The solver takes sigmas 1.4 times as large (kCornerSigmaInflation). 95% band of such a mean.
  EXPECT_LT(f.nees, 6 * 1.96 * (1 + 2 * std::sqrt(2.0 / 6 / f.trials)));
  EXPECT_GT(f.nees, 1);
  EXPECT_LT(f.worst_nees, 1.96 * 27.9);  // 1e-4 of chi-square with 6 degrees of freedom lie beyond
  EXPECT_LT(f.worst_corner_sigmas, 7);
}

TEST(PickedBoard, APartlyHiddenBoardIsMeasuredInColour) {
  Shots shots(simulate::DefaultColorCamera(), 6);
  const Figures f = FiguresOf(&shots, 12);
  Record("colour", f);
  ExpectAsExactAsStated(f);
}

TEST(PickedBoard, APartlyHiddenBoardIsMeasuredInThermal) {
  for (const double netd_k : {0.05, 0.8}) {
    SCOPED_TRACE(netd_k);
    Shots shots(Thermal(netd_k), 4.5);
    const Figures f = FiguresOf(&shots, 16);
    Record("thermal_" + std::to_string(netd_k), f);
    ExpectAsExactAsStated(f);
  }
}

TEST(PickedBoard, NoiseThatDrownsTheBoardGivesAReasonAndNoPose) {
  Shots shots(Thermal(6), 4.5);
  for (int i = 0; i < 4; ++i) {
    const PickedBoardResult found = shots.Find(shots.Next(kCovers[i % 4U], 4));
    ASSERT_FALSE(found.board);
    EXPECT_THAT(found.why, HasSubstr("of the 70 inner corners of the 11x8 squares only"));
    EXPECT_THAT(found.why, HasSubstr("capture again"));
  }
}

// What a person may do wrong: picks beside the board as a whole or each by itself, a square or two
// off, on something else, or on the pattern in place of the board.
TEST(PickedBoard, WrongPicksGiveAReasonOrTheTrueBoardButNeverAWrongPose) {
  for (const bool color : {true, false}) {
    Shots shots(color ? simulate::DefaultColorCamera() : Thermal(0.1), color ? 5 : 3.5);
    int rejected = 0;
    int trials = 0;
    for (int i = 0; i < 16; ++i) {
      Shot shot = shots.Next(kCovers[static_cast<std::size_t>(i) % 4], 3);
      const auto seen = [&](double x, double y) {
        return *shots.camera().Project(shot.truth * Eigen::Vector3d(x, y, 0));
      };
      const double square = shots.target().square_m;
      const double angle = shots.random().Uniform(0, 2 * kHalfTurn);
      for (std::size_t k = 0; k < 4; ++k) {
        Eigen::Vector2d& pick = shot.picks.corners[k];
        if (i / 4 % 4 == 0) pick += 40 * Eigen::Vector2d(std::cos(angle), std::sin(angle));
        if (i / 4 % 4 == 1)
          pick += Eigen::Rotation2Dd(angle + 1.7 * static_cast<double>(k)) * Eigen::Vector2d(40, 0);
        if (i / 4 % 4 == 2) pick += (1 + i % 2) * (seen(square, 0) - seen(0, 0));
        if (i / 4 % 4 == 3) pick += 300 * Eigen::Vector2d(std::cos(angle), std::sin(angle));
        pick = pick.cwiseMax(0).cwiseMin(
            Eigen::Vector2d(shots.camera().width() - 1, shots.camera().height() - 1));
      }
      ++trials;
      const PickedBoardResult found = shots.Find(shot);
      if (!found.board) {
        ++rejected;
        EXPECT_FALSE(found.why.empty());
        continue;
      }
      EXPECT_LT(Nees(ErrorOf(shot.truth, found.board->pose.pose), found.board->pose.pose),
                1.96 * 27.9)
          << i << (color ? " colour" : " thermal");
    }
    EXPECT_EQ(rejected, trials) << color;
  }
}

}  // namespace
}  // namespace rgbdt
