#include <gtest/gtest.h>

#include "calib/camera/camera.h"
#include "calib/detect/image/image_edges.h"
#include "calib/simulate/internal/board.h"
#include "calib/simulate/simulator.h"
#include "tests/study/image_scenes.h"

namespace rgbdt {
namespace {

study::SceneClass ColourAtNight() {
  for (const study::SceneClass& c : study::SceneClasses()) {
    if (c.name == "color_night") return c;
  }
  throw std::logic_error("no such class");
}

CameraSpec ColourCamera(const study::SceneClass& scene_class) {
  return simulate::Simulator(study::SceneOptions(scene_class, 0, 5)).rig().cameras[0];
}

// OpenCV says where to look, and no more: corners are as exact as those that are found without it.
TEST(MeasureWhereOpenCvSees, MeasuresTheBoardsCorners) {
  const study::SceneClass scene_class = ColourAtNight();
  const CameraSpec spec = ColourCamera(scene_class);
  study::RenderScenes(scene_class, 1, 5, [&](int, const study::ImageScene& scene) {
    const ImageEdgesResult found =
        MeasureWhereOpenCvSees(scene.image, Camera(spec), scene.target, spec.kind);
    ASSERT_TRUE(found.edges) << found.why;
    std::size_t seen = 0;
    for (std::size_t i = 0; i < scene.corners.size(); ++i) {
      if (!IsSeen(found.edges->corners[i])) continue;
      ++seen;
      EXPECT_LT((found.edges->corners[i] - scene.corners[i]).norm(), 1.0) << i;
    }
    EXPECT_GE(10 * seen, 9 * scene.corners.size());
    EXPECT_FALSE(found.edges->picked);
    // Of another count of squares there is none.
    Target other = scene.target;
    --other.squares_x;
    EXPECT_FALSE(MeasureWhereOpenCvSees(scene.image, Camera(spec), other, spec.kind).edges);
  });
}

TEST(MeasureWhereOpenCvSees, WhereItSeesNothingThereIsNothingToSay) {
  const CameraSpec spec = ColourCamera(ColourAtNight());
  Image image;
  image.camera = spec.name;
  image.format = PixelFormat::kMono8;
  image.pixels = cv::Mat(spec.height, spec.width, CV_8UC1, cv::Scalar(90));
  Target target = simulate::MakeTarget({});
  for (const int squares : {target.squares_x, 3}) {  // OpenCV takes no fewer than 3 corners
    target.squares_x = squares;
    const ImageEdgesResult found = MeasureWhereOpenCvSees(image, Camera(spec), target, spec.kind);
    EXPECT_FALSE(found.edges);
    EXPECT_EQ(found.why, "");
  }
}

}  // namespace
}  // namespace rgbdt
