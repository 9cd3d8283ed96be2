#include "calib/model/markers.h"

#include "calib/model/text.h"

namespace rgbdt {

const std::array<MarkerFamily, 21>& MarkerFamilies() {
  static const std::array<MarkerFamily, 21> families{{
      {"4X4_50", 4, 50, 0},
      {"4X4_100", 4, 100, 1},
      {"4X4_250", 4, 250, 2},
      {"4X4_1000", 4, 1000, 3},
      {"5X5_50", 5, 50, 4},
      {"5X5_100", 5, 100, 5},
      {"5X5_250", 5, 250, 6},
      {"5X5_1000", 5, 1000, 7},
      {"6X6_50", 6, 50, 8},
      {"6X6_100", 6, 100, 9},
      {"6X6_250", 6, 250, 10},
      {"6X6_1000", 6, 1000, 11},
      {"7X7_50", 7, 50, 12},
      {"7X7_100", 7, 100, 13},
      {"7X7_250", 7, 250, 14},
      {"7X7_1000", 7, 1000, 15},
      {"ARUCO_ORIGINAL", 5, 1024, 16},
      {"APRILTAG_16h5", 4, 30, 17},
      {"APRILTAG_25h9", 5, 35, 18},
      {"APRILTAG_36h10", 6, 2320, 19},
      {"APRILTAG_36h11", 6, 587, 20},
  }};
  return families;
}

const MarkerFamily* FindMarkerFamily(const std::string& name) {
  std::string wanted = ToLower(name);
  if (wanted.rfind("dict_", 0) == 0) wanted = wanted.substr(5);
  for (const MarkerFamily& family : MarkerFamilies()) {
    if (ToLower(family.name) == wanted) return &family;
  }
  return nullptr;
}

std::string MarkerFamilyNames() {
  std::string names;
  for (const MarkerFamily& family : MarkerFamilies()) {
    names += (names.empty() ? "" : ", ") + std::string(family.name);
  }
  return names;
}

}  // namespace rgbdt
