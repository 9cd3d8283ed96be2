#pragma once

#include <Eigen/Core>
#include <array>
#include <string>

namespace rgbdt {

/// A family of square black and white markers, each with a number.
struct MarkerFamily {
  const char* name;
  int cells = 0;   ///< along a side, without the border
  int count = 0;   ///< markers are numbered from 0 to count - 1
  int number = 0;  ///< OpenCV's (cv::aruco::PREDEFINED_DICTIONARY_NAME)
};

/// All that are known, by the names that OpenCV gives them without "DICT_": 4X4_50, APRILTAG_36h11.
const std::array<MarkerFamily, 21>& MarkerFamilies();

/// The one of that name, with or without "DICT_", whatever its letters' case; nullptr: none.
const MarkerFamily* FindMarkerFamily(const std::string& name);

/// "4X4_50, 4X4_100, ...", for messages.
std::string MarkerFamilyNames();

inline constexpr int kKalibrBorderBits = 2;  ///< of the tags that Kalibr draws

/// The markers on a board (see Target): they tell which part of it an image shows.
struct Markers {
  std::string family;   ///< a name of MarkerFamilies
  double side_m = 0;    ///< of a marker, its black border included
  int border_bits = 1;  ///< how many cells wide that border is
  /// 0: ChArUco, a marker in the middle of each white square, numbered along the rows from the top.
  /// More: a grid of markers with this between them, a black square of that side where four meet
  /// (Kalibr's AprilTag grid), numbered along the rows from the bottom.
  double gap_m = 0;
  /// ChArUco as OpenCV drew it before 4.6: with an even number of rows the top left square is
  /// white.
  bool legacy = false;

  bool grid() const { return gap_m > 0; }
};

/// Where a marker is on its board.
struct MarkerPlace {
  int id = 0;
  Eigen::Vector2d centre{0, 0};  ///< target frame [m]
};

}  // namespace rgbdt
