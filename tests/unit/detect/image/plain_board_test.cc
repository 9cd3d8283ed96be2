#include "calib/detect/image/plain_board.h"

#include <gmock/gmock.h>

#include <opencv2/imgproc.hpp>

#include "calib/camera/camera.h"
#include "calib/camera/pixels.h"
#include "calib/detect/image/internal/clipped.h"
#include "calib/detect/image/internal/colour_planes.h"
#include "tests/numbers.h"

namespace rgbdt {
namespace {

CameraSpec Spec() {
  CameraSpec spec;
  spec.name = "rgb";
  spec.width = 960;
  spec.height = 600;
  spec.lens.fx = spec.lens.fy = 1000;
  spec.lens.cx = 470;
  spec.lens.cy = 310;
  return spec;
}

Target Square() {
  Target target;
  target.width_m = target.height_m = 1;
  return target;
}

// A board of this size, drawn four times as fine.
cv::Mat Picture(const Camera& camera, const Target& board, const Rigid3& pose, double board_value) {
  constexpr int kFine = 4;
  cv::Mat fine(kFine * camera.height(), kFine * camera.width(), CV_32FC1, cv::Scalar(40));
  std::vector<cv::Point> corners;
  for (const Eigen::Vector3d& corner : board.OutlineCorners()) {
    const Eigen::Vector2d p = *camera.Project(pose * corner);
    corners.emplace_back(static_cast<int>(std::lround(kFine * (p.x() + 0.5) - 0.5)),
                         static_cast<int>(std::lround(kFine * (p.y() + 0.5) - 0.5)));
  }
  cv::fillConvexPoly(fine, corners, cv::Scalar(board_value));
  cv::Mat image;
  cv::resize(fine, image, {}, 1.0 / kFine, 1.0 / kFine, cv::INTER_AREA);
  cv::GaussianBlur(image, image, {}, 0.8);
  cv::Mat noise(image.size(), CV_32FC1);
  cv::RNG random(1);
  random.fill(noise, cv::RNG::NORMAL, 0, 1.0);
  return image + noise;
}

PlainBoardResult Find(const Camera& camera, const Target& target, const cv::Mat& image) {
  return FindPlainBoard(
      image, [] { return std::vector<cv::Mat>(); }, cv::Mat::zeros(image.size(), CV_8UC1), camera,
      target);
}

Rigid3 At(double roll, double tilt, double x, double z) {
  return Rigid3{Eigen::Quaterniond::Identity(), {x, 0.05, z}} *
         RotationAbout({0.6, 0.8, 0}, tilt * kDegree) * RotationAbout({0, 0, 1}, roll * kDegree);
}

// How far a pose is off, whichever of its corners it calls the first.
void ExpectAt(const PlainBoardResult& found, const Rigid3& truth, double degrees, double metres) {
  ASSERT_TRUE(found.board) << found.why;
  double least = 1e9;
  for (int turn = 0; turn < 4; ++turn) {
    const Rigid3 turned =
        found.board->pose.sensor_from_target * RotationAbout({0, 0, 1}, 90 * turn * kDegree);
    least = std::min(least, RotationDistance(turned, truth));
  }
  EXPECT_LT(least, degrees * kDegree);
  EXPECT_LT((found.board->pose.sensor_from_target.translation - truth.translation).norm(), metres);
}

TEST(PlainBoard, IsFoundAtAnyRollBrightOrDarkAndWithACornerOutside) {
  const Camera camera(Spec());
  for (const double value : {200.0, 5.0}) {
    for (const double roll : {0.0, 20.0, 45.0, 70.0}) {
      for (const double x : {0.0, 0.9}) {
        const Rigid3 truth = At(roll, 25, x, 2.6);
        const PlainBoardResult found =
            Find(camera, Square(), Picture(camera, Square(), truth, value));
        if (!found.board) {
          EXPECT_GT(x, 0) << roll << ": " << found.why;
          continue;
        }
        SCOPED_TRACE(std::to_string(roll) + " " + std::to_string(x));
        ExpectAt(found, truth, 0.5, 0.012);
      }
    }
  }
}

// A board of bare wood before things that are darker than it here and brighter there: a street.
// Hands hold it at two of its sides.
struct Street {
  Image image;
  Rigid3 truth = At(20, 25, 0, 2.6);

  explicit Street(const Camera& camera) {
    cv::Mat bgr(camera.height(), camera.width(), CV_8UC3);
    for (int x = 0; x < bgr.cols; x += 40) {
      bgr.colRange(x, std::min(bgr.cols, x + 40))
          .setTo(cv::Scalar::all(x / 40 % 2 == 0 ? 35 : 215));
    }
    const cv::Mat mask = Picture(camera, Square(), truth, 240) > 140;
    bgr.setTo(cv::Scalar(70, 130, 190), mask);
    for (const std::size_t corner : {0, 1}) {
      const auto outline = Square().OutlineCorners();
      const Eigen::Vector3d side = 0.5 * (outline[corner] + outline[corner + 1]);
      const Eigen::Vector2d p = *camera.Project(truth * side);
      cv::circle(bgr, {static_cast<int>(p.x()), static_cast<int>(p.y())}, 14,
                 cv::Scalar(150, 150, 150), cv::FILLED);
    }
    cv::GaussianBlur(bgr, bgr, {}, 0.8);
    image.camera = "rgb";
    image.format = PixelFormat::kBgr8;
    image.pixels = bgr;
  }
};

TEST(PlainBoard, OfAnotherColourIsFoundBeforeWhatIsBrighterAndDarker) {
  const Camera camera(Spec());
  const Street street(camera);
  const cv::Mat grey = ToGrey(street.image);
  const cv::Mat clipped = cv::Mat::zeros(grey.size(), CV_8UC1);
  EXPECT_FALSE(Find(camera, Square(), grey).board);  // grey alone does not tell it
  const auto colours = [&] { return ColourPlanes(street.image); };
  ExpectAt(FindPlainBoard(grey, colours, clipped, camera, Square()), street.truth, 0.5, 0.012);
}

TEST(PlainBoard, InGreyHasNoColours) {
  Image image;
  image.format = PixelFormat::kMono8;
  image.pixels = cv::Mat::zeros(10, 10, CV_8UC1);
  EXPECT_TRUE(ColourPlanes(image).empty());
}

// A white board in the sun, up to four times too bright for the sensor: larger than it is, and as
// unsure as it says.
TEST(PlainBoard, ThatIsOverexposedIsFoundAndIsLessSure) {
  const Camera camera(Spec());
  const Rigid3 truth = At(10, 25, 0, 2.6);
  const auto find = [&](double value) {
    Image image;
    image.camera = "rgb";
    image.format = PixelFormat::kMono8;
    Picture(camera, Square(), truth, value).convertTo(image.pixels, CV_8U);
    return FindPlainBoard(
        ToGrey(image), [] { return std::vector<cv::Mat>(); }, Clipped(image), camera, Square());
  };
  const PlainBoardResult exposed = find(200);
  ASSERT_TRUE(exposed.board);
  for (const double value : {260.0, 500.0, 1000.0}) {
    const PlainBoardResult found = find(value);
    ASSERT_TRUE(found.board) << value << ": " << found.why;
    const auto& sigma = found.board->pose.covariance;
    EXPECT_GT(sigma(5, 5), 4 * exposed.board->pose.covariance(5, 5));
    const double range = (found.board->pose.sensor_from_target.translation - truth.translation).z();
    EXPECT_LT(std::abs(range), 3 * std::sqrt(sigma(5, 5))) << value;
    ExpectAt(found, truth, 1.0, 0.03);
  }
}

TEST(PlainBoard, WhatHasNotItsSizeIsRefused) {
  const Camera camera(Spec());
  Target door = Square();
  door.width_m = 0.5;
  const PlainBoardResult found =
      Find(camera, Square(), Picture(camera, door, At(10, 5, 0, 2), 200));
  EXPECT_FALSE(found.board);
  EXPECT_THAT(found.why, testing::HasSubstr("size"));
}

// Of a board, or of an image by a lens, that is stretched.
TEST(PlainBoard, ABoardOfAnotherShapeThanGivenIsSaidToBe) {
  const Camera camera(Spec());
  const cv::Mat image = Picture(camera, Square(), At(10, 25, 0, 2.6), 200);
  Target wider = Square();
  wider.width_m = 1.1;
  CameraSpec stretched = Spec();
  stretched.lens.fx *= 1.1;
  for (const auto& [lens, target] : {std::pair(Spec(), wider), std::pair(stretched, Square())}) {
    const PlainBoardResult found = Find(Camera(lens), target, image);
    EXPECT_FALSE(found.board);
    EXPECT_THAT(found.why, testing::AllOf(testing::HasSubstr("width_m, height_m"),
                                          testing::HasSubstr("fx against fy")));
  }
  EXPECT_THAT(Find(camera, wider, image).why,
              testing::HasSubstr("1.00 to 1, by the rig file as 1.10 to 1"));
}

TEST(PlainBoard, ALensThatCannotBeRightIsNamed) {
  CameraSpec spec = Spec();
  spec.lens.fx = spec.lens.fy = 2000;
  const cv::Mat image = Picture(Camera(spec), Square(), At(10, 25, 0, 5), 200);
  ASSERT_TRUE(Find(Camera(spec), Square(), image).board);
  std::swap(spec.lens.fx, spec.lens.cx);
  EXPECT_THAT(Find(Camera(spec), Square(), image).why,
              testing::HasSubstr("were fx and cx exchanged?"));
}

}  // namespace
}  // namespace rgbdt
