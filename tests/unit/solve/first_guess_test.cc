#include "calib/solve/first_guess.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "calib/model/calibration.h"
#include "calib/model/errors.h"
#include "calib/model/linear_algebra.h"

namespace rgbdt {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const Rigid3 kHalfTurn = RotationAbout({0, 0, 1}, M_PI);

// Sessions without images: what detection would give, with noise of its stated covariance.
class Made {
 public:
  explicit Made(unsigned seed) : random_(seed) {}

  double Normal() { return std::normal_distribution<double>()(random_); }
  double Uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  Rigid3 AnyRotation() {
    return {Eigen::Quaterniond(Normal(), Normal(), Normal(), Normal()).normalized(), {0, 0, 0}};
  }
  // A camera that looks anywhere, beside the LIDAR.
  Rigid3 AnyCamera() {
    Rigid3 camera = AnyRotation();
    camera.translation = {Uniform(-0.3, 0.3), Uniform(-0.3, 0.3), Uniform(-0.3, 0.3)};
    return camera;
  }
  // A board that faces the LIDAR, more or less, 2 to 6 m away.
  Rigid3 AnyBoard() {
    const Rigid3 place =
        RotationAbout({0, 0, 1}, Uniform(-0.5, 0.5)) * RotationAbout({0, 1, 0}, Uniform(-0.3, 0.3));
    const Eigen::Vector3d centre = place * Eigen::Vector3d(Uniform(2, 6), 0, 0);
    Eigen::Matrix3d facing;  // target x right, y down, z away, seen along the LIDAR's x
    facing << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    Rigid3 board = place * Rigid3{Eigen::Quaterniond(facing), {0, 0, 0}} *
                   RotationAbout({1, 0, 0}, Uniform(-0.6, 0.6)) *
                   RotationAbout({0, 1, 0}, Uniform(-0.6, 0.6)) *
                   RotationAbout({0, 0, 1}, Uniform(-M_PI, M_PI));
    board.translation = centre;
    return board;
  }
  // `pose` seen with errors of these sigmas about the board's centre.
  TargetPose Seen(const Rigid3& pose, double angle_sigma, double centre_sigma) {
    Vector6d sigma;
    sigma << angle_sigma, angle_sigma, angle_sigma, centre_sigma, centre_sigma, centre_sigma;
    Vector6d noise;
    for (int i = 0; i < 6; ++i) noise[i] = sigma[i] * Normal();
    // Errors are drawn in axes parallel to the sensor's through the board's centre.
    const Rigid3 centre{Eigen::Quaterniond::Identity(), pose.translation};
    TargetPose seen;
    seen.sensor_from_target = centre * Exp(noise) * centre.Inverse() * pose;
    Matrix6d shift = Matrix6d::Identity();
    const Eigen::Vector3d& c = pose.translation;
    shift.block<3, 3>(3, 0) << 0, -c.z(), c.y(), c.z(), 0, -c.x(), -c.y(), c.x(), 0;
    seen.covariance = shift * Matrix6d(sigma.cwiseAbs2().asDiagonal()) * shift.transpose();
    if (Uniform(0, 1) < 0.5) seen.sensor_from_target = seen.sensor_from_target * kHalfTurn;
    return seen;
  }
  ViewDetection View(const Rigid3& camera_from_lidar, const Rigid3& board) {
    ImageEdges image;
    image.pose = Seen(camera_from_lidar * board, 0.005, 0.008);
    ViewDetection view;
    view.images = {{"rgb", 0, image, "", 0}};
    view.cloud.candidates = {Candidate(board)};
    return view;
  }
  CloudEdges Candidate(const Rigid3& board) {
    CloudEdges edges;
    edges.pose = Seen(board, 0.005, 0.004);
    return edges;
  }
  std::vector<ViewDetection> Session(const Rigid3& camera_from_lidar, int views) {
    std::vector<ViewDetection> session;
    for (int i = 0; i < views; ++i) session.push_back(View(camera_from_lidar, AnyBoard()));
    return session;
  }

 private:
  std::mt19937 random_;
};

FirstGuess Guess(const std::vector<ViewDetection>& session, const FirstGuessOptions& options = {}) {
  std::vector<CameraView> views;
  for (const ViewDetection& view : session) views.push_back(CameraViewOf("rgb", view));
  std::vector<const CameraView*> pointers;
  for (const CameraView& view : views) pointers.push_back(&view);
  return GuessFromBoards(pointers, options);
}

TEST(FirstGuess, FindsCamerasThatLookAnywhereFromFiveViews) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    Made made(seed);
    const Rigid3 truth = made.AnyCamera();
    const auto session = made.Session(truth, 5);
    const FirstGuess guess = Guess(session);
    ASSERT_TRUE(guess.camera_from_lidar) << seed << ": " << guess.detail;
    const PoseError error = ErrorOf(*guess.camera_from_lidar, truth);
    EXPECT_LT(error.rotation_deg, 2) << seed;
    EXPECT_LT(error.translation_mm, 60) << seed;
    EXPECT_EQ(guess.agreeing, 5) << seed;
  }
}

TEST(FirstGuess, ItsCovarianceIsThatOfItsErrors) {
  double chi2 = 0;
  constexpr int kSessions = 400;
  for (unsigned seed = 0; seed < kSessions; ++seed) {
    Made made(1000 + seed);
    const Rigid3 truth = made.AnyCamera();
    const auto session = made.Session(truth, 6);
    const FirstGuess guess = Guess(session);
    ASSERT_TRUE(guess.camera_from_lidar);
    const Vector6d delta = Log(truth * guess.camera_from_lidar->Inverse());
    chi2 += delta.dot(SolveSymmetric(guess.covariance, delta));
  }
  // Mean of chi squared with six degrees of freedom: 6, its own sigma sqrt(12 / 400) = 0.17.
  EXPECT_NEAR(chi2 / kSessions, 6, 0.6);
}

TEST(FirstGuess, AThirdOfTheViewsMayBeWrong) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    Made made(2000 + seed);
    const Rigid3 truth = made.AnyCamera();
    auto session = made.Session(truth, 9);
    for (std::size_t i = 0; i < 3; ++i) {  // another board's pose, a door
      session[i].cloud.candidates = {made.Candidate(made.AnyBoard())};
    }
    const FirstGuess guess = Guess(session);
    ASSERT_TRUE(guess.camera_from_lidar) << seed << ": " << guess.detail;
    EXPECT_LT(ErrorOf(*guess.camera_from_lidar, truth).rotation_deg, 2) << seed;
    EXPECT_EQ(guess.agreeing, 6) << seed;
    for (std::size_t i = 0; i < 9; ++i) {
      const CameraView chosen =
          WithChosenCandidate(CameraViewOf("rgb", session[i]), *guess.camera_from_lidar);
      EXPECT_EQ(chosen.usable(), i >= 3) << seed << " view " << i;
      EXPECT_THAT(chosen.rejected, HasSubstr(i < 3 ? "where the other views put it" : ""));
    }
  }
}

TEST(FirstGuess, ViewsTogetherChooseAmongCandidates) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    Made made(3000 + seed);
    const Rigid3 truth = made.AnyCamera();
    auto session = made.Session(truth, 6);
    const Rigid3 door = made.AnyBoard();  // stands where it is in every view, and looks better
    for (ViewDetection& view : session) {
      view.cloud.candidates.insert(view.cloud.candidates.begin(), made.Candidate(door));
    }
    const FirstGuess guess = Guess(session);
    ASSERT_TRUE(guess.camera_from_lidar) << seed << ": " << guess.detail;
    for (const ViewDetection& view : session) {
      EXPECT_EQ(ChooseCandidate(CameraViewOf("rgb", view), *guess.camera_from_lidar).candidate, 1)
          << seed;
    }
  }
}

TEST(FirstGuess, SaysSoWhenTwoAnswersFitAlike) {
  Made made(7);
  const Rigid3 truth = made.AnyCamera();
  const Rigid3 board = made.AnyBoard();
  std::vector<ViewDetection> session;
  for (int i = 0; i < 4; ++i) session.push_back(made.View(truth, board));
  const FirstGuess guess = Guess(session);
  EXPECT_FALSE(guess.camera_from_lidar);
  EXPECT_THAT(guess.detail, HasSubstr("fit the views alike"));
}

TEST(FirstGuess, MirroredImagesAreNamed) {
  Made made(8);
  auto session = made.Session(made.AnyCamera(), 8);
  for (ViewDetection& view : session) {
    Rigid3& pose = view.images[0].edges->pose->sensor_from_target;
    const Eigen::Vector3d mirror(-1, 1, 1);
    const Eigen::Matrix3d r = mirror.asDiagonal() * pose.rotation.toRotationMatrix() *
                              Eigen::Matrix3d(mirror.asDiagonal());
    pose = {Eigen::Quaterniond(r), mirror.asDiagonal() * pose.translation};
  }
  const FirstGuess guess = Guess(session);
  EXPECT_FALSE(guess.camera_from_lidar);
  EXPECT_THAT(guess.detail, HasSubstr("mirrored"));
}

TEST(FirstGuess, ViewsThatDoNotBelongTogetherGiveNone) {
  Made made(9);
  std::vector<ViewDetection> session;
  for (int i = 0; i < 7; ++i) session.push_back(made.View(made.AnyCamera(), made.AnyBoard()));
  const FirstGuess guess = Guess(session);
  EXPECT_FALSE(guess.camera_from_lidar);
  EXPECT_THAT(guess.detail, HasSubstr("do not agree"));
  EXPECT_THAT(guess.detail, HasSubstr("as the rig file says"));
  EXPECT_THAT(GuessFromBoards({}).detail, HasSubstr("0 views"));
}

// As where the board stands on a table, and a window of its size is in every cloud.
TEST(FirstGuess, ThingsThatStandInEveryCloudAreNotTakenForABoardOfAnotherSize) {
  Made made(11);
  const Rigid3 truth = made.AnyCamera();
  auto session = made.Session(truth, 6);
  const Rigid3 window = made.AnyBoard(), door = made.AnyBoard();
  for (std::size_t i = 0; i < session.size(); ++i) {
    auto& candidates = session[i].cloud.candidates;
    if (i > 0) candidates.clear();  // one is found
    candidates.push_back(made.Candidate(window));
    if (i % 2 == 0) candidates.push_back(made.Candidate(door));
  }
  const FirstGuess guess = Guess(session);
  EXPECT_FALSE(guess.camera_from_lidar);
  EXPECT_THAT(guess.detail, HasSubstr("in 5 clouds all that looks like the board stands where it"));
  EXPECT_THAT(guess.detail, Not(HasSubstr("as the rig file says")));
}

// Three shots a place, whose images belong to other clouds.
TEST(FirstGuess, ABoardThatWasLeftWhereItStoodIsNoThingOfTheRoom) {
  Made made(12);
  std::vector<ViewDetection> session;
  for (int place = 0; place < 3; ++place) {
    const Rigid3 board = made.AnyBoard();
    for (int shot = 0; shot < 3; ++shot) session.push_back(made.View(made.AnyCamera(), board));
  }
  EXPECT_THAT(Guess(session).detail, HasSubstr("as the rig file says"));
}

TEST(FirstGuess, FindsWhatTheRangesAreOffBy) {
  Made made(10);
  const Rigid3 truth = made.AnyCamera();
  std::vector<ViewDetection> session;
  for (int i = 0; i < 12; ++i) {
    const Rigid3 board = made.AnyBoard();
    session.push_back(made.View(truth, board));
    Rigid3& seen = session.back().cloud.candidates[0].pose->sensor_from_target;
    seen.translation += 0.03 * seen.translation.normalized();  // measured 30 mm too long
  }
  FirstGuessOptions options;
  options.range_offset_sigma_m = kRangeOffsetSigmaM;
  const FirstGuess guess = Guess(session, options);
  ASSERT_TRUE(guess.camera_from_lidar);
  EXPECT_GT(guess.range_offset_sigma_m, 0);
  EXPECT_LT(guess.range_offset_sigma_m, 0.02);
  EXPECT_NEAR(guess.range_offset_m, -0.03, 3.5 * guess.range_offset_sigma_m);
}

TEST(FirstGuess, WithoutPosesAViewStaysAsItIs) {
  Made made(11);
  ViewDetection view = made.View(made.AnyCamera(), made.AnyBoard());
  view.cloud.candidates[0].pose.reset();
  const CameraView same = WithChosenCandidate(CameraViewOf("rgb", view), made.AnyCamera());
  EXPECT_TRUE(same.usable());
  EXPECT_TRUE(same.cloud);
}

TEST(FirstGuess, OptionsAreChecked) {
  FirstGuessOptions options;
  options.range_offset_sigma_m = -1;
  EXPECT_THROW(GuessFromBoards({}, options), InputError);
}

}  // namespace
}  // namespace rgbdt
