#include "calib/simulate/internal/camera_renderer.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "calib/simulate/internal/shading.h"
#include "tests/unit/simulate/simulate_testing.h"

namespace rgbdt::simulate {
namespace {

/// A camera looking at the first view's board.
struct Scenery {
  explicit Scenery(const Options& o, std::size_t camera, const Rigid3& lidar_from_target)
      : options(o),
        scene(std::make_shared<SceneModel>(MakeScene(o))),
        empty(scene, std::nullopt, o),
        world(scene, Board(o.board, lidar_from_target, DrawHeat(o.board, scene->board_heat, 1, 0)),
              o),
        renderer(o.cameras[camera], DrawCameraFromLidar(o.cameras[camera], o.seed), o.supersampling,
                 o.threads) {
    renderer.RenderEmpty(empty);
    renderer.Render(world);
  }

  Options options;
  std::shared_ptr<const SceneModel> scene;
  World empty, world;
  CameraRenderer renderer;
};

/// 3 m ahead, tilted and turned.
Rigid3 TiltedBoard() {
  Rigid3 pose;
  Eigen::Matrix3d facing;
  facing << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  pose.rotation = Eigen::Quaterniond(facing) *
                  RotationAbout(Eigen::Vector3d(0.6, 0.8, 0), 25 * kDegree).rotation *
                  RotationAbout(Eigen::Vector3d::UnitZ(), 17 * kDegree).rotation;
  pose.translation = {3, 0.1, 0.05};
  return pose;
}

/// Mean distance between corners refined in the noise-free image and OpenCV's projection.
double MeanCornerError(const Scenery& s, const cv::Mat& grey) {
  const std::vector<cv::Point2d> truth =
      OpenCvPixels(s.renderer.options().lens,
                   s.renderer.camera_from_lidar() * s.world.board()->lidar_from_target(),
                   MakeTarget(s.options.board).InnerCorners());
  std::vector<cv::Point2f> corners;
  for (const cv::Point2d& t : truth) {
    corners.emplace_back(static_cast<float>(t.x + 0.4), static_cast<float>(t.y - 0.3));
  }
  cv::cornerSubPix(grey, corners, {4, 4}, {-1, -1},
                   {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-4});
  double sum = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    sum += cv::norm(cv::Point2d(corners[i]) - truth[i]);
  }
  return sum / static_cast<double>(truth.size());
}

TEST(CameraRenderer, ColourCornersLieWhereOpenCvProjectsThem) {
  const Scenery s(Options(), 0, TiltedBoard());
  cv::Mat mosaic, bgr, grey;
  s.renderer.clean().convertTo(mosaic, CV_16U, 200);
  cv::demosaicing(mosaic, bgr, cv::COLOR_BayerBG2BGR);  // OpenCV's name for R G / G B
  cv::cvtColor(bgr, grey, cv::COLOR_BGR2GRAY);
  grey.convertTo(grey, CV_32F);
  EXPECT_LT(MeanCornerError(s, grey), 0.05);
}

TEST(CameraRenderer, ThermalCornersLieWhereOpenCvProjectsThem) {
  Options options;
  options.board.glow_k = options.board.gradient_k = 0;
  const Scenery s(options, 1, TiltedBoard());
  EXPECT_LT(MeanCornerError(s, s.renderer.clean()), 0.05);
}

TEST(CameraRenderer, AnUprightEdgeIsPlacedToTheHundredthOfAPixel) {
  // Without blur, the mean of a pixel that an edge crosses is the share that lies on each side.
  Options options = SmallOptions();
  options.cameras[1].blur_px = 0;
  options.cameras[1].lens.distortion = {};
  options.cameras[1].tilt_rad = 0;
  auto scene = std::make_shared<SceneModel>();
  Material warm, cool;
  warm.temperature_k = 300;
  cool.temperature_k = 290;
  warm.emissivity = cool.emissivity = 1;
  CameraRenderer camera(options.cameras[1], DrawCameraFromLidar(options.cameras[1], 1), 5, 1);
  const double depth = 4 - camera.CentreInLidar().x();
  const double edge_y = camera.CentreInLidar().y() + 0.003;
  scene->objects = {
      {"left", MakeQuad({4, edge_y, -9}, {4, 9, -9}, {4, 9, 9}, {4, edge_y, 9}), warm},
      {"right", MakeQuad({4, -9, -9}, {4, edge_y, -9}, {4, edge_y, 9}, {4, -9, 9}), cool}};
  const World world(scene, std::nullopt, options);
  camera.RenderEmpty(world);
  camera.ShowEmpty(world);
  const double edge_u = options.cameras[1].lens.cx - options.cameras[1].lens.fx * 0.003 / depth;
  double warm_pixels = 0;
  for (int u = 0; u < camera.options().width; ++u) {
    const double kelvin = camera.clean().at<float>(60, u) * 0.02 + 233.15;
    warm_pixels += (kelvin - 290) / 10;
  }
  EXPECT_NEAR(warm_pixels - 0.5, edge_u, 0.025);
}

TEST(CameraRenderer, RenderedAgainOnlyWhereTheBoardIsEqualsRenderedInFull) {
  // A renderer that takes the world with its board for its empty scene renders all of it afresh.
  for (const std::size_t camera : {0U, 1U}) {
    const Scenery s(SmallOptions(Scene::kIndoor), camera, TiltedBoard());
    CameraRenderer full(s.options.cameras[camera], s.renderer.camera_from_lidar(), 5, 1);
    full.RenderEmpty(s.world);
    full.ShowEmpty(s.world);
    EXPECT_EQ(cv::norm(full.clean(), s.renderer.clean(), cv::NORM_INF), 0);
  }
}

TEST(CameraRenderer, NoiseHasItsSigma) {
  for (const std::size_t camera : {0U, 1U}) {
    const Scenery s(SmallOptions(), camera, TiltedBoard());
    const Image image = s.renderer.Take(1, 123);
    double squares = 0;
    int count = 0;
    for (int row = 0; row < image.pixels.rows; ++row) {
      for (int column = 0; column < image.pixels.cols; ++column) {
        const float clean = s.renderer.clean().at<float>(row, column);
        if (camera == 0 && (clean < 20 || clean > 235)) continue;
        const double seen = camera == 0 ? image.pixels.at<std::uint8_t>(row, column)
                                        : image.pixels.at<std::uint16_t>(row, column);
        squares += (seen - clean) * (seen - clean);
        ++count;
      }
    }
    ASSERT_GT(count, 10000);
    const double quantised = 1.0 / 12;
    const double sigma = std::sqrt(squares / count - quantised);
    EXPECT_NEAR(sigma, camera == 0 ? 2.0 : 0.050 / 0.02, 0.05);
  }
}

TEST(CameraRenderer, DeadPixelsStayWhereTheSeedPutsThem) {
  for (const std::size_t camera : {0U, 1U}) {
    Options options = SmallOptions();
    const Scenery alive(options, camera, TiltedBoard());
    options.cameras[camera].dead_pixels = 12;
    const Scenery dead(options, camera, TiltedBoard());
    const double top = camera == 0 ? 255 : 16383;
    const auto places = [&](std::uint64_t seed, Utime utime) {
      const cv::Mat with = dead.renderer.Take(seed, utime).pixels;
      cv::Mat changed = with != alive.renderer.Take(seed, utime).pixels;
      // No more than asked for; one may be as black as what it hides.
      EXPECT_LE(cv::countNonZero(changed), 12);
      EXPECT_GE(cv::countNonZero(changed), 6);
      cv::Mat stuck = (with == 0) | (with == top);
      EXPECT_EQ(cv::countNonZero(changed & ~stuck), 0);
      return changed;
    };
    EXPECT_EQ(cv::norm(places(1, 123), places(1, 456), cv::NORM_INF), 0);
    EXPECT_GT(cv::norm(places(1, 123), places(2, 123), cv::NORM_INF), 0);
  }
}

TEST(CameraRenderer, ExposesTheBoard) {
  for (const Scene scene : {Scene::kOutdoor, Scene::kIndoor, Scene::kNight}) {
    const Scenery s(SmallOptions(scene), 0, TiltedBoard());
    std::vector<Eigen::Vector3d> places;
    for (const double x : {-0.5, -0.4, 0.0, 0.1, 0.4, 0.5}) {
      for (const double y : {-0.35, -0.25, 0.05, 0.15, 0.35}) places.emplace_back(x, y, 0);
    }
    const std::vector<cv::Point2d> pixels = OpenCvPixels(
        s.renderer.options().lens, s.renderer.camera_from_lidar() * TiltedBoard(), places);
    for (std::size_t i = 0; i < places.size(); ++i) {
      const float dn = s.renderer.clean().at<float>(cv::Point(pixels[i]));
      const Board& board = *s.world.board();
      if (board.IsBlack(board.Patch(places[i].head<2>()))) {
        EXPECT_GT(dn, 10);
        EXPECT_LT(dn, 60);
      } else {
        EXPECT_GT(dn, 80);
        EXPECT_LT(dn, 240);
      }
    }
  }
}

TEST(Shading, SurfaceTemperatureInvertsApparentTemperature) {
  for (const double t : {250.0, 290.0, 310.0, 400.0}) {
    for (const double e : {0.5, 0.95, 1.0}) {
      EXPECT_NEAR(SurfaceTemperature(ApparentTemperature(t, e, 262), e, 262), t, 1e-9);
    }
  }
  EXPECT_DOUBLE_EQ(ApparentTemperature(300, 1, 200), 300);
}

}  // namespace
}  // namespace rgbdt::simulate
