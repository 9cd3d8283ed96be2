#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "calib/model/rig.h"
#include "calib/scan_assembly/scanner_geometry.h"

namespace rgbdt {

/// Before (left) and after (right): a level slice of the room from above, and cuts through the
/// surfaces that were the most double, millimetres across. Beams ahead of the motor's axis are
/// orange, those behind it blue. 8-bit BGR.
cv::Mat ScannerPicture(const TurnedScanner& before, const ScannerGeometry& found,
                       const std::vector<TurnedBeams>& sweeps);

}  // namespace rgbdt
