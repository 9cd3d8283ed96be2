#pragma once

#include <opencv2/core/mat.hpp>

#include "calib/model/calibration.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// The projection uncertainty all over one camera's image: four small maps of the image, for
/// points 2, 5, 10 and 50 m away, with one scale and lines of equal sigma [px]
/// (calib/solve/colouring.h). 8-bit BGR, legible on a phone. Empty where the calibration has no
/// covariance, or that gives no sigma.
cv::Mat ColouringPicture(const CameraSpec& spec, const CameraCalibration& calibration);

/// How to read it, in words.
inline constexpr const char* kColouringCaption =
    "Projection uncertainty: 1 sigma, in pixels, of where in the image a point's colour is taken "
    "from, for points 2, 5, 10 and 50 m away. Each map is the camera's image: dark is low, bright "
    "is high, a line joins places of equal uncertainty, and grey is beyond the lens. An error of "
    "the "
    "rotation shifts a colour by as many pixels at every distance, so on the object it grows with "
    "the distance; an error of the translation counts close by and fades with the distance. Where "
    "the boards stood the two balance best. To make a bright place darker, hold the board there, "
    "at "
    "about that distance.";

}  // namespace rgbdt
