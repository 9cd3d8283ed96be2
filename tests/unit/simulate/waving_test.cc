#include "calib/simulate/waving.h"

#include <opencv2/core.hpp>

#include "calib/model/errors.h"
#include "tests/unit/matchers.h"

namespace rgbdt::simulate {
namespace {

Options Small() {
  Options options;
  options.seed = 5;
  UseLidar(16, &options);
  options.cameras = {DefaultThermalCamera()};
  options.cameras[0].netd_k = 0;
  options.supersampling = 2;
  return options;
}

TEST(WavingTest, EachPointIsOnTheBoardAsItWasAtItsTime) {
  Options options = Small();
  options.spinning->range_sigma_m = 1e-9;
  const WaveOptions wave;
  const Waving waving(options, wave, {{}});
  const Utime start = wave.start + 3 * kMicrosecondsPerSecond;
  const Cloud sweep = waving.Sweep(start);
  int on = 0;
  double of_one_time = 0;  // how far they are off where the board is taken to stand
  for (std::size_t i = 0; i < sweep.size(); ++i) {
    if (!sweep.IsHit(i)) continue;
    const Eigen::Vector3d place =
        waving.LidarFromTarget(sweep.utime[i]).Inverse() * sweep.points[i].cast<double>();
    if (std::abs(place.x()) > 0.55 || std::abs(place.y()) > 0.4 || std::abs(place.z()) > 0.2) {
      continue;
    }
    EXPECT_LT(std::abs(place.z()), 2e-3);  // a beam has a width
    const Eigen::Vector3d stood =
        waving.LidarFromTarget(start).Inverse() * sweep.points[i].cast<double>();
    of_one_time = std::max(of_one_time, std::abs(stood.z()));
    ++on;
  }
  EXPECT_GT(on, 200);
  EXPECT_GT(of_one_time, 0.005);
}

TEST(WavingTest, ARollingShutterMovesRowsOfABoardThatMovesOnly) {
  const Options options = Small();
  WaveOptions wave;
  const Utime utime = wave.start + 2 * kMicrosecondsPerSecond;
  ClockOptions rolling;
  rolling.rolling_s = 0.03;
  const auto image = [&](const ClockOptions& clock) {
    return Waving(options, wave, {clock}).TakeImage("thermal", utime).pixels;
  };
  EXPECT_GT(cv::norm(image({}), image(rolling), cv::NORM_INF), 20);
  wave.reach_m.setZero();
  wave.turn_rad.setZero();
  EXPECT_EQ(cv::norm(image({}), image(rolling), cv::NORM_INF), 0);
}

TEST(WavingTest, CornersLieWhereTheirRowsSeeThem) {
  const Options options = Small();
  const WaveOptions wave;
  const Utime utime = wave.start + 4 * kMicrosecondsPerSecond;
  ClockOptions rolling;
  rolling.rolling_s = 0.02;
  const auto rolled = Waving(options, wave, {rolling}).Corners("thermal", utime);
  ASSERT_FALSE(rolled.empty());
  for (std::size_t i = 0; i < rolled.size(); ++i) {
    const Utime seen = utime + FromSeconds(0.02 * (rolled[i].y() / 479 - 0.5));
    const auto still = Waving(options, wave, {{}}).Corners("thermal", seen);
    ASSERT_FALSE(still.empty());
    EXPECT_LT((still[i] - rolled[i]).norm(), 1e-3);
  }
}

TEST(WavingTest, ACamerasClockIsOffDriftsAndJumps) {
  ClockOptions clock;
  clock.offset_s = 0.1;
  clock.drift = 1e-3;
  clock.jump_s = 0.02;
  clock.jump_at_s = 5;
  const WaveOptions wave;
  const Waving waving(Small(), wave, {clock});
  EXPECT_EQ(waving.CameraUtime("thermal", wave.start), wave.start - 100'000);
  const Utime later = wave.start + 10 * kMicrosecondsPerSecond;
  EXPECT_EQ(waving.CameraUtime("thermal", later), later - 130'000);
}

TEST(WavingTest, ClocksAreDrawnFromTheSeed) {
  Options options = Small();
  options.cameras = {DefaultColorCamera(), DefaultThermalCamera()};
  const auto clocks = DrawClocks(options);
  ASSERT_EQ(clocks.size(), 2U);
  EXPECT_NE(clocks[0].offset_s, clocks[1].offset_s);
  EXPECT_GE(clocks[0].rolling_s, 0.010);
  EXPECT_EQ(clocks[1].rolling_s, 0) << "a thermal camera's are all at once";
  EXPECT_EQ(DrawClocks(options)[0].offset_s, clocks[0].offset_s);
  ++options.seed;
  EXPECT_NE(DrawClocks(options)[0].offset_s, clocks[0].offset_s);
  EXPECT_THAT(ClocksText(options, clocks), testing::HasSubstr("rgb: time_offset_s "));
}

TEST(WavingTest, RefusesATurnedScannerAndClocksThatAreMissing) {
  Options options = Small();
  EXPECT_THROW(Waving(options, {}, {}), InputError);
  options.spinning.reset();
  EXPECT_THROW(Waving(options, {}, {{}}), InputError);
}

}  // namespace
}  // namespace rgbdt::simulate
