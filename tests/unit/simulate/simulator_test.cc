#include "calib/simulate/simulator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "calib/model/calibration.h"
#include "calib/model/errors.h"
#include "calib/simulate/internal/natural_scene.h"
#include "tests/unit/simulate/simulate_testing.h"

namespace rgbdt::simulate {
namespace {

constexpr Utime kStart = 1'700'000'000'000'000;

bool SameBits(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

bool SamePixels(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

TEST(Simulator, RepeatsItselfAfterARestartWithOtherThreads) {
  Options options = SmallOptions();
  options.threads = 1;
  Simulator first(options);
  first.ShowView(0, "a");
  first.ShowView(4, "b");
  options.threads = 3;
  Simulator second(options);  // never showed view 0
  second.ShowView(4, "b");
  for (const char* camera : {"rgb", "thermal"}) {
    const Image a = first.TakeImage(camera, kStart + 77);
    first.TakeImage(camera, kStart + 78);
    EXPECT_TRUE(SamePixels(a.pixels, first.TakeImage(camera, kStart + 77).pixels));
    EXPECT_TRUE(SamePixels(a.pixels, second.TakeImage(camera, kStart + 77).pixels));
    EXPECT_FALSE(SamePixels(a.pixels, second.TakeImage(camera, kStart + 78).pixels));
    EXPECT_EQ(first.PickCorners(camera, kStart).corners,
              second.PickCorners(camera, kStart).corners);
  }
  const LineScan line = first.Line(kStart, 150);
  EXPECT_TRUE(SameBits(line.range, second.Line(kStart, 150).range));
  EXPECT_TRUE(SameBits(line.intensity, second.Line(kStart, 150).intensity));
  EXPECT_FALSE(SameBits(line.range, second.Line(kStart + 1, 150).range));
}

TEST(Simulator, SeedChangesTruthGuessAndNoise) {
  Options options = SmallOptions();
  const Simulator first(options);
  options.seed = 2;
  const Simulator second(options);
  EXPECT_NE(first.truth().camera_from_lidar.at("rgb").translation,
            second.truth().camera_from_lidar.at("rgb").translation);
  EXPECT_FALSE(SameBits(first.Line(kStart, 10).range, second.Line(kStart, 10).range));
}

TEST(Simulator, GuessIsWrongWithinItsBounds) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    Options options = SmallOptions();
    options.seed = seed;
    const Simulator simulator(options);
    for (const CameraSpec& camera : simulator.rig().cameras) {
      const Rigid3& truth = simulator.truth().camera_from_lidar.at(camera.name);
      const PoseError error = ErrorOf(*camera.camera_from_lidar_guess, truth);
      EXPECT_LE(error.rotation_deg, 2.0 + 1e-9);
      EXPECT_GE(error.rotation_deg, 0.5);
      EXPECT_LE(error.translation_mm, 50 + 1e-6);
      EXPECT_GE(error.translation_mm, 15);
      const double off = truth.Inverse().translation.norm();
      EXPECT_GE(off, 0.10);
      EXPECT_LE(off, 0.25);
    }
  }
}

TEST(Simulator, RigIsThePapers) {
  const Simulator simulator{Options()};
  const Rig& rig = simulator.rig();
  EXPECT_EQ(rig.Camera("rgb").width, 1936);
  EXPECT_EQ(rig.Camera("rgb").height, 1456);
  EXPECT_EQ(rig.Camera("rgb").format, PixelFormat::kBayerRg8);
  EXPECT_EQ(rig.Camera("rgb").lens.fx, 1100);
  EXPECT_EQ(rig.Camera("thermal").width, 640);
  EXPECT_EQ(rig.Camera("thermal").height, 480);
  EXPECT_EQ(rig.Camera("thermal").format, PixelFormat::kMono16);
  EXPECT_EQ(rig.Camera("thermal").lens.fx, 530);
  EXPECT_EQ(rig.Camera("thermal").radiometry.kind, Radiometry::Kind::kLinear);
  EXPECT_EQ(rig.target.squares_x, 11);
  EXPECT_EQ(rig.target.squares_y, 8);
  EXPECT_DOUBLE_EQ(rig.target.width_m, 1.2192);
  EXPECT_DOUBLE_EQ(rig.target.height_m, 0.9144);
  EXPECT_NEAR(rig.lidar.turned_scanner->ticks_per_rad * kDegree, 1400, 1e-9);
  EXPECT_EQ(simulator.sweep_lines(), 300);
  EXPECT_EQ(simulator.line_period(), 40000);
  EXPECT_EQ(simulator.Line(kStart, 0).range.size(), 400U);
}

TEST(Simulator, EncoderReadsWholeTicksOfTheSweep) {
  const Simulator simulator(SmallOptions());
  const double zero = simulator.rig().lidar.turned_scanner->zero_ticks;
  EXPECT_EQ(simulator.Encoder(kStart, kStart).ticks, std::llround(zero) - 42000);
  EXPECT_EQ(simulator.Encoder(kStart + 6000000, kStart).ticks, std::llround(zero));
  EXPECT_EQ(simulator.Encoder(kStart + 12000000, kStart).ticks, std::llround(zero) + 42000);
  EXPECT_EQ(simulator.Encoder(kStart + 6000000, 0).ticks, std::llround(zero) - 42000);
  EXPECT_EQ(simulator.Encoder(kStart + 1, kStart).sweep_utime, kStart);
}

TEST(Simulator, EveryOtherViewIsSweptBack) {
  Options options = SmallOptions();
  options.scanner.encoder_delay_s = 0.2;
  Simulator simulator(SmallOptions()), late(options);
  const auto zero = std::llround(simulator.rig().lidar.turned_scanner->zero_ticks);
  for (Simulator* each : {&simulator, &late}) each->ShowView(1, "0002");
  EXPECT_EQ(simulator.Encoder(kStart, kStart).ticks, zero + 42000);
  EXPECT_EQ(simulator.Encoder(kStart + 3000000, kStart).ticks, zero + 21000);
  EXPECT_EQ(simulator.Encoder(kStart + 12000000, kStart).ticks, zero - 42000);
  // What it reads, it was at 0.2 s ago.
  EXPECT_EQ(late.Encoder(kStart + 3200000, kStart).ticks, zero + 21000);
  EXPECT_TRUE(SameBits(late.Line(kStart, 150).range, simulator.Line(kStart, 150).range));
}

/// Every range on the board, put into the target's frame with the truth, lies in its plane.
TEST(Simulator, CloudLiesOnTheBoard) {
  Simulator simulator(SmallOptions());
  simulator.ShowView(1, "0001");
  const Rigid3 target_from_lidar = simulator.truth().lidar_from_target.at("0001").Inverse();
  const TurnedScanner& scanner = *simulator.rig().lidar.turned_scanner;
  double squares = 0;
  int count = 0;
  for (int line = 0; line < simulator.sweep_lines(); ++line) {
    const LineScan scan = simulator.Line(kStart, line);
    for (std::size_t beam = 0; beam < scan.range.size(); ++beam) {
      const Utime utime = scan.utime + static_cast<Utime>(beam) * 100;
      const double motor =
          (static_cast<double>(simulator.Encoder(utime, kStart).ticks) - scanner.zero_ticks) /
          scanner.ticks_per_rad;
      const double a = scan.first_angle_rad + scan.angle_step_rad * static_cast<double>(beam);
      const Eigen::Vector3d in_scanner =
          scan.range[beam] * Eigen::Vector3d(std::cos(a), 0, std::sin(a));
      const Eigen::Vector3d p =
          target_from_lidar * (RotationAbout(Eigen::Vector3d::UnitZ(), motor) *
                               (scanner.motor_from_scanner * in_scanner));
      if (!(std::abs(p.x()) < 0.58 && std::abs(p.y()) < 0.43 && std::abs(p.z()) < 0.2)) continue;
      squares += p.z() * p.z();
      ++count;
    }
  }
  ASSERT_GT(count, 500);
  EXPECT_LT(std::sqrt(squares / count), 0.0105);
  EXPECT_GT(std::sqrt(squares / count), 0.006);
}

/// Distances [m] of a cloud's points on the board from its plane.
std::vector<double> OffTheBoard(const Cloud& cloud, const Rigid3& lidar_from_target) {
  std::vector<double> off;
  for (const Eigen::Vector3f& point : cloud.points) {
    const Eigen::Vector3d p = lidar_from_target.Inverse() * point.cast<double>();
    if (std::abs(p.x()) < 0.55 && std::abs(p.y()) < 0.4 && std::abs(p.z()) < 0.2) {
      off.push_back(p.z());
    }
  }
  return off;
}

TEST(Simulator, FurtherLidarsSeeTheSameBoardFromWhereTheTruthPutsThem) {
  Options options = SmallOptions();
  UseLidar(32, &options);
  AddLidar(16, &options);
  AddLidar(32, &options);
  Simulator simulator(options);
  ASSERT_EQ(simulator.rig().further_lidars.size(), 2U);
  EXPECT_EQ(simulator.rig().further_lidars[1].name, "lidar3");
  simulator.ShowView(1, "0001");
  const Rigid3& board = simulator.truth().lidar_from_target.at("0001");
  const std::vector<LidarCloud> clouds = simulator.FurtherRevolutions(kStart);
  ASSERT_EQ(clouds.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(clouds[i].lidar, simulator.rig().further_lidars[i].name);
    const Rigid3& reference_from_lidar = simulator.truth().reference_from_lidar.at(clouds[i].lidar);
    EXPECT_GT(reference_from_lidar.translation.norm(), 0.3);
    const std::vector<double> off =
        OffTheBoard(clouds[i].cloud, reference_from_lidar.Inverse() * board);
    ASSERT_GT(off.size(), 80U) << clouds[i].lidar;
    double squares = 0;
    for (const double z : off) squares += z * z;
    const double rms = std::sqrt(squares / static_cast<double>(off.size()));
    EXPECT_LT(rms, 1.1 * options.further_lidars[i].spinning.range_sigma_m);
    EXPECT_GT(rms, 0.5 * options.further_lidars[i].spinning.range_sigma_m);
  }
  EXPECT_NE(clouds[0].cloud.points[9000], simulator.Revolution(kStart).points[9000]);
}

TEST(Simulator, PicksScatterRoundTheTrueCorners) {
  Simulator simulator(SmallOptions());
  simulator.ShowView(2, "0001");
  for (const CameraSpec& camera : simulator.rig().cameras) {
    const Rigid3 camera_from_target = simulator.truth().camera_from_lidar.at(camera.name) *
                                      simulator.truth().lidar_from_target.at("0001");
    const auto outline = simulator.rig().target.OutlineCorners();
    const std::vector<cv::Point2d> truth =
        OpenCvPixels(camera.lens, camera_from_target, {outline.begin(), outline.end()});
    double squares = 0;
    constexpr int kTimes = 200;
    for (int i = 0; i < kTimes; ++i) {
      const CornerSelection picks = simulator.PickCorners(camera.name, kStart + i);
      EXPECT_EQ(picks.image_utime, kStart + i);
      for (std::size_t k = 0; k < 4; ++k) {
        squares += (picks.corners[k] - Eigen::Vector2d(truth[k].x, truth[k].y)).squaredNorm();
      }
    }
    EXPECT_NEAR(std::sqrt(squares / (8 * kTimes)), 1.5, 0.1);
  }
}

/// Read back through the rig's radiometry, board and person have the temperatures they should.
TEST(Simulator, ThermalImageGivesTemperatures) {
  Options options = SmallOptions(Scene::kIndoor);
  options.board.temperature_k = 310;
  options.board.black_minus_white_k = 0;
  options.board.gradient_k = options.board.glow_k = 0;
  options.board.hidden_outline_m = 0;
  Simulator simulator(options);
  simulator.ShowView(0, "0001");
  const CameraSpec& camera = simulator.rig().Camera("thermal");
  const Image image = simulator.TakeImage("thermal", kStart);
  const Rigid3 camera_from_target = simulator.truth().camera_from_lidar.at("thermal") *
                                    simulator.truth().lidar_from_target.at("0001");
  const cv::Point2d pixel =
      OpenCvPixels(camera.lens, camera_from_target, {Eigen::Vector3d(0, 0, 0)})[0];
  const double counts = image.pixels.at<std::uint16_t>(cv::Point(pixel));
  const Radiometry& r = image.radiometry;
  const double apparent = r.gain * counts + r.offset;
  const double surface = std::pow(
      (std::pow(apparent, 4) - (1 - r.emissivity) * std::pow(r.reflected_temperature_k, 4)) /
          r.emissivity,
      0.25);
  EXPECT_NEAR(surface, 310, 0.25);
}

/// The paper's hard case: along some stretch the outline does not show.
TEST(Simulator, PartOfTheOutlineIsAsWarmAsItsBackground) {
  Options options;
  options.cameras.erase(options.cameras.begin());  // thermal only, in full
  options.cameras[0].netd_k = 0;
  for (const Scene scene : {Scene::kOutdoor, Scene::kIndoor, Scene::kNight}) {
    options.scene = scene;
    Simulator simulator(options);
    simulator.ShowView(0, "0001");
    const Image image = simulator.TakeImage("thermal", kStart);
    const Rigid3 camera_from_target = simulator.truth().camera_from_lidar.at("thermal") *
                                      simulator.truth().lidar_from_target.at("0001");
    const auto corners = simulator.rig().target.OutlineCorners();
    int stations = 0, invisible = 0;
    for (std::size_t side = 0; side < 4; ++side) {
      const Eigen::Vector3d step = (corners[(side + 1) % 4] - corners[side]) / 20;
      const Eigen::Vector3d inwards = -(corners[side] + 10 * step).normalized();
      for (int i = 1; i < 20; ++i) {
        const Eigen::Vector3d place = corners[side] + i * step;
        const auto pixels = OpenCvPixels(simulator.rig().cameras[0].lens, camera_from_target,
                                         {place + 0.03 * inwards, place - 0.03 * inwards});
        const double inside = image.pixels.at<std::uint16_t>(cv::Point(pixels[0]));
        const double outside = image.pixels.at<std::uint16_t>(cv::Point(pixels[1]));
        ++stations;
        invisible += std::abs(inside - outside) * 0.02 < 0.8 ? 1 : 0;
      }
    }
    EXPECT_GE(invisible, 4) << "scene " << static_cast<int>(scene);
    EXPECT_LE(invisible, stations / 3) << "scene " << static_cast<int>(scene);
  }
}

TEST(Simulator, RefusesWhatItDoesNotHave) {
  Simulator simulator(SmallOptions());
  EXPECT_THROW(simulator.TakeImage("lidar", kStart), InputError);
  EXPECT_THROW(simulator.PickCorners("rgb", kStart), InputError);  // no view yet
  EXPECT_THROW(simulator.Line(kStart, 300), InputError);
  EXPECT_THROW(simulator.Line(kStart, -1), InputError);
  EXPECT_THROW(simulator.ShowView(-1, "x"), InputError);
  Options bad;
  bad.supersampling = -1;
  EXPECT_THROW(Simulator{bad}, InputError);
}

TEST(Simulator, ShowsTheSceneWithoutABoardBeforeTheFirstView) {
  Simulator simulator(SmallOptions());
  const Image before = simulator.TakeImage("rgb", kStart);
  EXPECT_EQ(before.pixels.cols, 484);
  simulator.ShowView(0, "a");
  EXPECT_FALSE(SamePixels(before.pixels, simulator.TakeImage("rgb", kStart).pixels));
}

TEST(Simulator, MayHaveASpinningLidar) {
  for (const int rings : {16, 64}) {
    Options options = SmallOptions();
    UseLidar(rings, &options);
    Simulator simulator(options);
    EXPECT_FALSE(simulator.rig().lidar.turned_scanner);
    EXPECT_EQ(simulator.rig().lidar.range_sigma_m, options.spinning->range_sigma_m);
    simulator.ShowView(0, "a");
    const Cloud cloud = simulator.Revolution(2000000);
    EXPECT_EQ(cloud.lines, rings);
    const Rigid3 target_from_lidar = simulator.truth().lidar_from_target.at("a").Inverse();
    int on_board = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      if (!cloud.IsHit(i)) continue;
      const Eigen::Vector3d p = target_from_lidar * cloud.points[i].cast<double>();
      on_board += std::abs(p.x()) < 0.6 && std::abs(p.y()) < 0.45 && std::abs(p.z()) < 0.08 ? 1 : 0;
    }
    EXPECT_GT(on_board, 15);
    for (const Eigen::Vector2d& corner : simulator.PickCorners("rgb", 3000000).corners) {
      EXPECT_GT(corner.minCoeff(), 0);
      EXPECT_LT(corner.x(), options.cameras[0].width);
      EXPECT_LT(corner.y(), options.cameras[0].height);
    }
  }
  EXPECT_THROW(Simulator(SmallOptions()).Revolution(0), InputError);
}

Options NaturalOptionsOf(Scene scene) {
  Options options = SmallOptions(scene);
  options.natural.on = true;
  return options;
}

TEST(Simulator, NaturalScenesRepeatThemselves) {
  Options options = NaturalOptionsOf(Scene::kOutdoor);
  options.threads = 1;
  Simulator first(options);
  first.ShowView(0, "a");
  const Image before = first.TakeImage("rgb", kStart);
  first.ShowView(3, "b");
  options.threads = 3;
  Simulator second(options);
  second.ShowView(3, "b");
  for (const char* camera : {"rgb", "thermal"}) {
    EXPECT_TRUE(SamePixels(first.TakeImage(camera, kStart).pixels,
                           second.TakeImage(camera, kStart).pixels));
  }
  EXPECT_FALSE(SamePixels(before.pixels, first.TakeImage("rgb", kStart).pixels));
  EXPECT_TRUE(SameBits(first.Line(kStart, 150).range, second.Line(kStart, 150).range));
}

TEST(Simulator, NaturalScenesHaveNoBoardUnlessAskedFor) {
  Options options = NaturalOptionsOf(Scene::kIndoor);
  Simulator bare(options);
  bare.ShowView(0, "a");
  bare.ShowView(1, "b");
  EXPECT_TRUE(bare.truth().lidar_from_target.empty());
  EXPECT_NE(bare.truth().world_from_lidar.at("a").translation,
            bare.truth().world_from_lidar.at("b").translation);
  EXPECT_THROW(bare.PickCorners("rgb", kStart), InputError);
  options.natural.board = true;
  for (const Scene scene : {Scene::kOutdoor, Scene::kIndoor}) {
    options.scene = scene;
    Simulator with_board(options);
    for (const int view : {0, 1}) {
      ASSERT_NO_THROW(with_board.ShowView(view, "b")) << "view " << view;
      EXPECT_EQ(with_board.truth().lidar_from_target.count("b"), 1U);
      EXPECT_NO_THROW(with_board.PickCorners("rgb", kStart));
    }
  }
}

/// Points that the LIDAR has on people, by the true pose in the thermal image: as warm as people.
TEST(Simulator, NaturalScenesAreSeenFromTheTruePoses) {
  Options options = NaturalOptionsOf(Scene::kIndoor);
  options.natural.people = 6;
  UseLidar(64, &options);
  Simulator simulator(options);
  int met[2] = {0, 0}, count = 0;
  for (const int view : {0, 4}) {
    simulator.ShowView(view, "v");
    const auto scene = std::make_shared<SceneModel>(MakeNaturalScene(options, view));
    const World world(scene, std::nullopt, options);
    const Image image = simulator.TakeImage("thermal", kStart);
    const Cloud cloud = simulator.Revolution(kStart);
    const Rigid3& camera_from_lidar = simulator.truth().camera_from_lidar.at("thermal");
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      if (!cloud.IsHit(i)) continue;
      const Eigen::Vector3d point = cloud.points[i].cast<double>();
      const Hit hit = world.caster().Cast({0, 0, 0}, point.normalized());
      if (!hit.hit() || world.Object(hit).name != "torso") continue;
      // The truth, and a pose that is off by 0.3 m to the side.
      const Eigen::Vector3d seen = camera_from_lidar * point;
      const std::vector<cv::Point2d> pixels =
          OpenCvPixels(options.cameras[1].lens,
                       {{seen.x(), seen.y(), seen.z()}, {seen.x() + 0.3, seen.y(), seen.z()}});
      if (seen.z() < 0.5 || !cv::Rect(2, 2, 156, 116).contains(cv::Point(pixels[0])) ||
          !cv::Rect(2, 2, 156, 116).contains(cv::Point(pixels[1]))) {
        continue;
      }
      ++count;
      for (int k = 0; k < 2; ++k) {
        const auto counts =
            image.pixels.at<std::uint16_t>(cv::Point(static_cast<int>(std::lround(pixels[k].x)),
                                                     static_cast<int>(std::lround(pixels[k].y))));
        met[k] += counts * 0.02 + 233.15 > 302 ? 1 : 0;
      }
    }
  }
  ASSERT_GT(count, 100);
  EXPECT_GT(met[0], 0.85 * count);
  EXPECT_LT(met[1], 0.6 * count);
}

}  // namespace
}  // namespace rgbdt::simulate
