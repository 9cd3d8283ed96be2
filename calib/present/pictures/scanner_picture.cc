#include "calib/present/pictures/scanner_picture.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

#include "calib/model/text.h"

namespace rgbdt {
namespace {

constexpr int kWidth = 640, kGap = 20, kHead = 70, kSliceHeight = 560, kCutHeight = 260;
constexpr int kCuts = 2, kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kSliceAbove = 1.0, kSliceThick = 0.1;           // [m] over the scanner
constexpr double kCutHalf = 0.5, kCutThick = 0.12, kTall = 0.1;  // [m]
const cv::Scalar kInk = cv::Scalar::all(40), kPaper = cv::Scalar::all(255);
const cv::Vec3b kAhead(30, 120, 230), kBehind(200, 90, 20);

void Write(const std::string& text, cv::Point at, double size, cv::Mat* picture) {
  cv::putText(*picture, text, at, kFont, size, kInk, 1, cv::LINE_AA);
}

/// One sweep under one geometry.
struct Points {
  std::vector<Eigen::Vector3d> at;
  std::vector<bool> behind;
};

Points PointsUnder(const TurnedScanner& scanner, const TurnedBeams& beams) {
  Points points{PointsOf(scanner, beams), {}};
  for (const double a : beams.scan_rad) points.behind.push_back(IsBehind(scanner, a));
  return points;
}

// Both halves show where they meet: each pixel is the mean of what falls on it.
void Dot(cv::Point at, bool behind, cv::Mat* picture) {
  if (!cv::Rect({0, 0}, picture->size()).contains(at)) return;
  cv::Vec3b& pixel = picture->at<cv::Vec3b>(at);
  const cv::Vec3b colour = behind ? kBehind : kAhead;
  pixel = pixel == cv::Vec3b::all(255) ? colour : 0.5 * pixel + 0.5 * colour;
}

struct Extent {
  Eigen::Vector2d low{1e9, 1e9}, high{-1e9, -1e9};
};

bool InSlice(const Eigen::Vector3d& point, double height) {
  return std::abs(point.z() - height - kSliceAbove) < kSliceThick && point.norm() < 30;
}

Extent ExtentOf(const Points& points, double height) {
  Extent extent;
  for (const Eigen::Vector3d& point : points.at) {
    if (!InSlice(point, height)) continue;
    extent.low = extent.low.cwiseMin(point.head<2>());
    extent.high = extent.high.cwiseMax(point.head<2>());
  }
  return extent;
}

// x up, y to the left, as one looks down on the room.
cv::Mat Slice(const Points& points, const Extent& extent, double height) {
  cv::Mat picture(kSliceHeight, kWidth, CV_8UC3, kPaper);
  const Eigen::Vector2d size = extent.high - extent.low;
  if (!(size.minCoeff() > 0)) return picture;
  const double scale = 0.88 * std::min(kSliceHeight / size.x(), kWidth / size.y());
  const Eigen::Vector2d middle = 0.5 * (extent.low + extent.high);
  for (std::size_t i = 0; i < points.at.size(); ++i) {
    if (!InSlice(points.at[i], height)) continue;
    const Eigen::Vector2d off = scale * (points.at[i].head<2>() - middle);
    Dot({static_cast<int>(std::lround(0.5 * kWidth - off.y())),
         static_cast<int>(std::lround(0.5 * kSliceHeight - off.x()))},
        points.behind[i], &picture);
  }
  cv::rectangle(picture, {0, 0}, {picture.cols - 1, picture.rows - 1}, kInk);
  Write(Format("from above, %.1f m over the scanner", kSliceAbove), {10, 20}, 0.45, &picture);
  return picture;
}

// Along the surface to the right, its normal upwards and much larger.
cv::Mat Cut(const Points& points, const DoubleSurface& surface, double gap_m) {
  cv::Mat picture(kCutHeight, kWidth, CV_8UC3, kPaper);
  const Eigen::Vector3d along = surface.normal.unitOrthogonal();
  const Eigen::Vector3d deep = surface.normal.cross(along);
  for (std::size_t i = 0; i < points.at.size(); ++i) {
    const Eigen::Vector3d off = points.at[i] - surface.centre;
    if (std::abs(off.dot(deep)) > kCutThick || std::abs(off.dot(along)) > kCutHalf) continue;
    const int x = static_cast<int>(std::lround((off.dot(along) / kCutHalf + 1) * 0.5 * kWidth));
    const int y =
        static_cast<int>(std::lround((1 - off.dot(surface.normal) / kTall) * 0.5 * kCutHeight));
    for (int step = 0; step < 9; ++step) {
      Dot({x + step % 3, y + step / 3}, points.behind[i], &picture);
    }
  }
  cv::rectangle(picture, {0, 0}, {picture.cols - 1, picture.rows - 1}, kInk);
  Write(Format("cut through a surface, 1 m long, +-%.0f mm high: ", 1000 * kTall) +
            Format("halves %.1f mm apart", 1000 * std::abs(gap_m)),
        {10, 20}, 0.45, &picture);
  return picture;
}

// The most double ones, not all of one place.
std::vector<DoubleSurface> WorstOf(const ScannerGeometry& found, int sweep) {
  std::vector<DoubleSurface> sorted = found.surfaces, worst;
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) {
    return std::abs(a.gap_before_m) > std::abs(b.gap_before_m);
  });
  for (const DoubleSurface& surface : sorted) {
    const bool elsewhere = std::all_of(worst.begin(), worst.end(), [&](const DoubleSurface& other) {
      return std::abs(surface.normal.dot(other.normal)) < 0.7;
    });
    if (surface.sweep == sweep && elsewhere) worst.push_back(surface);
    if (worst.size() == kCuts) break;
  }
  return worst;
}

cv::Mat Column(const std::string& title, const Points& points, const Extent& extent, double height,
               const std::vector<DoubleSurface>& cuts, double DoubleSurface::*gap) {
  const int tall = kHead + kSliceHeight + static_cast<int>(cuts.size()) * (kGap + kCutHeight);
  cv::Mat column(tall, kWidth, CV_8UC3, kPaper);
  Write(title, {0, 40}, 0.7, &column);
  Slice(points, extent, height).copyTo(column(cv::Rect(0, kHead, kWidth, kSliceHeight)));
  int y = kHead + kSliceHeight + kGap;
  for (const DoubleSurface& surface : cuts) {
    Cut(points, surface, surface.*gap).copyTo(column(cv::Rect(0, y, kWidth, kCutHeight)));
    y += kCutHeight + kGap;
  }
  return column;
}

}  // namespace

cv::Mat ScannerPicture(const TurnedScanner& before, const ScannerGeometry& found,
                       const std::vector<TurnedBeams>& sweeps) {
  const int sweep = found.surfaces.empty() ? 0 : found.surfaces.front().sweep;
  const TurnedBeams& beams = sweeps[static_cast<std::size_t>(sweep)];
  const double height = found.scanner.motor_from_scanner.translation.z();
  const Points old = PointsUnder(before, beams), now = PointsUnder(found.scanner, beams);
  const Extent extent = ExtentOf(now, height);
  const std::vector<DoubleSurface> cuts = WorstOf(found, sweep);
  const cv::Mat left =
      Column(Format("before: halves %.1f mm apart, RMS", 1000 * found.gap_before_m), old, extent,
             height, cuts, &DoubleSurface::gap_before_m);
  const cv::Mat right = Column(Format("after: %.1f mm", 1000 * found.gap_after_m), now, extent,
                               height, cuts, &DoubleSurface::gap_after_m);
  cv::Mat both;
  cv::hconcat(std::vector<cv::Mat>{left, cv::Mat(left.rows, kGap, CV_8UC3, kPaper), right}, both);
  cv::Mat picture;
  cv::copyMakeBorder(both, picture, kGap, 2 * kGap, kGap, kGap, cv::BORDER_CONSTANT, kPaper);
  Write("orange: beams ahead of the motor's axis; blue: beams behind it, half a turn later",
        {kGap, picture.rows - kGap}, 0.5, &picture);
  return picture;
}

}  // namespace rgbdt
