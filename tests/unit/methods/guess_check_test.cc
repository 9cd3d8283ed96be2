#include "calib/methods/internal/guess_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/numbers.h"

namespace rgbdt {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

// A camera that looks along the LIDAR's x: its axes are x right, y down, z forward.
Rigid3 Result() { return {Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5), {0.1, -0.2, 0.05}}; }

CameraSpec Guessed(const Rigid3& guess) {
  CameraSpec camera;
  camera.name = "rgb";
  camera.camera_from_lidar_guess = guess;
  return camera;
}

TEST(GuessCheck, AGuessAsWrongAsThePapersIsNoMistake) {
  EXPECT_THAT(WhyGuessIsOff(CameraSpec(), Result()), IsEmpty());
  EXPECT_THAT(WhyGuessIsOff(Guessed(Result()), Result()), IsEmpty());
  const Rigid3 turned = RotationAbout({0, 0, 1}, 40 * kDegree) * Result();
  EXPECT_THAT(WhyGuessIsOff(Guessed(turned), Result()), IsEmpty());
}

TEST(GuessCheck, AnInvertedGuessIsNamed) {
  const Rigid3 rough = RotationAbout({0, 1, 0}, 10 * kDegree) * Result();
  const std::string why = WhyGuessIsOff(Guessed(rough.Inverse()), Result());
  EXPECT_THAT(why, HasSubstr("camera_from_lidar_guess of rgb"));
  EXPECT_THAT(why, HasSubstr("it seems to be lidar_from_camera"));
}

TEST(GuessCheck, AGuessThatIsFarBothWaysIsNotCalledInverted) {
  const Rigid3 far = RotationAbout({1, 0, 0}, 90 * kDegree) * Result();
  const std::string why = WhyGuessIsOff(Guessed(far), Result());
  EXPECT_THAT(why, HasSubstr("90 deg"));
  EXPECT_THAT(why, Not(HasSubstr("lidar_from_camera")));
  Rigid3 away = Result();
  away.translation.x() += 0.6;
  EXPECT_THAT(WhyGuessIsOff(Guessed(away), Result()), HasSubstr("600 mm"));
}

}  // namespace
}  // namespace rgbdt
