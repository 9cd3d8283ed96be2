#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "calib/model/rig.h"

namespace rgbdt {

/// Whether a camera's name, folder or topic says that it is a thermal one. Of images of 16 bit (and
/// of temperatures) makers' and short names count, too (flir, boson, lepton, tau, ir): colour and
/// near infrared cameras of 8 bit are called so as well.
bool SaysThermal(const std::string& name, bool sixteen_bit);

/// How far the counts of one channel of 16 bit differ: the darkest over the brightest, by the 1st
/// and the 99th of a hundred pixels. 0: all are black.
double DarkOverBright(const cv::Mat& counts);

/// What a camera of one channel of 16 bit is: by the first of these names that says so ("rgb",
/// "color", "colour" and "visible" say colour), else by how far its counts differ. A thermal
/// camera's differ by less than a half of the brightest: temperatures about 300 K, or a large
/// offset.
struct SixteenBitKind {
  CameraKind kind = CameraKind::kThermal;
  std::string why;  ///< where no name says it
};
SixteenBitKind KindOfSixteenBit(const std::vector<std::string>& names, double dark_over_bright);

}  // namespace rgbdt
