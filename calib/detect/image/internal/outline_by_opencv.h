#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "calib/camera/camera.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// The corners of the checkerboard's outline [px], in order round it, where OpenCV's detector
/// (findChessboardCornersSB) sees all of its inner corners: some pixels off, as a person's picks
/// are. It does not tell half a turn, nor of a square pattern a quarter: one outline for each turn
/// that looks different. Empty where it sees none. `grey` is CV_32FC1 of any unit. Half a second
/// for an image of 2 megapixels.
std::vector<std::array<Eigen::Vector2d, 4>> OutlinesByOpenCv(const cv::Mat& grey,
                                                             const Camera& camera,
                                                             const Target& target);

}  // namespace rgbdt
