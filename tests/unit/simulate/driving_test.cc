#include "calib/simulate/driving.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <opencv2/core.hpp>

#include "calib/model/errors.h"
#include "calib/simulate/internal/natural_scene.h"
#include "calib/simulate/internal/spinning.h"
#include "calib/simulate/internal/world.h"
#include "tests/simulated_variants.h"

namespace rgbdt::simulate {
namespace {

Options SmallRig(Scene scene) {
  Options options = OneCamera(3, 16, 160);
  options.scene = scene;
  return options;
}

// The share of hits of `column` that are as far as in a sweep of a rig that stands at `pose`.
double ShareAsFar(const Cloud& sweep, int column, const World& world, const Options& options,
                  const Rigid3& pose) {
  const Cloud still = SpinningSweep(world, *options.spinning, options.seed, 0, 0, pose);
  int hits = 0, same = 0;
  for (int ring = 0; ring < sweep.lines; ++ring) {
    const auto i = static_cast<std::size_t>(ring) * static_cast<std::size_t>(sweep.beams) +
                   static_cast<std::size_t>(column);
    if (!sweep.IsHit(i) || !still.IsHit(i)) continue;
    ++hits;
    const double apart = std::abs(sweep.points[i].norm() - still.points[i].norm());
    same += apart < 5 * std::sqrt(2.0) * options.spinning->range_sigma_m ? 1 : 0;
  }
  EXPECT_GE(hits, 8);
  return static_cast<double>(same) / hits;
}

TEST(DrivingTest, EachColumnIsSeenFromWhereTheRigIsThen) {
  Options options = SmallRig(Scene::kIndoor);
  Driving driving(options, 2);
  const Utime begin = Driving::kStart + 3 * kMicrosecondsPerSecond;
  const Cloud sweep = driving.Sweep(begin);
  options.natural.on = true;
  options.natural.people = 0;
  const World world(std::make_shared<SceneModel>(MakeNaturalWorld(options, 0)), std::nullopt,
                    options);
  const int last = sweep.beams - 1;
  const Utime end = sweep.utime[static_cast<std::size_t>(last)];
  EXPECT_NEAR(ToSeconds(end - begin), options.spinning->revolution_s, 0.002);
  EXPECT_GE(ShareAsFar(sweep, 0, world, options, driving.WorldFromLidar(begin)), 0.9);
  EXPECT_GE(ShareAsFar(sweep, last, world, options, driving.WorldFromLidar(end)), 0.9);
  EXPECT_LE(ShareAsFar(sweep, last, world, options, driving.WorldFromLidar(begin)), 0.5);
}

TEST(DrivingTest, ImagesAreTakenOnTheWay) {
  Driving driving(SmallRig(Scene::kOutdoor), 3), again(SmallRig(Scene::kOutdoor), 3);
  const Image first = driving.TakeImage("rgb", Driving::kStart);
  const Image later = driving.TakeImage("rgb", Driving::kStart + 5 * kMicrosecondsPerSecond);
  EXPECT_GT(cv::norm(first.pixels, later.pixels, cv::NORM_L1) / first.pixels.total(), 5);
  // In any order.
  const Image same = again.TakeImage("rgb", later.utime);
  EXPECT_EQ(cv::norm(later.pixels, same.pixels, cv::NORM_INF), 0);
  EXPECT_EQ(driving.rig().Camera("rgb").width, 160);
  EXPECT_EQ(driving.truth().camera_from_lidar.count("rgb"), 1U);
}

// Each row is that of an image which was all taken then.
TEST(DrivingTest, RowsOfARollingShutterAreSeenFromWhereTheRigIsThen) {
  const Options options = SmallRig(Scene::kIndoor);
  ClockOptions clock;
  clock.offset_s = 0.04;
  clock.rolling_s = 0.4;
  Driving driving(options, 1), rolling(options, 1, {clock});
  const Utime utime = Driving::kStart + 2 * kMicrosecondsPerSecond;
  const Image rolled = rolling.TakeImage("rgb", utime);
  EXPECT_EQ(rolled.utime, utime - 40'000);
  const int height = rolled.pixels.rows;
  for (const int row : {0, height / 2, height - 1}) {
    const double later = 0.4 * (static_cast<double>(row) / (height - 1) - 0.5);
    const auto apart = [&](Utime at) {
      return cv::norm(rolled.pixels.row(row), driving.TakeImage("rgb", at).pixels.row(row),
                      cv::NORM_L1) /
             rolled.pixels.cols;
    };
    const double then = apart(utime + FromSeconds(later));
    EXPECT_LT(then, 4) << row << ": but for noise, and edges of the rows beside it";
    if (row == height / 2) continue;
    EXPECT_GT(apart(utime), 2 * then) << row;
  }
}

TEST(DrivingTest, RefusesATurnedScannerAndTheNight) {
  Options turned = SmallRig(Scene::kOutdoor);
  turned.spinning.reset();
  EXPECT_THROW(Driving(turned, 1), InputError);
  EXPECT_THROW(Driving(SmallRig(Scene::kNight), 1), InputError);
}

}  // namespace
}  // namespace rgbdt::simulate
