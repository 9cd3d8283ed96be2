#include "calib/solve/camera_views.h"

#include "calib/solve/evaluate.h"
#include "tests/unit/solve/solve_world.h"

namespace rgbdt {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// Of one view: the board is seen by "rgb", "thermal" and LIDAR.
ViewDetection OneView() {
  SolveWorldOptions options;
  options.views = 1;
  return SolveWorld(options).detections[0];
}

void Fail(ImageDetection* image, const std::string& why) {
  image->edges.reset();
  image->why_not = why;
}

void Fail(CloudDetection* cloud, const std::string& why) {
  cloud->candidates.clear();
  cloud->why_not = why;
}

TEST(CameraViewOf, PairsACamerasImageWithTheLikeliestCandidate) {
  ViewDetection detection = OneView();
  detection.heldout = true;
  detection.cloud.candidates.push_back(detection.cloud.candidates[0]);
  detection.cloud.candidates[1].centre.x() += 1;
  const CameraView view = CameraViewOf("thermal", detection);
  EXPECT_TRUE(view.usable());
  EXPECT_EQ(view.view, "0001");
  EXPECT_TRUE(view.heldout);
  EXPECT_EQ(view.image_utime, detection.images[1].utime);
  EXPECT_EQ(view.image, &*detection.images[1].edges);
  EXPECT_THAT(view.candidates,
              ElementsAre(&detection.cloud.candidates[0], &detection.cloud.candidates[1]));
  EXPECT_EQ(view.cloud->centre, detection.cloud.candidates[0].centre);
}

TEST(CameraViewOf, OneCamerasImageSaysNothingOfTheOther) {
  ViewDetection detection = OneView();
  Fail(&detection.images[0], "no checkerboard");
  EXPECT_EQ(CameraViewOf("rgb", detection).rejected, "no checkerboard");
  EXPECT_TRUE(CameraViewOf("thermal", detection).usable());
}

TEST(CameraViewOf, TellsOfImageAndCloudApart) {
  ViewDetection detection = OneView();
  Fail(&detection.cloud, "no plane of the board's size");
  EXPECT_EQ(CameraViewOf("rgb", detection).rejected, "no plane of the board's size");
  Fail(&detection.images[0], "no checkerboard");
  EXPECT_EQ(CameraViewOf("rgb", detection).rejected,
            "image: no checkerboard; cloud: no plane of the board's size");
  Fail(&detection.cloud, "no checkerboard");
  EXPECT_EQ(CameraViewOf("rgb", detection).rejected, "no checkerboard") << "said once";
}

TEST(CameraViewOf, WhatIsMissingWithoutAReasonIsNamed) {
  const ViewDetection seen = OneView();
  EXPECT_THAT(CameraViewOf("front", seen).rejected, HasSubstr("no image of this camera"));
  ViewDetection detection = seen;
  detection.images[0].edges.reset();
  EXPECT_THAT(CameraViewOf("rgb", detection).rejected, HasSubstr("not found in the image"));
  detection = seen;
  detection.cloud.candidates.clear();
  EXPECT_THAT(CameraViewOf("rgb", detection).rejected, HasSubstr("not found in the cloud"));
}

TEST(CameraViewOf, ABoardThatMovedIsRejectedThoughItsEdgesAreKnown) {
  ViewDetection detection = OneView();
  detection.images[0].why_not = "the board moved";
  const CameraView view = CameraViewOf("rgb", detection);
  EXPECT_EQ(view.rejected, "the board moved");
  EXPECT_NE(view.image, nullptr);
}

// The paper's method: each camera's picks and guess say where to look.
TEST(CameraViewOf, ACandidateOfOneCameraIsItsAlone) {
  ViewDetection detection = OneView();
  detection.cloud.candidates.push_back(detection.cloud.candidates[0]);
  detection.cloud.candidates[0].camera = "thermal";
  detection.cloud.candidates[1].camera = "rgb";
  EXPECT_THAT(CameraViewOf("rgb", detection).candidates,
              ElementsAre(&detection.cloud.candidates[1]));
  detection.cloud.candidates.pop_back();
  detection.cloud.why_not = "rgb: nothing near the corners";
  EXPECT_EQ(CameraViewOf("rgb", detection).rejected, "rgb: nothing near the corners");
  EXPECT_TRUE(CameraViewOf("thermal", detection).usable());
}

TEST(CameraView, TheFirstReasonStays) {
  CameraView view;
  view.Reject("moved");
  view.Reject("contradicts");
  EXPECT_EQ(view.rejected, "moved");
  EXPECT_FALSE(view.usable());
}

TEST(ViewsOf, APartOfABoardCountsOnlyWhereItsSizeIsKnown) {
  SolveWorldOptions options;
  options.views = 3;
  SolveWorld world(options);
  const auto usable = [&](std::size_t camera) {
    return ViewsOf(world.rig.cameras[camera], world.detections).Usable().size();
  };
  for (std::size_t v = 0; v < 3; ++v) world.ImageAt(v, 0).corners[0] = UnseenCorner();
  EXPECT_EQ(usable(0), 3U) << "the other camera sees it whole";
  for (std::size_t v = 0; v < 3; ++v) world.ImageAt(v, 1).corners[7] = UnseenCorner();
  EXPECT_EQ(usable(0), 0U);
  EXPECT_THAT(ViewsOf(world.rig.cameras[0], world.detections).all[0].rejected,
              HasSubstr("no view shows it whole"));
  world.ImageAt(2, 0).picked = true;  // where corners are hidden, a person has said where it is
  EXPECT_EQ(usable(0), 1U);
}

TEST(ViewsOf, ACopyOfAnotherViewCountsOnce) {
  SolveWorldOptions options;
  options.views = 4;
  SolveWorld world(options);
  world.detections[2].images = world.detections[0].images;  // the same image with another sweep
  world.detections[3].cloud = world.detections[1].cloud;    // and the same sweep with another image
  CameraViews views = ViewsOf(world.rig.cameras[0], world.detections);
  EXPECT_EQ(views.Usable().size(), 2U);
  EXPECT_EQ(views.all[2].rejected,
            "its image is that of view " + views.all[0].view + ": it counts once");
  EXPECT_EQ(views.all[3].rejected,
            "its cloud is that of view " + views.all[1].view + ": it counts once");
  views.Describe();
  ASSERT_EQ(views.report.rejected.size(), 2U);
  EXPECT_TRUE(views.report.rejected[0].copy) << "nothing speaks against it";
}

TEST(ViewsOf, ACandidateWithoutBoundaryPointsIsNone) {
  SolveWorldOptions options;
  options.views = 2;
  SolveWorld world(options);
  CloudDetection& cloud = world.detections[0].cloud;
  cloud.candidates.insert(cloud.candidates.begin(), CloudEdges());
  world.CloudAt(1).boundary.clear();
  const CameraViews views = ViewsOf(world.rig.cameras[0], world.detections);
  ASSERT_EQ(views.all.size(), 2U);
  EXPECT_THAT(views.all[0].candidates, ElementsAre(&cloud.candidates[1]));
  EXPECT_EQ(views.all[0].cloud->centre, cloud.candidates[1].centre);
  EXPECT_THAT(views.all[1].rejected, HasSubstr("no boundary points"));
}

// Detection looks 3 px to either side of where the lens that was given has the board's edge.
TEST(PosedAgain, AnOutlineThatWasLookedForInTheWrongPlaceIsWhereTheOtherLensHasIt) {
  SolveWorldOptions options;
  options.views = 1;
  options.noise = 0.1;
  SolveWorld world(options);
  ImageEdges& image = world.ImageAt(0, 0);
  const std::vector<Eigen::Vector2d> truth = image.outline;
  for (Eigen::Vector2d& pixel : image.outline) pixel.x() += 8;
  const auto outline = [&](double fx_factor) {
    CameraSpec given = world.rig.cameras[0];
    given.lens.fx *= fx_factor;
    const CameraViews views =
        PosedAgain(ViewsOf(given, world.detections), world.TrueLens(0), world.rig.target);
    return views.all[0].image->outline;
  };
  EXPECT_EQ(outline(1.002), image.outline) << "what was found in the image";
  for (const Eigen::Vector2d& pixel : outline(1.5)) {
    EXPECT_LT(DistanceToOutline(pixel, truth), 0.5);
  }
}

}  // namespace
}  // namespace rgbdt
