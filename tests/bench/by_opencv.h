#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "calib/model/cloud.h"
#include "calib/model/rig.h"

namespace rgbdt::bench {

/// Pixels of points of the LIDAR's frame by cv::projectPoints: of those behind the camera, too.
std::vector<cv::Point2f> ProjectByOpenCv(const CameraSpec& camera, const Rigid3& camera_from_lidar,
                                         const std::vector<Eigen::Vector3f>& points);

/// A colour cloud as a user writes it who has OpenCV: what each camera tells of the points of a
/// cloud. No visibility, no image for each time.
struct ColouredByOpenCv {
  std::vector<cv::Vec3b> bgr;
  std::vector<float> counts;  ///< NaN: not seen by a thermal camera
};
struct CameraForOpenCv {
  CameraSpec spec;
  Rigid3 camera_from_lidar;
  cv::Mat pixels;  ///< CV_8UC3, or CV_16UC1
};
ColouredByOpenCv FuseByOpenCv(const std::vector<Eigen::Vector3f>& points,
                              const std::vector<CameraForOpenCv>& cameras);

}  // namespace rgbdt::bench
