#include "calib/present/pictures/internal/splats.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "calib/present/pictures/internal/viewpoint.h"

namespace rgbdt {
namespace {

// Calls visit(x, y, weight) for each pixel of a disc in a picture of `size`; weight 1 in the
// middle, near 0 at the rim.
template <typename Visit>
void VisitDisc(const Splat& splat, const cv::Size& size, Visit visit) {
  const double squared = splat.radius * splat.radius;
  const int y0 = std::max(0, static_cast<int>(std::ceil(splat.centre.y - splat.radius)));
  const int y1 =
      std::min(size.height - 1, static_cast<int>(std::floor(splat.centre.y + splat.radius)));
  for (int y = y0; y <= y1; ++y) {
    const double dy = y - splat.centre.y;
    const double half = std::sqrt(std::max(0.0, squared - dy * dy));
    const int x0 = std::max(0, static_cast<int>(std::ceil(splat.centre.x - half)));
    const int x1 = std::min(size.width - 1, static_cast<int>(std::floor(splat.centre.x + half)));
    for (int x = x0; x <= x1; ++x) {
      const double dx = x - splat.centre.x;
      visit(x, y, static_cast<float>(1.02 - (dx * dx + dy * dy) / squared));
    }
  }
}

// What is nearer by less belongs to the same surface [m].
float Tolerance(float depth) { return 0.04f + 0.01f * depth; }

// The first pixel from `at` on, towards `step`, that stands in front of `limit`.
bool FindInFront(const Canvas& canvas, cv::Point at, cv::Point step, float limit,
                 cv::Point* found) {
  constexpr int kReach = 2 * kSupersampling + 1;
  const cv::Rect whole({0, 0}, canvas.depth.size());
  for (int i = 0; i < kReach; ++i) {
    at += step;
    if (!whole.contains(at)) return false;
    *found = at;
    if (canvas.depth.at<float>(at) < limit) return true;
  }
  return false;
}

// The mean of pixels, unless they are of different surfaces.
void TakeMean(const Canvas& from, const std::array<cv::Point, 8>& pixels, std::size_t count,
              cv::Point at, Canvas* to) {
  cv::Vec4f sum(0, 0, 0, 0);
  float nearest = kNoDepth, farthest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const cv::Vec3b& c = from.bgr.at<cv::Vec3b>(pixels[i]);
    const float depth = from.depth.at<float>(pixels[i]);
    sum += cv::Vec4f(c[0], c[1], c[2], depth);
    nearest = std::min(nearest, depth);
    farthest = std::max(farthest, depth);
  }
  if (farthest > nearest + 3 * Tolerance(nearest)) return;
  sum /= static_cast<float>(count);
  for (int c = 0; c < 3; ++c) {
    to->bgr.at<cv::Vec3b>(at)[c] = cv::saturate_cast<unsigned char>(sum[c]);
  }
  to->depth.at<float>(at) = sum[3];
}

// Three of the four lines through the pixel must have nearer ones on both sides: outside a
// surface's edge or corner no pixel has.
void ClosePixel(const Canvas& from, cv::Point at, Canvas* to) {
  const float depth = from.depth.at<float>(at);
  const float limit = depth == kNoDepth ? kNoDepth : depth - Tolerance(depth);
  std::array<cv::Point, 8> found;
  std::size_t count = 0;
  int open = 0;
  for (const cv::Point step : {cv::Point(1, 0), {0, 1}, {1, 1}, {1, -1}}) {
    if (FindInFront(from, at, step, limit, &found[count]) &&
        FindInFront(from, at, -step, limit, &found[count + 1])) {
      count += 2;
    } else if (++open > 1) {
      return;
    }
  }
  TakeMean(from, found, count, at, to);
}

// How much of its light a pixel keeps: less, the further its surroundings stand in front of it.
double LightAt(const cv::Mat& logs, int y, int x) {
  constexpr double kStrength = 6;
  const float here = logs.at<float>(y, x);
  float sum = 0;
  for (const int reach : {kSupersampling, 3 * kSupersampling}) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const int ny = std::clamp(y + dy * reach, 0, logs.rows - 1);
        const int nx = std::clamp(x + dx * reach, 0, logs.cols - 1);
        // Bounded: one large step is to draw a line, not to blacken a surface.
        sum += std::clamp(here - logs.at<float>(ny, nx), 0.f, 0.04f);
      }
    }
  }
  return std::exp(-kStrength * sum / 2);
}

}  // namespace

void DrawSplats(const std::vector<Splat>& splats, Canvas* canvas) {
  const cv::Size size = canvas->bgr.size();
  cv::Mat front(size, CV_32FC1, cv::Scalar(kNoDepth));
  for (const Splat& splat : splats) {
    VisitDisc(splat, size, [&](int x, int y, float) {
      float& depth = front.at<float>(y, x);
      depth = std::min(depth, splat.depth);
    });
  }
  cv::Mat sums(size, CV_32FC4, cv::Scalar::all(0));  // colour and weight
  cv::Mat depths(size, CV_32FC1, cv::Scalar::all(0));
  for (const Splat& splat : splats) {
    VisitDisc(splat, size, [&](int x, int y, float weight) {
      const float nearest = front.at<float>(y, x);
      if (splat.depth > nearest + Tolerance(nearest)) return;
      sums.at<cv::Vec4f>(y, x) += weight * cv::Vec4f(splat.bgr[0], splat.bgr[1], splat.bgr[2], 1);
      depths.at<float>(y, x) += weight * splat.depth;
    });
  }
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const cv::Vec4f& sum = sums.at<cv::Vec4f>(y, x);
      if (sum[3] <= 0) continue;
      for (int c = 0; c < 3; ++c) {
        canvas->bgr.at<cv::Vec3b>(y, x)[c] = cv::saturate_cast<unsigned char>(sum[c] / sum[3]);
      }
      canvas->depth.at<float>(y, x) = depths.at<float>(y, x) / sum[3];
    }
  }
}

void CloseHoles(Canvas* canvas) {
  // The second pass closes where two of the first one's gaps cross.
  for (int pass = 0; pass < 2; ++pass) {
    const Canvas before{canvas->bgr.clone(), canvas->depth.clone()};
    for (int y = 0; y < canvas->depth.rows; ++y) {
      for (int x = 0; x < canvas->depth.cols; ++x) ClosePixel(before, {x, y}, canvas);
    }
  }
}

void Shade(Canvas* canvas) {
  cv::Mat logs;
  cv::log(canvas->depth, logs);
  for (int y = 0; y < logs.rows; ++y) {
    for (int x = 0; x < logs.cols; ++x) {
      if (canvas->depth.at<float>(y, x) == kNoDepth) continue;
      const double light = LightAt(logs, y, x);
      cv::Vec3b& pixel = canvas->bgr.at<cv::Vec3b>(y, x);
      for (int c = 0; c < 3; ++c) pixel[c] = cv::saturate_cast<unsigned char>(pixel[c] * light);
    }
  }
}

}  // namespace rgbdt
