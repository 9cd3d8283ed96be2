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

inline constexpr const char* kHolesFamily = "6X6_250";  ///< of velo2cam's and FAST-Calib's boards
inline constexpr int kKalibrBorderBits = 2;             ///< of the tags that Kalibr draws

/// The markers on a board (see Target): they tell which part of it an image shows.
struct Markers {
  std::string family;   ///< a name of MarkerFamilies
  double side_m = 0;    ///< of a marker, its black border included
  int border_bits = 1;  ///< how many cells wide that border is
  /// 0: ChArUco, a marker in the middle of each white square, numbered along the rows from the top.
  /// More: a grid of markers with this between them, a black square of that side where four meet
  /// (Kalibr's AprilTag grid), numbered along the rows from the bottom. Holes: the smaller one.
  double gap_m = 0;
  /// ChArUco as OpenCV drew it before 4.6: with an even number of rows the top left square is
  /// white.
  bool legacy = false;

  bool grid() const { return gap_m > 0; }
};

/// Four round holes through a white board, two above two about its centre, and a black marker
/// towards each of its corners, numbered along the rows from the top: the board of velo2cam
/// (Beltran, Guindel, de la Escalera, Garcia 2022) and FAST-Calib, whose sizes these are.
struct Holes {
  double radius_m = 0.12;
  Eigen::Vector2d spacing_m{0.5, 0.4};         ///< of the holes' centres, along width and height
  Eigen::Vector2d marker_spacing_m{1.1, 0.7};  ///< of the markers' centres, likewise
  int first_marker = 1;                        ///< the number of the one at the top left
};

/// Where a marker is on its board.
struct MarkerPlace {
  int id = 0;
  Eigen::Vector2d centre{0, 0};  ///< target frame [m]
};

}  // namespace rgbdt
