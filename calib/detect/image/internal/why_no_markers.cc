#include "calib/detect/image/internal/why_no_markers.h"

#include <algorithm>
#include <cstdlib>
#include <opencv2/core.hpp>

#include "calib/detect/image/internal/grey_image.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

constexpr std::size_t kSure = 4;  // markers, that chance does not decode
constexpr int kMostOther = 4;     // rows and columns more or fewer

std::string SizeText(const Target& target) {
  if (target.holes) return "four holes";
  if (!target.markers->grid()) return Format("%d x %d squares", target.squares_x, target.squares_y);
  return Format("%d x %d tags", target.squares_x / 2, target.squares_y / 2);
}

// The largest of each size: the smaller ones are its beginning.
bool HasAll(const MarkerFamily& family) {
  const std::string name = family.name;
  return name.find('X') == std::string::npos || family.count == 1000;
}

bool SameMarkers(const MarkerFamily& a, const MarkerFamily& b) {
  return a.cells == b.cells && std::string(a.name).substr(0, 4) == std::string(b.name).substr(0, 4);
}

std::string WhyOtherFamily(const cv::Mat& grey, const Target& target) {
  const Markers& markers = *target.markers;
  const MarkerFamily& own = *FindMarkerFamily(markers.family);
  for (const int border : {1, 2}) {
    if (border == markers.border_bits) continue;
    const auto count = DecodeMarkers(grey, own, border, kSure).size();
    if (count < kSure) continue;
    return Format(
        "%zu markers with a black border of %d cells are in the image, not of %d; check "
        "border_bits in the rig file",
        count, border, markers.border_bits);
  }
  std::size_t most = 0;
  std::string name;
  for (const MarkerFamily& family : MarkerFamilies()) {
    if (!HasAll(family) || SameMarkers(family, own)) continue;
    const auto count = DecodeMarkers(grey, family, markers.border_bits, kSure).size();
    if (count <= most) continue;
    most = count;
    name = family.name;
  }
  // A small family's numbers are decoded in what is none of its markers, too.
  if (most < std::max(kSure, target.MarkerPlaces().size() / 4)) return "";
  return Format(
      "%zu markers of %s are in the image, none of %s; check the board's dictionary in "
      "the rig file",
      most, name.c_str(), own.name);
}

// A board of other rows or columns on which the markers lie as they are seen.
std::optional<Target> OtherSize(const Target& target, const std::vector<SeenMarker>& seen) {
  const int step = target.markers->grid() ? 2 : 1;
  for (int more = 1; more <= kMostOther; ++more) {
    for (const int squares : {step * more, -step * more}) {
      Target other = target;
      other.squares_x += squares;
      if (other.squares_x >= 3 && LayOut(seen, other)) return other;
    }
  }
  return std::nullopt;
}

std::string WhyOtherLayout(const Target& target, const std::vector<SeenMarker>& seen) {
  if (target.squares_y % 2 == 0 && LayOutOtherWay(target, seen)) return WhyOtherWay(target);
  const auto size = OtherSize(target, seen);
  if (!size) return "";
  return Format("the markers lie as on a board with %d, not %d in a row; check the rig file",
                target.markers->grid() ? size->squares_x / 2 : size->squares_x,
                target.markers->grid() ? target.squares_x / 2 : target.squares_x);
}

}  // namespace

std::string WhyNoMarkers(const cv::Mat& grey, const Target& target,
                         const std::vector<SeenMarker>& seen) {
  const MarkerFamily& family = *FindMarkerFamily(target.markers->family);
  std::string why = WhyImageIsUseless(grey);
  if (!why.empty()) return why;
  if (seen.size() >= kSure) {
    if (!target.holes) why = WhyOtherLayout(target, seen);
    if (!why.empty()) return why;
    return Format("%zu markers of %s are in the image, but not laid out as on a board of %s",
                  seen.size(), family.name, SizeText(target).c_str());
  }
  cv::Mat mirrored;
  cv::flip(grey, mirrored, 1);
  const auto count = DecodeMarkers(mirrored, family, target.markers->border_bits, kSure).size();
  if (count >= kSure) {
    return Format(
        "%zu markers are in the image, mirrored: the board was printed mirrored, or the "
        "camera turns its image round; print it again, not mirrored",
        count);
  }
  why = WhyOtherFamily(grey, target);
  if (!why.empty()) return why;
  return Format(
      "%zu markers of %s in the image, too few for a board of %s; is it in view, sharp, "
      "with contrast?",
      seen.size(), family.name, SizeText(target).c_str());
}

std::optional<MarkerLayout> LayOutOtherWay(const Target& target,
                                           const std::vector<SeenMarker>& seen) {
  Markers markers = *target.markers;
  if (markers.grid()) return std::nullopt;
  markers.legacy = !markers.legacy;
  Target other = target;
  other.markers = markers;
  return LayOut(seen, other);
}

std::string WhyOtherWay(const Target& target) {
  return std::string("the markers lie as on a board that OpenCV drew ") +
         (target.markers->legacy ? "from 4.6 on: take out legacy: true"
                                 : "before 4.6: add legacy: true") +
         " in the rig file";
}

std::string WhyNotThisBoard(const Target& target, const std::vector<SeenMarker>& seen) {
  const auto places = target.MarkerPlaces();
  const int first = places.front().id;
  const int last = places.back().id;
  std::vector<int> others;
  for (const SeenMarker& marker : seen) {
    if (marker.id < first || marker.id > last) others.push_back(marker.id);
  }
  // Another such board may stand in view.
  constexpr std::size_t kOwn = 3;
  if (target.holes && seen.size() - others.size() >= kOwn) return "";
  if (others.size() < 2 || 10 * others.size() < seen.size()) return "";
  return Format(
      "markers %d to %d are in the image, but a board of %s has %d to %d; check the rig "
      "file",
      others.front(), others.back(), SizeText(target).c_str(), first, last);
}

}  // namespace rgbdt
