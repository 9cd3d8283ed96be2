#pragma once

#include <array>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calib/camera/camera.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"

namespace rgbdt {

/// A board without a pattern in an image.
struct PlainBoard {
  TargetPose pose;                 ///< known up to half a turn, a square's up to quarter turns
  std::array<ImageSide, 4> sides;  ///< all of them seen, at least in part
  double side_sigma_px = 0;        ///< of the sides' ends, RMS
};

/// The board or the reason why there is none.
struct PlainBoardResult {
  std::optional<PlainBoard> board;
  std::string why;
};

/// Finds a board without a pattern by its outline, in grey values (CV_32FC1, any unit) of any
/// camera. All four sides must be seen in part; corners may be hidden or outside the image.
///   1. quadrangles are found (FindQuadrangles): of a board that is brighter or darker than what is
///      about it in the grey values; where none of these is the board, of one of another colour in
///      the planes that `colours` makes (ColourPlanes)
///   2. one that the target's size and the lens explain, from most seen to least, gives a pose
///   3. each side is fitted to the image's gradient (FitBoardSides), and the pose to the sides
/// Refused with the reason: a size that does not fit, less than three sides' worth of outline, or a
/// tilt that could as well be the mirrored one. Where an outline would fit but for its shape, or
/// the lens cannot be right, that is said. A door or a sheet may fit as well: the views together
/// tell, by where the LIDAR sees the board. `clipped` is what Clipped() says of the image.
PlainBoardResult FindPlainBoard(const cv::Mat& grey,
                                const std::function<std::vector<cv::Mat>()>& colours,
                                const cv::Mat& clipped, const Camera& camera, const Target& target);

}  // namespace rgbdt
