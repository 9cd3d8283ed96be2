#include "calib/present/frames/overlay_frame.h"

#include <limits>

#include "calib/camera/camera.h"
#include "tests/unit/present/frames/frame_testing.h"
#include "tests/unit/solve/board_world.h"

namespace rgbdt {
namespace {

constexpr float kNotANumber = std::numeric_limits<float>::quiet_NaN();

double WorstResidual(const Overlay& overlay) {
  double worst = 0;
  for (const Eigen::Vector3d& point : overlay.edge) worst = std::max(worst, point.z());
  return worst;
}

TEST(ViewOverlay, TheTrueCalibrationLaysTheEdgeOnTheOutline) {
  const BoardWorld world = MakeBoardWorld(3);
  for (const ViewDetection& view : world.views) {
    const Overlay overlay = ViewOverlay(world.spec, view, nullptr, world.camera_from_lidar);
    EXPECT_TRUE(overlay.calibrated);
    EXPECT_EQ(overlay.view, view.view);
    EXPECT_EQ(overlay.utime, view.images[0].utime);
    ASSERT_EQ(overlay.edge.size(), view.cloud.candidates[0].boundary.size());
    EXPECT_LT(WorstResidual(overlay), 0.01);
  }
}

TEST(ViewOverlay, AWrongCalibrationShowsHowFarItIsOff) {
  const BoardWorld world = MakeBoardWorld(1);
  // About the camera's y: some 500 px/rad across the image, so 5 px at the upright sides.
  const Rigid3 wrong = RotationAbout({0, 1, 0}, 0.01) * world.camera_from_lidar;
  const Overlay overlay = ViewOverlay(world.spec, world.views[0], nullptr, wrong);
  EXPECT_GT(WorstResidual(overlay), 3);
  EXPECT_LT(WorstResidual(overlay), 10);
}

TEST(ViewOverlay, WithoutACalibrationItIsWhatTheImageShows) {
  const BoardWorld world = MakeBoardWorld(1);
  const Cloud cloud;
  const Overlay overlay = ViewOverlay(world.spec, world.views[0], &cloud, std::nullopt);
  EXPECT_FALSE(overlay.calibrated);
  EXPECT_EQ(overlay.text, "board found");
  EXPECT_EQ(overlay.outline.size(), world.views[0].images[0].edges->outline.size());
  EXPECT_TRUE(overlay.edge.empty());
  EXPECT_TRUE(overlay.cloud.empty());
}

TEST(ViewOverlay, ARejectedViewSaysWhyAndHasNoResiduals) {
  const BoardWorld world = MakeBoardWorld(1);
  ViewDetection view = world.views[0];
  view.images[0].edges.reset();
  view.images[0].why_not = "no board in view";
  const Overlay overlay = ViewOverlay(world.spec, view, nullptr, world.camera_from_lidar);
  EXPECT_EQ(overlay.text, "no board in view");
  ASSERT_FALSE(overlay.edge.empty());
  for (const Eigen::Vector3d& point : overlay.edge) EXPECT_TRUE(std::isnan(point.z()));
}

TEST(ViewOverlay, WithoutABoardInTheCloudTheImageIsShownAllTheSame) {
  const BoardWorld world = MakeBoardWorld(1);
  ViewDetection view = world.views[0];
  view.cloud.candidates.clear();
  view.cloud.why_not = "no plane of its size";
  const Overlay overlay = ViewOverlay(world.spec, view, nullptr, world.camera_from_lidar);
  EXPECT_EQ(overlay.text, "no plane of its size");
  EXPECT_FALSE(overlay.outline.empty());
  EXPECT_TRUE(overlay.edge.empty());
}

TEST(LayOnImage, PointsComeWhereTheCameraSeesThem) {
  const CameraSpec spec = WorldCamera();
  const Rigid3 camera_from_lidar = WorldTruth();
  const Rigid3 lidar_from_camera = camera_from_lidar.Inverse();
  std::vector<Eigen::Vector3f> points;
  const auto add = [&](const Eigen::Vector3d& in_camera) {
    points.emplace_back((lidar_from_camera * in_camera).cast<float>());
  };
  add({0.4, -0.3, 2});
  add({0, 0, -2});                                             // behind it
  add({3, 0, 2});                                              // beside its image
  points.emplace_back(kNotANumber, kNotANumber, kNotANumber);  // a miss
  add({-0.8, 0.5, 5});
  const auto laid = LayOnImage(spec, camera_from_lidar, points);
  ASSERT_EQ(laid.size(), 2U);  // of two, no order is another than theirs
  const Camera camera(spec);
  std::size_t at = 0;
  for (const Eigen::Vector3d& in_camera : {Eigen::Vector3d(0.4, -0.3, 2), {-0.8, 0.5, 5}}) {
    EXPECT_THAT(laid[at].head<2>(), EigenNear(*camera.Project(in_camera), 0.01));
    EXPECT_NEAR(laid[at++].z(), in_camera.norm(), 1e-3);
  }
}

TEST(LayOnImage, IsThinnedEvenly) {
  const Rigid3 lidar_from_camera = WorldTruth().Inverse();
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 40'000; ++i) {
    const int row = i / 200;
    const Eigen::Vector3d in_camera(i % 200 * 0.005 - 0.5, row * 0.004 - 0.4, 2);
    points.emplace_back((lidar_from_camera * in_camera).cast<float>());
  }
  ASSERT_EQ(LayOnImage(WorldCamera(), WorldTruth(), points, 40'000).size(), 40'000U);
  const auto laid = LayOnImage(WorldCamera(), WorldTruth(), points, 4000);
  ASSERT_EQ(laid.size(), 4000U);
  int left = 0, upper = 0;
  // Of what is left, again, the first half.
  for (std::size_t i = 0; i < 2000; ++i) {
    const Eigen::Vector3d& point = laid[i];
    left += point.x() < 318.3 ? 1 : 0;
    upper += point.y() < 241.2 ? 1 : 0;
  }
  EXPECT_NEAR(left, 1000, 40);  // by chance 22 is one sigma
  EXPECT_NEAR(upper, 1000, 40);
}

TEST(OverlayFrame, ArraysAreFlatAndAlwaysThere) {
  Overlay overlay;
  overlay.camera = "rgb";
  overlay.view = "0001";
  overlay.utime = 17;
  overlay.text = "</script>\xff";
  overlay.corners = {{1, 2}, {3, 4}};
  overlay.edge = {{5, 6, 7}};
  const ParsedFrame frame = Parse(OverlayFrame(overlay, true));
  EXPECT_EQ(frame.header.at("type"), "overlay");
  EXPECT_EQ(frame.header.at("camera"), "rgb");
  EXPECT_EQ(frame.header.at("utime"), 17);
  EXPECT_EQ(frame.header.at("calibrated"), false);
  EXPECT_EQ(frame.header.at("text"), "</script>\xEF\xBF\xBD");
  EXPECT_THAT(frame.Floats("corners"), testing::ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(frame.Floats("edge"), testing::ElementsAre(5, 6, 7));
  EXPECT_TRUE(frame.Floats("outline").empty());
  EXPECT_TRUE(frame.Floats("cloud").empty());
}

// A board 4 m ahead that faces the LIDAR, 1.2 m x 0.9 m, bright where `bright` says.
template <typename Bright>
cv::Mat Thumb(Bright bright) {
  CloudEdges board;
  board.centre = {4, 0, 0};
  board.normal = {-1, 0, 0};
  board.width_m = 1.2;
  board.height_m = 0.9;
  board.spacing_m = 0.02;
  Cloud cloud;
  for (double y = -0.6; y <= 0.6; y += 0.02) {
    for (double z = -0.45; z <= 0.45; z += 0.02) {
      cloud.points.emplace_back(4, y, z);
      cloud.intensity.push_back(bright(y, z) ? 0.7F : 0.1F);
    }
  }
  cloud.points.emplace_back(kNotANumber, kNotANumber, kNotANumber);
  cloud.intensity.push_back(0.5F);
  const ParsedFrame frame = Parse(BoardThumbFrame("0001", board, cloud));
  EXPECT_EQ(frame.header.at("type"), "thumb");
  EXPECT_EQ(frame.header.at("view"), "0001");
  EXPECT_EQ(frame.header.at("camera"), "");
  EXPECT_EQ(frame.header.at("width"), 240);
  return frame.Jpeg();
}

double Light(const cv::Mat& picture, const cv::Rect& where) { return cv::mean(picture(where))[1]; }

TEST(BoardThumbFrame, IsUprightAsSeenFromTheLidar) {
  const cv::Rect upper(60, 45, 120, 40), lower(60, 95, 120, 40);
  const cv::Rect left(60, 50, 50, 80), right(130, 50, 50, 80);
  const cv::Mat by_height = Thumb([](double, double z) { return z > 0; });
  ASSERT_EQ(by_height.size(), cv::Size(240, 180));
  EXPECT_GT(Light(by_height, upper), Light(by_height, lower) + 100);
  EXPECT_NEAR(Light(by_height, left), Light(by_height, right), 12);
  const cv::Mat by_side = Thumb([](double y, double) { return y > 0; });  // y is to the left
  EXPECT_GT(Light(by_side, left), Light(by_side, right) + 100);
  EXPECT_LT(Light(by_side, cv::Rect(0, 0, 20, 20)), 45);  // nothing is there
}

}  // namespace
}  // namespace rgbdt
