#include "viewer/live/wave_history.h"

#include <gtest/gtest.h>

namespace rgbdt::viewer {
namespace {

WaveProgress Recording(double left_s, std::optional<double> sigma_s) {
  WaveProgress progress;
  progress.phase = WavePhase::kRecording;
  progress.left_s = left_s;
  progress.text = "wave";
  WavedClock& clock = progress.clocks.emplace_back();
  clock.camera = "rgb";
  if (sigma_s) clock.time_offset_s = {-0.012, *sigma_s};
  return progress;
}

TEST(WaveHistory, KeepsHowTheSigmaFell) {
  WaveHistory history;
  history.Add(WaveProgress(), 100);
  EXPECT_EQ(history.Frame().at("phase"), "waiting");
  history.Add(Recording(20, {}), 110);
  EXPECT_TRUE(history.Frame().at("cameras")[0].at("sigma_ms").is_null());
  history.Add(Recording(17, 0.002), 113);
  history.Add(Recording(16, 0.002), 114);  // no new solve
  history.Add(Recording(14, 0.001), 116);
  const nlohmann::json frame = history.Frame();
  EXPECT_EQ(frame.at("type"), "wave");
  EXPECT_EQ(frame.at("phase"), "recording");
  EXPECT_EQ(frame.at("left_s"), 14);
  EXPECT_DOUBLE_EQ(frame.at("cameras")[0].at("offset_ms"), -12);
  EXPECT_DOUBLE_EQ(frame.at("cameras")[0].at("sigma_ms"), 1);
  const nlohmann::json& steps = frame.at("steps");
  ASSERT_EQ(steps.size(), 2U);
  EXPECT_EQ(steps[0].at("seconds"), 3);
  EXPECT_EQ(steps[1].at("seconds"), 6);
  EXPECT_EQ(steps[1].at("cameras")[0].at("camera"), "rgb");
  EXPECT_DOUBLE_EQ(steps[1].at("cameras")[0].at("sigma_ms"), 1);
}

// So that a chart's seconds grow, whatever comes.
TEST(WaveHistory, KeepsOneStepASecondAndNoMoreThanItMay) {
  WaveHistory history;
  for (int i = 0; i < 5000; ++i) history.Add(Recording(20, 1.0 / (1 + i)), 100 + 0.2 * i);
  const nlohmann::json steps = history.Frame().at("steps");
  ASSERT_EQ(steps.size(), WaveHistory::kKept);
  for (std::size_t i = 1; i < steps.size(); ++i) {
    EXPECT_EQ(steps[i].at("seconds"), steps[i - 1].at("seconds").get<int>() + 1);
  }
}

TEST(WaveHistory, AnotherWaveBeginsAnew) {
  WaveHistory history;
  history.Add(Recording(10, 0.001), 100);
  WaveProgress done = Recording(0, 0.0005);
  done.phase = WavePhase::kDone;
  history.Add(done, 120);
  EXPECT_EQ(history.Frame().at("phase"), "done");
  EXPECT_EQ(history.Frame().at("steps").size(), 1U) << "by seconds of waving";
  history.Add(Recording(20, {}), 200);
  EXPECT_EQ(history.Frame().at("phase"), "recording");
  EXPECT_TRUE(history.Frame().at("steps").empty());
}

TEST(WaveHistory, SaysThatItWentWithoutAWord) {
  WaveHistory history;
  EXPECT_FALSE(history.Update(1000)) << "there was none";
  history.Add(Recording(10, 0.001), 1000);
  EXPECT_FALSE(history.Update(1000 + WaveHistory::kGone - 1));
  EXPECT_TRUE(history.Update(1000 + WaveHistory::kGone));
  EXPECT_EQ(history.Frame().at("phase"), "failed");
  EXPECT_FALSE(history.Update(2000)) << "that was told";
  history.Add(Recording(9, 0.0009), 2001);
  EXPECT_EQ(history.Frame().at("phase"), "recording");
  EXPECT_EQ(history.Frame().at("steps").size(), 2U) << "the same wave";
  WaveProgress done;
  done.phase = WavePhase::kDone;
  history.Add(done, 2002);
  EXPECT_FALSE(history.Update(3000)) << "it was over";
}

}  // namespace
}  // namespace rgbdt::viewer
