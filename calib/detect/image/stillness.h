#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "calib/camera/camera.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// An image of the same camera, taken during the sweep.
struct SweepImage {
  cv::Mat grey;              ///< CV_32FC1
  double after_start_s = 0;  ///< since the sweep's start [s]
};

/// Farther than this the board must not move in the image [px].
inline constexpr double kStillPx = 0.5;

/// Why the board did not stand still during the sweep, e.g. "board moved 6 mm during the sweep
/// (1.3 px in the image 0.4 s after its start)"; empty: it did. `corners`: the inner corners in
/// `grey_at_capture` (CV_32FC1), in the target's order, NaN where one was not seen. The others are
/// tracked into each of the other images and both sets fitted with a pose, which averages the noise
/// of single corners out; what is compared is where the two poses put the corners. The first image
/// in which they moved is told.
std::string WhyNotStill(const Camera& camera, const Target& target, const cv::Mat& grey_at_capture,
                        const std::vector<Eigen::Vector2d>& corners,
                        const std::vector<SweepImage>& others);

}  // namespace rgbdt
