#include "calib/simulate/internal/lens_table.h"

#include <gtest/gtest.h>

#include "calib/model/errors.h"
#include "tests/unit/simulate/simulate_testing.h"

namespace rgbdt::simulate {
namespace {

/// The default lenses, and one with OpenCV's rational terms.
std::vector<CameraOptions> Cameras() {
  std::vector<CameraOptions> cameras{DefaultColorCamera(), DefaultThermalCamera(),
                                     DefaultColorCamera()};
  cameras[2].lens.distortion = {0.2, -0.05, 1e-3, -7e-4, 0.01, 0.25, -0.02, 0.004};
  return cameras;
}

TEST(LensTable, RaysOfPixelsProjectBackByOpenCv) {
  for (const CameraOptions& camera : Cameras()) {
    LensTable lens(camera.lens, camera.width, camera.height);
    lens.Fill();
    std::vector<cv::Point3d> points;
    std::vector<cv::Point2d> expected;
    for (int row = 0; row < camera.height; row += 37) {
      for (int column = 0; column < camera.width; column += 41) {
        const Eigen::Vector2d& p = lens.At(column, row);
        points.emplace_back(p.x(), p.y(), 1);
        expected.emplace_back(column, row);
      }
    }
    points.emplace_back(lens.At(camera.width - 1, camera.height - 1).x(),
                        lens.At(camera.width - 1, camera.height - 1).y(), 1);
    expected.emplace_back(camera.width - 1, camera.height - 1);
    const std::vector<cv::Point2d> pixels = OpenCvPixels(camera.lens, points);
    double worst = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      worst = std::max(worst, cv::norm(pixels[i] - expected[i]));
    }
    EXPECT_LT(worst, 1e-6) << camera.name;
  }
}

TEST(LensTable, ProjectAgreesWithOpenCv) {
  for (const CameraOptions& camera : Cameras()) {
    const LensTable lens(camera.lens, camera.width, camera.height);
    for (const Eigen::Vector3d& p :
         {Eigen::Vector3d(0, 0, 2), Eigen::Vector3d(0.4, -0.3, 1), Eigen::Vector3d(-1.5, 1, 3)}) {
      const auto pixel = lens.Project(p);
      ASSERT_TRUE(pixel);
      const cv::Point2d expected =
          OpenCvPixels(camera.lens, std::vector<cv::Point3d>{{p.x(), p.y(), p.z()}})[0];
      EXPECT_NEAR(pixel->x(), expected.x, 1e-9);
      EXPECT_NEAR(pixel->y(), expected.y, 1e-9);
    }
  }
}

TEST(LensTable, ProjectsNothingBehindOrFarOutside) {
  const CameraOptions camera = DefaultColorCamera();
  const LensTable lens(camera.lens, camera.width, camera.height);
  EXPECT_FALSE(lens.Project({0, 0, -1}));
  EXPECT_FALSE(lens.Project({5, 0, 1}));
}

TEST(LensTable, CheckRefusesALensThatFoldsBackInTheImage) {
  CameraOptions camera = DefaultColorCamera();
  camera.lens.distortion = {-0.6, 0, 0, 0, 0, 0, 0, 0};
  EXPECT_THROW(CheckLens(camera.lens, camera.width, camera.height, "lens"), InputError);
  camera = DefaultColorCamera();
  camera.lens.model = Lens::Model::kFisheye;
  EXPECT_THROW(CheckLens(camera.lens, camera.width, camera.height, "lens"), InputError);
}

}  // namespace
}  // namespace rgbdt::simulate
