#include "calib/detect/image/internal/marker_decode.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/aruco.hpp>
#include <opencv2/imgproc.hpp>

#include "calib/camera/pixels.h"

namespace rgbdt {
namespace {

constexpr int kLeastCellPx = 2;   // of a marker, to be decoded
constexpr double kLargest = 2e7;  // [px], of an enlarged image

// 8 bit; the darkest and the lightest half percent are clipped.
cv::Mat EightBit(const cv::Mat& grey) {
  const double low = static_cast<double>(Percentile(grey, 0.005));
  const double high = static_cast<double>(Percentile(grey, 0.995));
  const double scale = high > low ? 255 / (high - low) : 0;
  cv::Mat out;
  grey.convertTo(out, CV_8U, scale, -low * scale);
  return out;
}

using Found = std::map<int, SeenMarker>;

double Area(const SeenMarker& marker) {
  const Eigen::Vector2d a = marker.corners[2] - marker.corners[0];
  const Eigen::Vector2d b = marker.corners[3] - marker.corners[1];
  return std::abs(a.x() * b.y() - a.y() * b.x());
}

void DecodeIn(const cv::Mat& picture, double scale, const MarkerFamily& family, int border_bits,
              Found* found) {
  const auto parameters = cv::aruco::DetectorParameters::create();
  parameters->markerBorderBits = border_bits;
  const double least = 4.0 * kLeastCellPx * (family.cells + 2 * border_bits);
  parameters->minMarkerPerimeterRate = least / std::max(picture.cols, picture.rows);
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<int> ids;
  cv::aruco::detectMarkers(picture, cv::aruco::getPredefinedDictionary(family.number), corners, ids,
                           parameters);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    SeenMarker marker;
    marker.id = ids[i];
    for (std::size_t k = 0; k < 4; ++k) {
      // Pixel centres lie at integers: (x + 0.5) scales, not x.
      marker.corners[k] = (Eigen::Vector2d(corners[i][k].x, corners[i][k].y).array() + 0.5) / scale;
      marker.corners[k].array() -= 0.5;
    }
    const auto known = found->find(marker.id);
    if (known == found->end() || Area(known->second) < Area(marker)) (*found)[marker.id] = marker;
  }
}

}  // namespace

std::vector<SeenMarker> DecodeMarkers(const cv::Mat& grey, const MarkerFamily& family,
                                      int border_bits, std::size_t enough) {
  const cv::Mat picture = EightBit(grey);
  cv::Mat enlarged;
  Found found;
  for (const bool exchanged : {false, true}) {
    if (!found.empty()) break;
    DecodeIn(exchanged ? cv::Mat(~picture) : picture, 1, family, border_bits, &found);
    if (found.size() >= enough || 4 * static_cast<double>(grey.total()) > kLargest) continue;
    if (enlarged.empty()) cv::resize(picture, enlarged, {}, 2, 2, cv::INTER_CUBIC);
    DecodeIn(exchanged ? cv::Mat(~enlarged) : enlarged, 2, family, border_bits, &found);
  }
  std::vector<SeenMarker> markers;
  for (const auto& [id, marker] : found) markers.push_back(marker);
  return markers;
}

}  // namespace rgbdt
