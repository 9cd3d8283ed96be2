#include "calib/present/pictures/colouring_picture.h"

#include <gtest/gtest.h>

#include <limits>
#include <opencv2/imgproc.hpp>

namespace rgbdt {
namespace {

CameraSpec Spec(Lens::Model model, double f, int width, int height) {
  CameraSpec spec;
  spec.name = "rgb";
  spec.width = width;
  spec.height = height;
  spec.lens = {model, f, f, 0.5 * (width - 1), 0.5 * (height - 1), {}};
  return spec;
}

// 1 mm along x, a hundredth of a degree about each axis.
Matrix6d Covariance() {
  Vector6d sigma;
  sigma << 2e-4, 2e-4, 2e-4, 1e-3, 1e-5, 1e-5;
  return sigma.array().square().matrix().asDiagonal();
}

CameraCalibration Calibrated(const Matrix6d& covariance = Covariance()) {
  return {"rgb", Rigid3(), covariance, SolveStatus::kConverged, ""};
}

// The four maps' middles, in their order: 2, 5, 10, 50 m. The layout is two by two above a bar.
cv::Mat MapOf(const cv::Mat& picture, int index) {
  const int half = picture.cols / 2;
  const int height = (picture.rows - 120) / 2;
  return picture(cv::Rect(index % 2 * half, index / 2 * height, half, height));
}

double Brightness(const cv::Mat& map) {
  const cv::Rect beside_middle(map.cols / 2 - 60, map.rows / 2 + 20, 40, 60);
  const cv::Scalar mean = cv::mean(map(beside_middle));
  return 0.114 * mean[0] + 0.587 * mean[1] + 0.299 * mean[2];
}

TEST(ColouringPicture, IsTheBrighterTheLessSure) {
  const cv::Mat picture =
      ColouringPicture(Spec(Lens::Model::kPinhole, 1000, 1000, 800), Calibrated());
  ASSERT_EQ(picture.type(), CV_8UC3);
  // A translation of 1 mm fades: 0.5 px at 2 m, 0.02 px at 50 m, beside the rotation's 0.28.
  EXPECT_GT(Brightness(MapOf(picture, 0)), Brightness(MapOf(picture, 1)) + 20);
  EXPECT_GT(Brightness(MapOf(picture, 1)), Brightness(MapOf(picture, 3)) + 5);
}

TEST(ColouringPicture, BeyondTheLensIsGrey) {
  // Half of the image's width is 4 radians: what is past 3.14 looks nowhere.
  const cv::Mat picture =
      ColouringPicture(Spec(Lens::Model::kFisheye, 100, 800, 400), Calibrated());
  const cv::Mat map = MapOf(picture, 0);
  EXPECT_EQ(map.at<cv::Vec3b>(map.rows / 2, 30), cv::Vec3b::all(200));
  EXPECT_NE(map.at<cv::Vec3b>(map.rows / 2 + 40, map.cols / 2), cv::Vec3b::all(200));
}

TEST(ColouringPicture, AnyShapeOfImageAndAnySizeOfSigmaCanBeDrawn) {
  for (const double scale : {0.0, 1e-12, 1.0, 1e12}) {
    for (const cv::Size& size : {cv::Size(640, 480), cv::Size(2000, 40), cv::Size(100, 3000)}) {
      const CameraSpec spec = Spec(Lens::Model::kPinhole, 500, size.width, size.height);
      EXPECT_FALSE(ColouringPicture(spec, Calibrated(scale * Covariance())).empty())
          << size << " " << scale;
    }
  }
}

TEST(ColouringPicture, IsEmptyWithoutASigma) {
  const CameraSpec spec = Spec(Lens::Model::kPinhole, 500, 640, 480);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(ColouringPicture(spec, Calibrated(Matrix6d::Constant(nan))).empty());
  EXPECT_TRUE(ColouringPicture(spec, CameraCalibration()).empty());
}

TEST(ColouringPicture, TheSameInputGivesTheSameBytes) {
  const CameraSpec spec = Spec(Lens::Model::kPinhole, 500, 640, 480);
  const cv::Mat a = ColouringPicture(spec, Calibrated());
  const cv::Mat b = ColouringPicture(spec, Calibrated());
  EXPECT_EQ(cv::norm(a, b, cv::NORM_INF), 0);
}

}  // namespace
}  // namespace rgbdt
