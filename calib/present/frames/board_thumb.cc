#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "calib/files/image_files.h"
#include "calib/present/frames/overlay_frame.h"
#include "calib/present/layout/frame.h"

namespace rgbdt {
namespace {

constexpr int kWidth = 240, kHeight = 180, kQuality = 85;
constexpr double kNearPlaneM = 0.1;  // a bent board, and the ranges' noise
constexpr double kRoundItM = 1.0;    // before and behind it
constexpr double kFits = 1.1;        // what is shown, over the board's diagonal
constexpr int kGreyest = 60, kUnknownGrey = 170;
const cv::Scalar kBackground(30, 26, 22), kMark(80, 220, 60);

// The board's plane as a person standing at the LIDAR sees it.
struct Look {
  Eigen::Vector3d centre, right, up, normal;
  double px_per_m = 0, reach_m = 0;

  Eigen::Vector3d From(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d p = point - centre;
    return {right.dot(p), up.dot(p), normal.dot(p)};
  }
  cv::Point Pixel(const Eigen::Vector3d& p) const {
    return {static_cast<int>(std::lround(0.5 * (kWidth - 1) + px_per_m * p.x())),
            static_cast<int>(std::lround(0.5 * (kHeight - 1) - px_per_m * p.y()))};
  }
};

Look LookAt(const CloudEdges& board) {
  Look look;
  look.centre = board.centre;
  look.normal = board.normal;
  // Of a board that lies flat, the far end is up.
  const bool flat = std::abs(board.normal.z()) > 0.95;
  const Eigen::Vector3d upwards = flat ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitZ();
  look.up = (upwards - upwards.dot(board.normal) * board.normal).normalized();
  look.right = look.up.cross(board.normal);
  const double diagonal = std::max(0.05, std::hypot(board.width_m, board.height_m));
  look.px_per_m = kHeight / (kFits * diagonal);
  look.reach_m = 0.5 * diagonal;
  return look;
}

struct Dot {
  cv::Point at;
  float intensity = 0;
  bool on_board = false;
};

// What lies round the board first: the board's own points are drawn over it.
std::vector<Dot> DotsOf(const Look& look, const Cloud& cloud) {
  std::vector<Dot> dots;
  const cv::Rect picture(0, 0, kWidth, kHeight);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud.IsHit(i)) continue;
    const Eigen::Vector3d p = look.From(cloud.points[i].cast<double>());
    if (!(std::abs(p.z()) < kRoundItM)) continue;
    const cv::Point at = look.Pixel(p);
    if (!picture.contains(at)) continue;
    const bool on_board = std::abs(p.z()) < kNearPlaneM && p.head<2>().norm() < look.reach_m;
    dots.push_back({at, i < cloud.intensity.size() ? cloud.intensity[i] : NAN, on_board});
  }
  std::stable_partition(dots.begin(), dots.end(), [](const Dot& dot) { return !dot.on_board; });
  return dots;
}

// Intensities of the board that become dark and bright: black squares and white ones.
std::pair<float, float> LimitsOf(const std::vector<Dot>& dots) {
  std::vector<float> known;
  for (const Dot& dot : dots) {
    if (dot.on_board && std::isfinite(dot.intensity)) known.push_back(dot.intensity);
  }
  if (known.empty()) return {0, 1};
  std::sort(known.begin(), known.end());
  const float low = known[known.size() / 50];
  return {low, std::max(known[known.size() - 1 - known.size() / 50], low + 0.02F)};
}

cv::Scalar GreyOf(const Dot& dot, const std::pair<float, float>& limits) {
  double grey = kUnknownGrey;
  if (std::isfinite(dot.intensity)) {
    const double share = (dot.intensity - limits.first) / (limits.second - limits.first);
    grey = kGreyest + (255 - kGreyest) * std::clamp(share, 0.0, 1.0);
  }
  return cv::Scalar::all(dot.on_board ? grey : 0.35 * grey);
}

void DrawMarks(const Look& look, const CloudEdges& board, cv::Mat* picture) {
  const auto mark = [&](const Eigen::Vector3d& point) {
    cv::drawMarker(*picture, look.Pixel(look.From(point)), kMark, cv::MARKER_TILTED_CROSS, 3);
  };
  for (const Crossing& crossing : board.crossings) mark(crossing.point);
  if (!board.crossings.empty()) return;  // by the paper's method
  for (const Eigen::Vector3d& point : board.boundary) mark(point);
}

cv::Mat Draw(const CloudEdges& board, const Cloud& cloud) {
  const Look look = LookAt(board);
  cv::Mat picture(kHeight, kWidth, CV_8UC3, kBackground);
  const int radius =
      std::clamp(static_cast<int>(std::lround(0.4 * board.spacing_m * look.px_per_m)), 1, 3);
  const std::vector<Dot> dots = DotsOf(look, cloud);
  const auto limits = LimitsOf(dots);
  for (const Dot& dot : dots) {
    cv::circle(picture, dot.at, radius, GreyOf(dot, limits), cv::FILLED);
  }
  DrawMarks(look, board, &picture);
  return picture;
}

}  // namespace

std::string BoardThumbFrame(const std::string& view, const CloudEdges& board, const Cloud& cloud) {
  FrameWriter frame(
      {{"type", "thumb"}, {"view", view}, {"camera", ""}, {"width", kWidth}, {"height", kHeight}});
  frame.AddBytes("jpeg", EncodeJpeg(Draw(board, cloud), kQuality));
  return frame.Finish();
}

}  // namespace rgbdt
