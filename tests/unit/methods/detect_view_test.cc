#include "calib/methods/detect_view.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "calib/camera/camera.h"
#include "calib/camera/pixels.h"
#include "calib/detect/image/checkerboard.h"
#include "calib/detect/image/image_edges.h"
#include "calib/methods/paper/cloud_edges.h"
#include "calib/model/errors.h"
#include "tests/unit/detect/image/covered_board.h"
#include "tests/unit/detect/image/synthetic_view.h"

namespace rgbdt {
namespace {

using ::testing::HasSubstr;

// One rendered view serves all tests: rendering costs seconds.
class Detect : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { made_ = new SyntheticView(MakeView(1)); }
  static void TearDownTestSuite() {
    delete made_;
    made_ = nullptr;
  }

  static Rigid3 CameraFromTarget(const std::string& camera) {
    return made_->truth.camera_from_lidar.at(camera) * made_->truth.lidar_from_target.at("0001");
  }
  static const Image& ImageOf(const std::string& camera) {
    return made_->view.images[camera == "rgb" ? 0 : 1];
  }

  static SyntheticView* made_;
};

SyntheticView* Detect::made_ = nullptr;

// Distance [m] of a point in the board's plane to the board's outline; negative inside.
double OutsideOf(const Target& target, const Eigen::Vector3d& p) {
  return std::max(std::abs(p.x()) - 0.5 * target.width_m, std::abs(p.y()) - 0.5 * target.height_m);
}

TEST_F(Detect, CheckerboardCornersAreWhereTheTruthProjects) {
  const CameraSpec& spec = made_->rig.Camera("rgb");
  const Camera camera(spec);
  const auto found = FindCheckerboard(ToGrey(ImageOf("rgb")), made_->rig.target);
  ASSERT_TRUE(found.board.has_value()) << found.why;
  const auto* corners = &found.board->corners;
  const auto model = made_->rig.target.InnerCorners();
  ASSERT_EQ(corners->size(), model.size());
  // The order is the target's up to a half turn.
  double straight = 0;
  double turned = 0;
  for (std::size_t i = 0; i < model.size(); ++i) {
    const auto pixel = camera.Project(CameraFromTarget("rgb") * model[i]);
    ASSERT_TRUE(pixel.has_value());
    straight += ((*corners)[i] - *pixel).norm();
    turned += ((*corners)[model.size() - 1 - i] - *pixel).norm();
  }
  EXPECT_LT(std::min(straight, turned) / static_cast<double>(model.size()), 0.1);
}

TEST_F(Detect, EdgePixelsLieInTheBandOfTheTrueOutline) {
  for (const std::string name : {"rgb", "thermal"}) {
    const Camera camera(made_->rig.Camera(name));
    const CornerSelection* picks = name == "thermal" ? &made_->thermal_picks : nullptr;
    const auto result = DetectImageEdges(ImageOf(name), camera, made_->rig.target, picks);
    ASSERT_TRUE(result.edges.has_value()) << name << ": " << result.why;
    EXPECT_EQ(result.edges->picked, name == "thermal");
    const auto corners = made_->rig.target.OutlineCorners();
    std::vector<Eigen::Vector2d> outline;
    for (std::size_t i = 0; i < 4; ++i) {
      const auto side = ProjectSegment(camera, CameraFromTarget(name) * corners[i],
                                       CameraFromTarget(name) * corners[(i + 1) % 4], 2000);
      outline.insert(outline.end(), side.begin(), side.end());
    }
    // Half a 5x5 window's diagonal, and for picks 4 sigma of 1.5 px.
    const double band = 2 * std::sqrt(2.0) + 1 + (picks != nullptr ? 6.0 : 0.0);
    for (const Eigen::Vector2i& p : result.edges->edge_pixels) {
      double nearest = 1e9;
      for (const Eigen::Vector2d& q : outline) {
        nearest = std::min(nearest, (p.cast<double>() - q).norm());
      }
      ASSERT_LE(nearest, band) << name;
    }
    EXPECT_GT(result.edges->edge_pixels.size(), outline.size() / 100) << name;
  }
}

TEST_F(Detect, PicksThatAreNoQuadrangleAreRefusedWithTheReason) {
  const Camera camera(made_->rig.Camera("thermal"));
  CornerSelection crossed = made_->thermal_picks;
  std::swap(crossed.corners[0], crossed.corners[1]);
  EXPECT_THAT(DetectImageEdges(ImageOf("thermal"), camera, made_->rig.target, &crossed).why,
              HasSubstr("in order"));
  CornerSelection outside = made_->thermal_picks;
  outside.corners[0] = {-50, -40};
  EXPECT_THAT(DetectImageEdges(ImageOf("thermal"), camera, made_->rig.target, &outside).why,
              HasSubstr("outside the image"));
  CornerSelection same = made_->thermal_picks;
  same.corners[1] = same.corners[0];
  EXPECT_THAT(DetectImageEdges(ImageOf("thermal"), camera, made_->rig.target, &same).why,
              HasSubstr("same point"));
}

// The candidate that is the board; null: there is none.
const CloudEdges* BoardAmong(const CloudDetection& cloud, const Rigid3& lidar_from_target) {
  for (const CloudEdges& candidate : cloud.candidates) {
    if ((candidate.centre - lidar_from_target.translation).norm() < 0.1) return &candidate;
  }
  return nullptr;
}

TEST_F(Detect, LinesOfTheScannerLieOnTheBoard) {
  const Rigid3 lidar_from_target = made_->truth.lidar_from_target.at("0001");
  const ViewDetection detection = DetectView(made_->rig, made_->view, kLineScanMethod);
  const CloudEdges* board = BoardAmong(detection.cloud, lidar_from_target);
  ASSERT_NE(board, nullptr) << detection.cloud.why_not;
  const Eigen::Vector3d normal = lidar_from_target.rotation * Eigen::Vector3d::UnitZ();
  std::set<int> lines;
  for (const PointGroup& line : board->groups) {
    EXPECT_GE(line.ring, 0);
    EXPECT_TRUE(lines.insert(line.ring).second) << line.ring << " stands there twice";
    const double points = line.scatter(3, 3);
    const Eigen::Vector3d mean = board->centre + line.scatter.col(3).head<3>() / points;
    // Range noise of 10 mm, and half of that for where the plane is: 4 sigma.
    EXPECT_LT(std::abs(normal.dot(mean - lidar_from_target.translation)),
              4 * std::hypot(0.01 / std::sqrt(points), 0.005));
  }
  EXPECT_GT(lines.size(), 20U);
}

TEST_F(Detect, OutlineCornersArePickedWithinABeamsSpacing) {
  const Rigid3 lidar_from_target = made_->truth.lidar_from_target.at("0001");
  const ViewDetection detection = DetectView(made_->rig, made_->view, kBearingAngleMethod);
  const CloudEdges* board = BoardAmong(detection.cloud, lidar_from_target);
  ASSERT_NE(board, nullptr) << detection.cloud.why_not;
  ASSERT_EQ(board->corners.size(), 4U);
  const bool turned = RotationDistance(board->pose->sensor_from_target, lidar_from_target) > 1;
  const auto truth = made_->rig.target.OutlineCorners();
  for (std::size_t k = 0; k < 4; ++k) {
    ASSERT_TRUE(board->corners[k].allFinite()) << k;
    const Eigen::Vector3d off =
        lidar_from_target.Inverse() * board->corners[k] - truth[(k + (turned ? 2 : 0)) % 4];
    // A spacing along each axis, and the beam's own width; 4 sigma of the range across.
    EXPECT_LT(off.head<2>().norm(), std::sqrt(2.0) * board->spacing_m + 0.02) << k;
    EXPECT_LT(std::abs(off.z()), 0.04) << k;
  }
}

TEST_F(Detect, TheBoardIsAmongThePlanesOfItsSize) {
  const Rigid3 lidar_from_target = made_->truth.lidar_from_target.at("0001");
  const ViewDetection detection = DetectView(made_->rig, made_->view, kSingleShotMethod);
  const CloudEdges* board = BoardAmong(detection.cloud, lidar_from_target);
  ASSERT_NE(board, nullptr) << detection.cloud.why_not;
  EXPECT_FALSE(board->pose);
  EXPECT_GT(std::abs(board->normal.dot(lidar_from_target.rotation * Eigen::Vector3d::UnitZ())),
            std::cos(0.02));
}

TEST_F(Detect, BoundaryPointsLieOnTheBoardsEdge) {
  const ViewDetection detection = DetectView(made_->rig, made_->view, kPaperMethod);
  ASSERT_EQ(detection.images.size(), 2U);
  ASSERT_TRUE(detection.images[0].usable() && detection.images[1].usable());
  ASSERT_EQ(detection.cloud.candidates.size(), 2U) << "one a camera: " << detection.cloud.why_not;
  EXPECT_EQ(detection.cloud.candidates[0].camera, "rgb");
  EXPECT_EQ(detection.cloud.candidates[1].camera, "thermal");
  const CloudEdges& edges = detection.cloud.candidates[0];
  const Rigid3 target_from_lidar = made_->truth.lidar_from_target.at("0001").Inverse();
  int near_edge = 0;
  for (const Eigen::Vector3d& point : edges.boundary) {
    const Eigen::Vector3d p = target_from_lidar * point;
    // Smoothed: well within the range noise of 10 mm (3 sigma) of the board's plane.
    EXPECT_LT(std::abs(p.z()), 0.03);
    near_edge += std::abs(OutsideOf(made_->rig.target, p)) < 2 * edges.spacing_m ? 1 : 0;
  }
  EXPECT_GT(near_edge, 0.95 * static_cast<double>(edges.boundary.size()));
  // About one boundary point for each spacing along the outline.
  const double outline = 2 * (made_->rig.target.width_m + made_->rig.target.height_m);
  EXPECT_GT(static_cast<double>(edges.boundary.size()), 0.5 * outline / edges.spacing_m);
  // Too small by up to a spacing at each end (points lie on the board); too large by half a beam of
  // 2.7 mrad and by 3 sigma of the range noise (10 mm) seen along a plane tilted by up to 40 deg.
  const simulate::Options physics;
  const double smaller = 2 * edges.spacing_m;
  const double larger = physics.scanner.divergence_rad * edges.centre.norm() +
                        2 * 3 * physics.scanner.range_sigma_m * std::sin(physics.pose.max_tilt_rad);
  EXPECT_GT(edges.width_m, made_->rig.target.width_m - smaller);
  EXPECT_LT(edges.width_m, made_->rig.target.width_m + larger);
  EXPECT_GT(edges.height_m, made_->rig.target.height_m - smaller);
  EXPECT_LT(edges.height_m, made_->rig.target.height_m + larger);
  const Eigen::Vector3d normal =
      made_->truth.lidar_from_target.at("0001").rotation * Eigen::Vector3d(0, 0, -1);
  EXPECT_GT(edges.normal.dot(normal), std::cos(0.01));
}

TEST_F(Detect, TheSameCloudGivesTheSameBits) {
  const Camera camera(made_->rig.Camera("rgb"));
  const auto found = FindCheckerboard(ToGrey(ImageOf("rgb")), made_->rig.target);
  ASSERT_TRUE(found.board.has_value()) << found.why;
  const std::vector<Eigen::Vector2d>& corners = found.board->corners;
  const Rigid3 guess = *made_->rig.Camera("rgb").camera_from_lidar_guess;
  const auto first = DetectCloudEdges(made_->view.cloud, camera, guess, corners, made_->rig.target);
  const auto second =
      DetectCloudEdges(made_->view.cloud, camera, guess, corners, made_->rig.target);
  ASSERT_TRUE(first.edges && second.edges);
  EXPECT_EQ(first.edges->boundary, second.edges->boundary);
}

TEST_F(Detect, ABoardOfAnotherSizeIsRefusedWithBothSizes) {
  Rig rig = made_->rig;
  rig.target.width_m = 2.4;
  rig.target.height_m = 1.8;
  const ViewDetection detection = DetectView(rig, made_->view, kPaperMethod);
  EXPECT_TRUE(detection.cloud.candidates.empty());
  EXPECT_THAT(detection.cloud.why_not, HasSubstr("rgb: "));
  EXPECT_THAT(detection.cloud.why_not, HasSubstr("2.40 x 1.80 m"));
  EXPECT_THAT(detection.cloud.why_not, HasSubstr("1.2"));
}

TEST_F(Detect, EachAbsenceHasItsReason) {
  View view = made_->view;
  view.images.pop_back();
  const ViewDetection imageless = DetectView(made_->rig, view, kPaperMethod);
  EXPECT_THAT(imageless.images[1].why_not, HasSubstr("no image of this camera"));
  EXPECT_EQ(imageless.images[1].utime, 0);
  EXPECT_TRUE(imageless.images[0].usable());
  ASSERT_EQ(imageless.cloud.candidates.size(), 1U);
  EXPECT_EQ(imageless.cloud.candidates[0].camera, "rgb");

  view = made_->view;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (Eigen::Vector3f& p : view.cloud.points) p = Eigen::Vector3f::Constant(nan);
  EXPECT_THAT(DetectView(made_->rig, view, kPaperMethod).cloud.why_not,
              HasSubstr("the cloud has 0 points"));

  view = made_->view;
  for (std::size_t i = 0; i < 5U * 400U; ++i) {
    view.cloud.points[i] = Eigen::Vector3f::Constant(nan);
    view.cloud.directions[i] = Eigen::Vector3f::Constant(nan);
  }
  EXPECT_THAT(DetectView(made_->rig, view, kPaperMethod).cloud.why_not,
              HasSubstr("5 of the sweep's 300 lines"));

  view = made_->view;
  for (Eigen::Vector3f& p : view.cloud.points) p.x() = -p.x();
  EXPECT_THAT(DetectView(made_->rig, view, kPaperMethod).cloud.why_not,
              HasSubstr("near the checkerboard's corners"));

  Rig rig = made_->rig;
  rig.cameras[0].camera_from_lidar_guess.reset();
  const ViewDetection unguessed = DetectView(rig, made_->view, kPaperMethod);
  EXPECT_THAT(unguessed.cloud.why_not, HasSubstr("rgb: "));
  EXPECT_THAT(unguessed.cloud.why_not, HasSubstr("camera_from_lidar_guess"));
  ASSERT_EQ(unguessed.cloud.candidates.size(), 1U) << "thermal has a guess";
  EXPECT_EQ(unguessed.cloud.candidates[0].camera, "thermal");
}

TEST_F(Detect, TheBoardFindsItselfWithoutPicksAndWithoutAGuess) {
  Rig rig = made_->rig;
  View view = made_->view;
  view.picks.clear();
  for (CameraSpec& camera : rig.cameras) camera.camera_from_lidar_guess.reset();
  const ViewDetection detection = DetectView(rig, view);
  EXPECT_EQ(detection.view, "0001");
  EXPECT_EQ(detection.sweep_utime, view.cloud.sweep_utime);
  EXPECT_EQ(detection.cloud.why_not, "");
  ASSERT_EQ(detection.cloud.candidates.size(), 1U);
  EXPECT_EQ(detection.cloud.candidates[0].camera, "") << "every camera's";
  const TargetPose& pose = *detection.cloud.candidates[0].pose;
  const Rigid3& truth = made_->truth.lidar_from_target.at("0001");
  EXPECT_LT((pose.sensor_from_target.translation - truth.translation).norm(), 0.01);
  ASSERT_EQ(detection.images.size(), 2U);
  for (const ImageDetection& image : detection.images) {
    ASSERT_TRUE(image.usable()) << image.why_not;
    ASSERT_TRUE(image.edges->pose);
    EXPECT_EQ(image.edges->pose->half_turn_known, image.camera == "rgb");
  }
}

TEST_F(Detect, TheCloudIsLookedAtWhereImagesFail) {
  View view = made_->view;
  for (Image& image : view.images) {  // the pixels of made_ are shared: not in place
    image.pixels = cv::Mat(image.pixels.size(), image.pixels.type(), cv::Scalar(90));
  }
  view.picks.clear();
  const ViewDetection blind = DetectView(made_->rig, view);
  for (const ImageDetection& image : blind.images) {
    EXPECT_FALSE(image.usable());
    EXPECT_THAT(image.why_not, HasSubstr("the image is constant"));
  }
  const ViewDetection seeing = DetectView(made_->rig, made_->view);
  ASSERT_EQ(blind.cloud.candidates.size(), 1U) << blind.cloud.why_not;
  ASSERT_EQ(seeing.cloud.candidates.size(), 1U);
  EXPECT_EQ(blind.cloud.why_not, "");
  EXPECT_EQ(blind.cloud.candidates[0].boundary, seeing.cloud.candidates[0].boundary);
  EXPECT_THAT(BriefReport(blind), HasSubstr("; cloud: board found"));
  // The paper's method has nothing to look for it with.
  const ViewDetection by_paper = DetectView(made_->rig, view, kPaperMethod);
  EXPECT_TRUE(by_paper.cloud.candidates.empty());
  EXPECT_THAT(by_paper.cloud.why_not, HasSubstr("not searched"));
}

TEST_F(Detect, ImagesAreLookedAtWhereTheCloudFails) {
  View view = made_->view;
  for (Eigen::Vector3f& p : view.cloud.points) {
    p = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  }
  const ViewDetection detection = DetectView(made_->rig, view);
  EXPECT_TRUE(detection.cloud.candidates.empty());
  EXPECT_NE(detection.cloud.why_not, "");
  for (const ImageDetection& image : detection.images) EXPECT_TRUE(image.usable()) << image.why_not;
  EXPECT_EQ(BriefReport(detection),
            "rgb: board found; thermal: board found; cloud: " + detection.cloud.why_not);
}

TEST_F(Detect, PicksAreNotLookedAtWhereTheBoardFindsItself) {
  View view = made_->view;
  view.picks = {made_->thermal_picks};
  for (Eigen::Vector2d& pick : view.picks[0].corners) pick += Eigen::Vector2d(40, 0);
  const ImageDetection with = DetectView(made_->rig, view).images[1];
  const ImageDetection without = DetectView(made_->rig, made_->view).images[1];
  ASSERT_TRUE(with.usable() && without.usable()) << with.why_not << without.why_not;
  EXPECT_FALSE(with.edges->picked);
  EXPECT_EQ(with.edges->corners, without.edges->corners);
}

TEST_F(Detect, PicksRescueAViewInWhichTheBoardIsPartlyHidden) {
  View view = made_->view;
  Random random(5);
  for (Image& image : view.images) {
    const Camera camera(made_->rig.Camera(image.camera));
    const Rigid3 truth = CameraFromTarget(image.camera);
    image.pixels = image.pixels.clone();
    PaintCover(camera, made_->rig.target, truth, Cover::kPerson, 0.1, &random, &image.pixels);
    view.picks.push_back(PicksNear(camera, made_->rig.target, truth, 4, &random));
    view.picks.back().camera = image.camera;
  }
  View unpicked = view;
  unpicked.picks.clear();
  const ViewDetection with = DetectView(made_->rig, view);
  const ViewDetection without = DetectView(made_->rig, unpicked);
  EXPECT_FALSE(with.cloud.candidates.empty()) << with.cloud.why_not;
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_THAT(without.images[i].why_not, HasSubstr("no checkerboard"));
    const ImageDetection& image = with.images[i];
    ASSERT_TRUE(image.usable()) << image.why_not;
    EXPECT_TRUE(image.edges->picked);
    ASSERT_TRUE(image.edges->pose);
    EXPECT_EQ(image.edges->pose->half_turn_known, image.camera == "rgb");
    const auto& corners = image.edges->corners;
    const auto seen = std::count_if(corners.begin(), corners.end(), IsSeen);
    EXPECT_GT(seen, 25);
    EXPECT_LT(seen, 60);
    EXPECT_GT(image.edges->corner_sigma_px, 0);
  }
  // Picks on something else.
  for (CornerSelection& picks : view.picks) {
    for (Eigen::Vector2d& pick : picks.corners) pick = 0.5 * pick + Eigen::Vector2d(10, 20);
  }
  for (const ImageDetection& image : DetectView(made_->rig, view).images) {
    EXPECT_FALSE(image.edges);
    EXPECT_THAT(image.why_not, HasSubstr("corner"));
  }
}

TEST_F(Detect, ABoardThatMovedDuringTheSweepRejectsTheImage) {
  View view = made_->view;
  Image earlier = view.images[0];
  earlier.utime = view.cloud.sweep_utime + 1'000'000;
  cv::Mat moved;
  const cv::Mat shift = (cv::Mat_<double>(2, 3) << 1, 0, 4, 0, 1, 2);  // even: keeps the mosaic
  cv::warpAffine(earlier.pixels, moved, shift, earlier.pixels.size(), cv::INTER_NEAREST,
                 cv::BORDER_REPLICATE);
  view.images.push_back(earlier);  // the same: it stood still
  const ViewDetection still = DetectView(made_->rig, view);
  EXPECT_TRUE(still.images[0].usable()) << still.images[0].why_not;
  view.images.back().pixels = moved;
  const ViewDetection detection = DetectView(made_->rig, view);
  EXPECT_THAT(detection.images[0].why_not, HasSubstr("board moved"));
  EXPECT_TRUE(detection.images[0].edges) << "known all the same";
  EXPECT_TRUE(detection.images[1].usable()) << "thermal has no such image";
  EXPECT_FALSE(detection.cloud.candidates.empty()) << detection.cloud.why_not;
}

TEST_F(Detect, AnImageOfAnotherSizeIsAnErrorWithBothSizes) {
  View view = made_->view;
  view.images[0].pixels = cv::Mat::zeros(100, 200, CV_8U);
  try {
    DetectView(made_->rig, view, kPaperMethod);
    FAIL() << "expected InputError";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("200x100"));
    EXPECT_THAT(e.what(), HasSubstr("1936x1456"));
  }
}

}  // namespace
}  // namespace rgbdt
