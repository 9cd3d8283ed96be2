#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "calib/camera/camera.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// The corners of the checkerboard's outline [px], in order round it, where OpenCV's detectors see
/// all of its inner corners (findChessboardCorners, else findChessboardCornersSB): some pixels off,
/// as a person's picks are. Nothing where neither does, or the outline leaves the image. `grey` is
/// CV_32FC1 of any unit. Half a second for an image of 2 megapixels.
std::optional<std::array<Eigen::Vector2d, 4>> OutlineByOpenCv(const cv::Mat& grey,
                                                              const Camera& camera,
                                                              const Target& target);

}  // namespace rgbdt
