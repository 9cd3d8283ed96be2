#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "calib/model/lens.h"

namespace rgbdt {

/// Which lens of which file is wanted.
struct LensWanted {
  std::filesystem::path file;
  std::string entry;   ///< "cam1": the part of the file; empty: found by what follows
  std::string camera;  ///< the camera's name, looked for among the parts and their rostopics
  int index = 0;       ///< or else the part's place, where there are as many as cameras
  int cameras = 1;
  std::optional<Lens::Model> model;  ///< for files that do not say it
};

/// A lens as a file has it.
struct FileLens {
  Lens lens;
  int width = 0, height = 0;  ///< of the images that it was made from [px]; 0: not said
  std::string where;          ///< the file, with the part where it has several
  int parts = 1;              ///< lenses in the file
};

/// Reads the lens that another program found:
///  - OpenCV: camera_matrix and distortion_coefficients, as cv::FileStorage or plain YAML;
///  - ROS: camera_info, as camera_calibration writes it or a topic prints it (K and D);
///  - Kalibr: a camchain (cam0, cam1, ... with intrinsics and distortion_coeffs);
///  - what `rgbdt export` wrote for OpenCV and Kalibr.
/// Throws InputError, one line with file, line and field: what is missing, what our models (pinhole
/// with up to 8 coefficients of OpenCV, equidistant fisheye with 4) cannot express, and a file of
/// several cameras of which none can be told to be meant.
FileLens ReadLensFile(const LensWanted& wanted);

/// The same from the file's text.
FileLens ParseLensFile(const std::string& text, const LensWanted& wanted);

/// Throws InputError where the lens belongs to images of another size, with the factor if the one
/// is the other made smaller or larger.
void CheckLensSize(const FileLens& lens, const std::string& camera, int width, int height);

}  // namespace rgbdt
