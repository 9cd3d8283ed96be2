#include "tests/bench/by_opencv.h"

#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>

namespace rgbdt::bench {
namespace {

// Bilinear; `at` lies inside. Channels one after the other.
template <typename Pixel, typename Sum>
Sum Sample(const cv::Mat& image, const cv::Point2f& at) {
  const int x = std::min(static_cast<int>(at.x), image.cols - 2);
  const int y = std::min(static_cast<int>(at.y), image.rows - 2);
  const float fx = at.x - static_cast<float>(x);
  const float fy = at.y - static_cast<float>(y);
  const auto value = [&](int dx, int dy) { return Sum(image.at<Pixel>(y + dy, x + dx)); };
  return (value(0, 0) * (1 - fx) + value(1, 0) * fx) * (1 - fy) +
         (value(0, 1) * (1 - fx) + value(1, 1) * fx) * fy;
}

}  // namespace

std::vector<cv::Point2f> ProjectByOpenCv(const CameraSpec& camera, const Rigid3& camera_from_lidar,
                                         const std::vector<Eigen::Vector3f>& points) {
  static_assert(sizeof(Eigen::Vector3f) == sizeof(cv::Point3f));
  const Lens& lens = camera.lens;
  const cv::Matx33d matrix(lens.fx, 0, lens.cx, 0, lens.fy, lens.cy, 0, 0, 1);
  const cv::Mat distortion(1, 8, CV_64F, const_cast<double*>(lens.distortion.data()));
  cv::Mat rotation, turn, translation;
  cv::eigen2cv(Eigen::Matrix3d(camera_from_lidar.rotation.toRotationMatrix()), rotation);
  cv::Rodrigues(rotation, turn);
  cv::eigen2cv(camera_from_lidar.translation, translation);
  const cv::Mat in(static_cast<int>(points.size()), 1, CV_32FC3,
                   const_cast<float*>(points.data()->data()));
  std::vector<cv::Point2f> pixels;
  cv::projectPoints(in, turn, translation, matrix, distortion, pixels);
  return pixels;
}

ColouredByOpenCv FuseByOpenCv(const std::vector<Eigen::Vector3f>& points,
                              const std::vector<CameraForOpenCv>& cameras) {
  ColouredByOpenCv out;
  out.bgr.resize(points.size());
  out.counts.resize(points.size(), std::numeric_limits<float>::quiet_NaN());
  for (const CameraForOpenCv& camera : cameras) {
    const auto pixels = ProjectByOpenCv(camera.spec, camera.camera_from_lidar, points);
    const Eigen::RowVector3f forward =
        camera.camera_from_lidar.rotation.toRotationMatrix().row(2).cast<float>();
    const auto ahead = static_cast<float>(camera.camera_from_lidar.translation.z());
    const auto right = static_cast<float>(camera.spec.width - 1);
    const auto bottom = static_cast<float>(camera.spec.height - 1);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const cv::Point2f& at = pixels[i];
      if (forward.dot(points[i]) + ahead <= 0) continue;
      if (!(at.x >= 0 && at.y >= 0 && at.x <= right && at.y <= bottom)) continue;
      if (camera.spec.kind == CameraKind::kThermal) {
        out.counts[i] = Sample<std::uint16_t, float>(camera.pixels, at);
      } else {
        out.bgr[i] = Sample<cv::Vec3b, cv::Vec3f>(camera.pixels, at);
      }
    }
  }
  return out;
}

}  // namespace rgbdt::bench
