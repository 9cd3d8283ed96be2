#include "calib/fuse/sweep_fuser.h"

#include <cmath>

#include "tests/numbers.h"
#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::SizeIs;

// A wall 5 m ahead, x = 5 in the map, painted in waves.
double PaintAt(const Eigen::Vector3d& in_map) {
  return 128 + 50 * std::sin(2 * in_map.y()) + 50 * std::cos(1.7 * in_map.z());
}

CameraSpec SpecOf(double rolling_s) {
  CameraSpec spec;
  spec.name = "rgb";
  spec.width = 320;
  spec.height = 240;
  spec.lens = {Lens::Model::kPinhole, 200, 200, 159.5, 119.5, {}};
  spec.readout_s = 0.02;
  spec.rolling_s = rolling_s;
  return spec;
}

Rigid3 CameraFromLidar() {
  Rigid3 pose;  // x forward, y left, z up becomes z forward, x right, y down
  pose.rotation = Eigen::Quaterniond((Eigen::Matrix3d() << 0, -1, 0, 0, 0, -1, 1, 0, 0).finished());
  pose.translation = {0.1, 0.05, 0};
  return pose;
}

CameraCalibration At(const Rigid3& camera_from_lidar) {
  return {"rgb", camera_from_lidar, std::nullopt, SolveStatus::kConverged, ""};
}

// A rig that slides 1 m/s to the left and turns to it, too, or stands.
struct Drive {
  bool moves = true;

  Rigid3 MapFromLidar(Utime utime) const {
    const double t = moves ? ToSeconds(utime - kNow) : 0;
    Rigid3 pose = RotationAbout(Eigen::Vector3d::UnitZ(), 0.15 * t);
    pose.translation = {0.1 * t, t - 0.5, 0};
    return pose;
  }
};

StampedPose PoseAt(const Drive& drive, Utime utime) {
  return {0, utime, "test", drive.MapFromLidar(utime)};
}

// What the camera sees of the wall: each row from where it is exposed.
PreparedImage Photograph(const Drive& drive, const CameraSpec& spec, Utime utime) {
  cv::Mat image(spec.height, spec.width, CV_8UC3);
  const Camera camera(spec);
  for (int v = 0; v < spec.height; ++v) {
    const double part = static_cast<double>(v) / (spec.height - 1) - 0.5;
    const Rigid3 map_from_camera = drive.MapFromLidar(utime + FromSeconds(part * spec.rolling_s)) *
                                   CameraFromLidar().Inverse();
    for (int u = 0; u < spec.width; ++u) {
      const Eigen::Vector3d ray = map_from_camera.rotation * *camera.Unproject({u, v});
      const double range = (5 - map_from_camera.translation.x()) / ray.x();
      image.at<cv::Vec3b>(v, u) = cv::Vec3b::all(static_cast<std::uint8_t>(
          std::lround(PaintAt(map_from_camera.translation + range * ray))));
    }
  }
  return {utime, image, {}};
}

// A line of the scanner at an azimuth; its beams 0.1 ms apart, each from where the rig is then.
Cloud LineAt(const Drive& drive, Utime sweep, int line, Utime utime, double azimuth) {
  constexpr int kBeams = 40;
  Cloud cloud;
  cloud.sweep_utime = sweep;
  cloud.first_line = line;
  cloud.lines = 1;
  cloud.beams = kBeams;
  const int middle = kBeams / 2;
  for (int beam = 0; beam < kBeams; ++beam) {
    const double elevation = 0.01 * (beam - middle);
    const Eigen::Vector3d ray(std::cos(azimuth), std::sin(azimuth), std::tan(elevation));
    const Utime t = utime + 100 * beam;
    const Rigid3 map_from_lidar = drive.MapFromLidar(t);
    const Eigen::Vector3d in_map = map_from_lidar.rotation * ray;
    const double range = (5 - map_from_lidar.translation.x()) / in_map.x();
    cloud.points.emplace_back((range * ray).cast<float>());
    cloud.utime.push_back(t);
  }
  return cloud;
}

// A second of 50 lines with images at 10 Hz and poses at 50 Hz, in the order in which they come.
struct Session {
  std::vector<RgbdtCloud> chunks, parts;
  FusionCounts counts;
};

Session Drove(const Drive& drive, const CameraSpec& spec, bool with_poses) {
  SweepFuser fuser({spec}, 0.005);
  fuser.SetCalibration(0, At(CameraFromLidar()), kNow - kSecond);
  Session session;
  if (with_poses) fuser.AddPose(PoseAt(drive, kNow - 200'000));
  for (Utime t = -180'000; t <= kSecond; t += 20'000) {
    if (with_poses) fuser.AddPose(PoseAt(drive, kNow + t));
    if (t % 100'000 == 0) fuser.camera(0).AddImage(Photograph(drive, spec, kNow + t));
    if (t < 0) continue;
    const int line = static_cast<int>(t / 20'000);
    session.chunks.push_back(
        fuser.FuseChunk(LineAt(drive, kNow, line, kNow + t, 0.3 - 0.012 * line)));
  }
  session.parts = fuser.EndSweep();
  session.counts = fuser.counts();
  return session;
}

// Largest error of colour, and of place in the map where the message says where it was.
struct Worst {
  double colour = 0, metres = 0;
  int coloured = 0, points = 0;
};

Worst WorstOf(const Drive& drive, const std::vector<RgbdtCloud>& clouds) {
  Worst worst;
  for (const RgbdtCloud& cloud : clouds) {
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const Rigid3 map_from_lidar =
          cloud.map_from_lidar ? *cloud.map_from_lidar : drive.MapFromLidar(cloud.utime[i]);
      const Eigen::Vector3d in_map = map_from_lidar * cloud.points[i].cast<double>();
      worst.metres = std::max(worst.metres, std::abs(in_map.x() - 5));
      ++worst.points;
      if (cloud.valid[i] == 0) continue;
      ++worst.coloured;
      worst.colour = std::max(worst.colour, std::abs(cloud.rgb[i][1] - PaintAt(in_map)));
    }
  }
  return worst;
}

// Twice the focal length: what is left of the middle is seen twice as far left of it.
TEST(FusionCamera, HasTheLensThatBelongsToItsPose) {
  FusionCamera camera(SpecOf(0));
  CameraCalibration found = At(CameraFromLidar());
  EXPECT_FALSE(camera.Has(found, 1));
  camera.SetCalibration(found, 1);
  EXPECT_TRUE(camera.Has(found, 1));
  const Eigen::Vector3d left(-0.1, 0, 1);
  const double by_rig = camera.camera().Project(left)->x() - 159.5;
  found.lens.emplace().lens = SpecOf(0).lens;
  found.lens->lens.fx *= 2;
  EXPECT_FALSE(camera.Has(found, 1));
  camera.SetCalibration(found, 1);
  EXPECT_TRUE(camera.Has(found, 1));
  EXPECT_NEAR(camera.camera().Project(left)->x() - 159.5, 2 * by_rig, 1e-9);
  found.lens.reset();
  camera.SetCalibration(found, 1);
  EXPECT_EQ(camera.spec().lens, SpecOf(0).lens);
}

TEST(SweepFuser, ARigThatStandsNeedsNoPoses) {
  const Drive still{false};
  const Session session = Drove(still, SpecOf(0), false);
  for (const auto& clouds : {session.chunks, session.parts}) {
    const Worst worst = WorstOf(still, clouds);
    EXPECT_EQ(worst.points, 51 * 40);
    EXPECT_EQ(worst.coloured, worst.points);
    EXPECT_LT(worst.colour, 2);
  }
  EXPECT_FALSE(session.chunks[3].map_from_lidar);
}

class Moving : public testing::TestWithParam<double> {};

TEST_P(Moving, PosesTakeTheMotionOutOfCloudAndImages) {
  const Drive drive;
  const Session session = Drove(drive, SpecOf(GetParam()), true);
  for (const auto& clouds : {session.chunks, session.parts}) {
    const Worst worst = WorstOf(drive, clouds);
    EXPECT_EQ(worst.coloured, worst.points);
    EXPECT_LT(worst.colour, 3);
    EXPECT_LT(worst.metres, 1e-3);
  }
  EXPECT_EQ(session.counts.without_pose, 0);
  ASSERT_THAT(session.parts, SizeIs(1));
  EXPECT_EQ(session.parts[0].frame_utime, kNow);
  EXPECT_EQ(session.chunks[7].frame_utime, kNow + 7 * 20'000);
  // The check can fail: taken as standing, the same is plainly wrong.
  EXPECT_GT(WorstOf(drive, Drove(drive, SpecOf(GetParam()), false).chunks).colour, 10);
}

INSTANTIATE_TEST_SUITE_P(RollingSeconds, Moving, testing::Values(0.0, 0.06));

TEST(SweepFuser, ARollingCameraTakenForAGlobalOneIsWrong) {
  const Drive drive;
  const CameraSpec rolls = SpecOf(0.1);
  SweepFuser fuser({SpecOf(0)}, 0.005);
  fuser.SetCalibration(0, At(CameraFromLidar()), 1);
  for (Utime t = -100'000; t <= 100'000; t += 20'000) fuser.AddPose(PoseAt(drive, kNow + t));
  fuser.camera(0).AddImage(Photograph(drive, rolls, kNow - 30'000));
  EXPECT_GT(WorstOf(drive, {fuser.FuseChunk(LineAt(drive, kNow, 0, kNow, 0.1))}).colour, 2.5);
}

TEST(SweepFuser, WhereThePosesDoNotTellNothingIsColoured) {
  const Drive drive;
  const CameraSpec spec = SpecOf(0);
  SweepFuser fuser({spec}, 0.005);
  fuser.SetCalibration(0, At(CameraFromLidar()), 1);
  fuser.AddPose(PoseAt(drive, kNow - kSecond));
  fuser.AddPose(PoseAt(drive, kNow - kSecond + 20'000));  // and then no more
  fuser.camera(0).AddImage(Photograph(drive, spec, kNow - 100'000));
  const Cloud line = LineAt(drive, kNow, 0, kNow, 0);
  const RgbdtCloud fused = fuser.FuseChunk(line);
  EXPECT_THAT(fused.valid, Each(0U));
  EXPECT_FALSE(fused.map_from_lidar);
  EXPECT_EQ(fused.points, line.points);
  EXPECT_EQ(fuser.counts().without_pose, 40);
  EXPECT_THAT(fuser.EndSweep(), SizeIs(0));
}

TEST(SweepFuser, PosesThatBeginWithinASweepServeFromThenOn) {
  const Drive drive;
  const CameraSpec spec = SpecOf(0);
  SweepFuser fuser({spec}, 0.005);
  fuser.SetCalibration(0, At(CameraFromLidar()), 1);
  fuser.camera(0).AddImage(Photograph(drive, spec, kNow - 50'000));
  EXPECT_FALSE(fuser.FuseChunk(LineAt(drive, kNow, 0, kNow, 0)).map_from_lidar);
  for (Utime t = -100'000; t <= 100'000; t += 20'000) fuser.AddPose(PoseAt(drive, kNow + t));
  const RgbdtCloud fused = fuser.FuseChunk(LineAt(drive, kNow, 4, kNow + 80'000, 0.05));
  ASSERT_TRUE(fused.map_from_lidar);
  EXPECT_THAT(fused.valid, Each(1U));
  EXPECT_LT(WorstOf(drive, {fused}).metres, 1e-3);
  const auto parts = fuser.EndSweep();
  ASSERT_THAT(parts, SizeIs(1));
  EXPECT_EQ(parts[0].size(), 40U) << "of one frame only";
}

TEST(SweepFuser, AfterAJumpTheStreamGoesOn) {
  const Drive drive;
  const CameraSpec spec = SpecOf(0);
  SweepFuser fuser({spec}, 0.005);
  fuser.SetCalibration(0, At(CameraFromLidar()), 1);
  for (Utime t = -100'000; t <= 0; t += 20'000) fuser.AddPose(PoseAt(drive, kNow + t));
  fuser.camera(0).AddImage(Photograph(drive, spec, kNow - 50'000));
  fuser.FuseChunk(LineAt(drive, kNow, 0, kNow, 0));
  // From here on the map's origin is elsewhere.
  const auto elsewhere = [&](Utime utime) {
    StampedPose pose = PoseAt(drive, utime);
    pose.map_from_lidar.translation.z() += 30;
    return pose;
  };
  EXPECT_EQ(fuser.AddPose(elsewhere(kNow + 20'000)), PoseTrack::Added::kJump);
  for (Utime t = 40'000; t <= 200'000; t += 20'000) fuser.AddPose(elsewhere(kNow + t));
  // Taken before the jump: of no known place. Then one from after it.
  EXPECT_THAT(fuser.FuseChunk(LineAt(drive, kNow, 5, kNow + 100'000, 0)).valid, Each(0U));
  fuser.camera(0).AddImage(Photograph(drive, spec, kNow + 120'000));
  const RgbdtCloud after = fuser.FuseChunk(LineAt(drive, kNow, 8, kNow + 160'000, 0));
  EXPECT_THAT(after.valid, Each(1U));
  ASSERT_TRUE(after.map_from_lidar);
  EXPECT_NEAR(after.map_from_lidar->translation.z(), 30, 0.01);
}

TEST(SweepFuser, NoMessageMixesCalibrations) {
  const Drive still{false};
  const CameraSpec spec = SpecOf(0);
  SweepFuser fuser({spec}, 0.005);
  fuser.SetCalibration(0, At(CameraFromLidar()), 1);
  fuser.camera(0).AddImage(Photograph(still, spec, kNow - 100'000));
  for (int line = 0; line < 3; ++line) {
    fuser.FuseChunk(LineAt(still, kNow, line, kNow + line * 20'000, 0.01 * line));
  }
  EXPECT_THAT(fuser.SetCalibration(0, At(CameraFromLidar()), 1), SizeIs(0)) << "the same once more";
  const auto parts =
      fuser.SetCalibration(0, At(Exp(Vector6d::Constant(0.01)) * CameraFromLidar()), 2);
  ASSERT_THAT(parts, SizeIs(1));
  EXPECT_THAT(parts[0].calibration_utime, ElementsAre(1));
  EXPECT_EQ(parts[0].size(), 120U);
  EXPECT_FALSE(parts[0].sweep_end);
  const RgbdtCloud chunk = fuser.FuseChunk(LineAt(still, kNow, 3, kNow + 60'000, 0.03));
  EXPECT_THAT(chunk.calibration_utime, ElementsAre(2));
  const auto end = fuser.EndSweep();
  ASSERT_THAT(end, SizeIs(1));
  EXPECT_THAT(end[0].calibration_utime, ElementsAre(2));
  EXPECT_EQ(end[0].size(), 40U);
  EXPECT_TRUE(end[0].sweep_end);
}

// A rod that the last lines of the sweep see hides what the first lines saw.
TEST(SweepFuser, TheSweepsEndKnowsWhatCameLater) {
  const Drive still{false};
  const CameraSpec spec = SpecOf(0);
  SweepFuser fuser({spec}, 0.005);
  // The camera stands to the left, so that the rod, to the left, hides the wall to the right of it.
  Rigid3 beside = CameraFromLidar();
  beside.translation.x() += 0.5;
  fuser.SetCalibration(0, At(beside), 1);
  fuser.camera(0).AddImage(Photograph(still, spec, kNow - 100'000));
  std::vector<RgbdtCloud> chunks;
  const auto line = [&](int number, bool rod) {
    Cloud cloud = LineAt(still, kNow, number, kNow + number * 20'000, -0.2 + 0.01 * number);
    for (Eigen::Vector3f& p : cloud.points) p *= rod ? 0.4F : 1.F;
    return cloud;
  };
  for (int number = 0; number < 40; ++number) {
    chunks.push_back(fuser.FuseChunk(line(number, number >= 30)));
  }
  const auto parts = fuser.EndSweep();
  ASSERT_THAT(parts, SizeIs(1));
  int at_once = 0;
  int at_end = 0;
  std::size_t i = 0;
  for (const RgbdtCloud& chunk : chunks) {
    for (std::size_t k = 0; k < chunk.size(); ++k, ++i) {
      at_once += chunk.valid[k] == 0 ? 1 : 0;
      at_end += parts[0].valid[i] == 0 ? 1 : 0;
      EXPECT_LE(parts[0].valid[i], chunk.valid[k]);
    }
  }
  EXPECT_EQ(at_once, 0);
  EXPECT_GT(at_end, 200);
  // The next sweep knows it from the start.
  Cloud again = line(22, false);
  again.sweep_utime = kNow + 10 * kSecond;
  int hidden = 0;
  for (const std::uint32_t valid : fuser.FuseChunk(again).valid) hidden += valid == 0 ? 1 : 0;
  EXPECT_GT(hidden, 30);
}

// A pillar in the first sweep, at the left, which hides the wall to the right of it. The second
// sweep comes from the left: the pillar's place first.
TEST(SweepFuser, WhatHasGoneHidesNothing) {
  const Drive still{false};
  const CameraSpec spec = SpecOf(0);
  constexpr int kLines = 100;
  const auto line = [&](Utime sweep, int number, bool pillar) {
    Cloud cloud;
    cloud.sweep_utime = sweep;
    cloud.first_line = number;
    cloud.lines = 1;
    cloud.beams = 60;
    const double azimuth = -0.2 + 0.004 * number;
    const bool near = pillar && number >= 75 && number < 95;
    for (int beam = 0; beam < cloud.beams; ++beam) {
      const Eigen::Vector3d ray(1, std::tan(azimuth), 0.004 * (beam - 30) / std::cos(azimuth));
      cloud.points.emplace_back(((near ? 2 : 5) * ray).cast<float>());
    }
    return cloud;
  };
  for (const bool stays : {true, false}) {
    SweepFuser fuser({spec}, 0.005);
    Rigid3 beside = CameraFromLidar();
    beside.translation.x() += 0.5;
    fuser.SetCalibration(0, At(beside), 1);
    fuser.camera(0).AddImage(Photograph(still, spec, kNow - 100'000));
    fuser.camera(0).ServeAllTimes();
    for (int number = 0; number < kLines; ++number) fuser.FuseChunk(line(kNow, number, true));
    fuser.EndSweep();
    int hidden = 0;
    for (int number = kLines - 1; number >= 0; --number) {
      const auto fused = fuser.FuseChunk(line(kNow + 20 * kSecond, number, stays));
      for (const std::uint32_t valid : fused.valid) hidden += valid == 0 ? 1 : 0;
    }
    if (stays) {
      EXPECT_GT(hidden, 800);
    } else {
      EXPECT_LT(hidden, 200);  // at the rim of what was looked at, nobody knows
    }
  }
}

TEST(SweepFuser, BadPointsAreLeftOutAndHarmNothing) {
  const Drive still{false};
  const CameraSpec spec = SpecOf(0);
  SweepFuser fuser({spec}, 0.005);
  fuser.SetCalibration(0, At(CameraFromLidar()), 1);
  fuser.camera(0).AddImage(Photograph(still, spec, kNow - 100'000));
  Cloud line = LineAt(still, kNow, 0, kNow, 0);
  line.points[3].x() = std::nanf("");
  line.points[4].y() = INFINITY;
  line.points[5].setZero();
  line.points[6] = Eigen::Vector3f::Constant(1e30F);
  const RgbdtCloud fused = fuser.FuseChunk(line);
  EXPECT_EQ(fused.size(), 38U);
  EXPECT_EQ(fused.valid[0], 1U);
  EXPECT_EQ(fused.valid[3], 0U);
  EXPECT_EQ(fused.valid[4], 0U);
}

TEST(SweepFuser, ACloudFromTheFutureIsNotColouredAndCounted) {
  const Drive still{false};
  const CameraSpec spec = SpecOf(0);
  SweepFuser fuser({spec}, 0.005);
  fuser.SetCalibration(0, At(CameraFromLidar()), 1);
  fuser.camera(0).AddImage(Photograph(still, spec, kNow - 100'000));
  const Utime future = kNow + 3600 * kSecond;
  EXPECT_THAT(fuser.FuseChunk(LineAt(still, future, 0, future, 0)).valid, Each(0U));
  EXPECT_EQ(fuser.counts().without_image, 40);
  EXPECT_THAT(fuser.FuseChunk(LineAt(still, kNow, 0, kNow, 0)).valid, Each(1U));
}

}  // namespace
}  // namespace rgbdt
