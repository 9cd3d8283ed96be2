#include "services/drivers/camera/shutter_watch.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace rgbdt {
namespace {

constexpr Utime kFrame = 33'333;

// 14 bit counts at 30 Hz: a scene of 400 counts' spread, or the shutter's flat face; 3 counts of
// noise in both.
class Core {
 public:
  cv::Mat Scene() { return WithNoise(scene_); }
  cv::Mat Shutter() { return WithNoise(cv::Mat(48, 64, CV_16UC1, cv::Scalar(8200))); }
  Core() : scene_(48, 64, CV_16UC1) {
    for (int row = 0; row < scene_.rows; ++row) scene_.row(row).setTo(7500 + 29 * row);
  }

 private:
  cv::Mat WithNoise(const cv::Mat& clean) {
    cv::Mat noise(clean.size(), CV_16SC1);
    random_.fill(noise, cv::RNG::NORMAL, 0, 3);
    cv::Mat noisy;
    cv::add(clean, noise, noisy, cv::noArray(), CV_16UC1);
    return noisy;
  }
  cv::Mat scene_;
  cv::RNG random_{1};
};

class ShutterWatchTest : public ::testing::Test {
 protected:
  bool Add(const cv::Mat& frame) { return watch_.Add(frame, now_ += kFrame); }
  Core core_;
  ShutterWatch watch_;
  Utime now_ = 1'500'000'000'000'000;
};

TEST_F(ShutterWatchTest, AStillSceneIsNotAShutter) {
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(Add(core_.Scene())) << i;
}

TEST_F(ShutterWatchTest, AFrozenPictureIsFlaggedFromItsFirstRepetitionUntilItHasSettled) {
  for (int i = 0; i < 10; ++i) Add(core_.Scene());
  const cv::Mat frozen = core_.Scene();
  EXPECT_FALSE(Add(frozen));
  for (int i = 0; i < 15; ++i) EXPECT_TRUE(Add(frozen.clone()));
  int flagged = 0;
  for (int i = 0; i < 30; ++i) flagged += Add(core_.Scene()) ? 1 : 0;
  EXPECT_EQ(flagged, ShutterWatch::kSettle / kFrame);
}

TEST_F(ShutterWatchTest, ASlowCoresRepeatedFramesAreUsed) {
  int flagged = 0;
  for (int i = 0; i < 100; ++i) {
    const cv::Mat picture = core_.Scene();
    for (int k = 0; k < 4; ++k) flagged += Add(picture.clone()) && i >= 15 ? 1 : 0;
  }
  EXPECT_EQ(flagged, 0);
  const cv::Mat frozen = core_.Scene();
  for (int k = 0; k < 15; ++k) flagged += Add(frozen.clone()) ? 1 : 0;
  EXPECT_EQ(flagged, 11) << "from when it ought to have changed";
}

TEST_F(ShutterWatchTest, WhatStandsForLongIsNoCorrection) {
  const cv::Mat still = core_.Scene();
  const Utime begun = now_;
  while (now_ - begun < ShutterWatch::kLongest + ShutterWatch::kSettle + kFrame) Add(still.clone());
  for (int i = 0; i < 30; ++i) EXPECT_FALSE(Add(still.clone()));
}

TEST_F(ShutterWatchTest, TheShuttersFaceIsFlagged) {
  for (int i = 0; i < 10; ++i) Add(core_.Scene());
  for (int i = 0; i < 15; ++i) EXPECT_TRUE(Add(core_.Shutter()));
  for (int i = 0; i < 10; ++i) Add(core_.Scene());
  EXPECT_FALSE(Add(core_.Scene()));
}

}  // namespace
}  // namespace rgbdt
