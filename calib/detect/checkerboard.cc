#include "calib/detect/checkerboard.h"

#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "calib/camera/pixels.h"

namespace rgbdt {
namespace {

// The local background taken away: what remains of a heated board is its squares.
cv::Mat Flatten(const cv::Mat& grey) {
  const int size = std::max(31, grey.cols / 12) | 1;
  cv::Mat background;
  cv::boxFilter(grey, background, CV_32F, {size, size});
  return Stretch(grey - background);
}

bool FindIn(const cv::Mat& picture, cv::Size pattern, std::vector<cv::Point2f>* corners) {
  // Large images are searched at reduced size: the search is what costs, and the corners are
  // refined at full size afterwards.
  const double scale = std::min(1.0, 1000.0 / std::max(picture.cols, picture.rows));
  cv::Mat small = picture;
  if (scale < 1) cv::resize(picture, small, {}, scale, scale, cv::INTER_AREA);
  bool found = cv::findChessboardCornersSB(small, pattern, *corners, cv::CALIB_CB_NORMALIZE_IMAGE);
  if (!found && scale < 1) {
    found = cv::findChessboardCornersSB(picture, pattern, *corners, cv::CALIB_CB_NORMALIZE_IMAGE);
    return found;
  }
  // Pixel centres lie at integers: (x + 0.5) scales, not x.
  for (cv::Point2f& c : *corners) {
    c.x = static_cast<float>((c.x + 0.5) / scale - 0.5);
    c.y = static_cast<float>((c.y + 0.5) / scale - 0.5);
  }
  return found;
}

// Half the window of cornerSubPix: well inside the squares next to the corner.
int HalfWindow(const std::vector<cv::Point2f>& corners, int columns) {
  double shortest = 1e9;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const std::size_t right = i + 1;
    const std::size_t below = i + static_cast<std::size_t>(columns);
    if (right % static_cast<std::size_t>(columns) != 0) {
      shortest = std::min(shortest, cv::norm(corners[i] - corners[right]));
    }
    if (below < corners.size())
      shortest = std::min(shortest, cv::norm(corners[i] - corners[below]));
  }
  return std::clamp(static_cast<int>(0.35 * shortest), 2, 11);
}

}  // namespace

std::optional<std::vector<Eigen::Vector2d>> FindCheckerboard(const cv::Mat& grey,
                                                             const Target& target) {
  const cv::Size pattern(target.corners_x(), target.corners_y());
  const cv::Mat plain = Stretch(grey);
  const cv::Mat flat = Flatten(grey);
  std::vector<cv::Point2f> corners;
  cv::Mat inverted;
  bool found = FindIn(plain, pattern, &corners) || FindIn(flat, pattern, &corners);
  if (!found) {
    cv::bitwise_not(flat, inverted);
    found = FindIn(inverted, pattern, &corners);
  }
  if (!found) return std::nullopt;
  const int half = HalfWindow(corners, pattern.width);
  // findChessboardCornersSB can be 0.1 px off on skewed views; cornerSubPix from there is not.
  cv::cornerSubPix(plain, corners, {half, half}, {-1, -1},
                   {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 50, 1e-3});
  std::vector<Eigen::Vector2d> out;
  out.reserve(corners.size());
  for (const cv::Point2f& c : corners) out.emplace_back(c.x, c.y);
  return out;
}

}  // namespace rgbdt
