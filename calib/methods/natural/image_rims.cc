#include "calib/methods/natural/image_rims.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "calib/model/statistics.h"

namespace rgbdt {
namespace {

constexpr double kBlurPx = 1.0;  // of the level, before gradients are taken
constexpr std::size_t kMostRims = 8;

cv::Mat Gradient(const cv::Mat& grey) {
  cv::Mat smooth, by[2], both;
  cv::GaussianBlur(grey, smooth, {0, 0}, kBlurPx);
  cv::Scharr(smooth, by[0], CV_32F, 1, 0, 1.0 / 32);
  cv::Scharr(smooth, by[1], CV_32F, 0, 1, 1.0 / 32);
  cv::merge(by, 2, both);
  return both;
}

// Three quarters of the pixels have less, of those that are not perfectly even.
double UsualLength(const cv::Mat& gradient) {
  std::vector<float> lengths;
  for (int y = 0; y < gradient.rows; y += 2) {
    const auto* row = gradient.ptr<cv::Vec2f>(y);
    for (int x = y / 2 % 3; x < gradient.cols; x += 3) {
      const float length = std::hypot(row[x][0], row[x][1]);
      if (length > 0) lengths.push_back(length);
    }
  }
  if (lengths.empty()) return 0;
  const std::size_t place = lengths.size() * 3 / 4;
  return Nth(std::move(lengths), place);
}

}  // namespace

ImageRims::ImageRims(const cv::Mat& grey, int level) : pixels_(std::ldexp(1.0, level)) {
  cv::Mat coarse = grey;
  if (level > 0) {
    const cv::Size size(std::max(8, grey.cols >> level), std::max(8, grey.rows >> level));
    // Whole blocks of pixels, so that a level's pixel is where ToLevel says.
    const cv::Rect whole(0, 0, std::min(grey.cols, size.width << level),
                         std::min(grey.rows, size.height << level));
    cv::resize(grey(whole), coarse, size, 0, 0, cv::INTER_AREA);
  }
  gradient_ = Gradient(coarse);
  usual_ = UsualLength(gradient_);
}

Eigen::Vector2d ImageRims::GradientAt(const Eigen::Vector2d& at) const {
  const int x = static_cast<int>(at.x());
  const int y = static_cast<int>(at.y());
  const auto fx = static_cast<float>(at.x() - x);
  const auto fy = static_cast<float>(at.y() - y);
  const auto* upper = gradient_.ptr<cv::Vec2f>(y) + x;
  const auto* lower = gradient_.ptr<cv::Vec2f>(y + 1) + x;
  const cv::Vec2f g =
      (upper[0] * (1 - fx) + upper[1] * fx) * (1 - fy) + (lower[0] * (1 - fx) + lower[1] * fx) * fy;
  return {g[0], g[1]};
}

void ImageRims::Meet(const Eigen::Vector2d& at, const Eigen::Vector2d& normal, int reach,
                     std::vector<ImageRim>* rims) const {
  rims->clear();
  if (!(usual_ > 0)) return;
  double before = 0, here = 0;
  Eigen::Vector2d here_gradient = Eigen::Vector2d::Zero();
  bool both = false;
  for (int step = -reach - 1; step <= reach + 1; ++step) {
    const Eigen::Vector2d place = at + step * normal;
    if (!Contains(place)) {
      both = false;
      here = before = 0;
      here_gradient.setZero();
      continue;
    }
    const Eigen::Vector2d gradient = GradientAt(place);
    const double after = std::abs(gradient.dot(normal));
    if (both && here > 0.5 * usual_ && here >= before && here > after) {
      const double bend = before - 2 * here + after;
      const double aside = bend < 0 ? 0.5 * (before - after) / bend : 0;
      const double length = here_gradient.norm();
      // An edge that runs another way is hardly the line's own.
      const double straight = std::pow(here / length, 4);
      rims->push_back(
          {step - 1 + aside, here_gradient / length, straight * here / (here + usual_)});
    }
    both = here > 0 || both;
    before = here;
    here = after;
    here_gradient = gradient;
  }
  if (rims->size() <= kMostRims) return;
  std::vector<double> strengths;
  for (const ImageRim& rim : *rims) strengths.push_back(-rim.strength);
  const double least = -Nth(std::move(strengths), kMostRims - 1);
  rims->erase(std::remove_if(rims->begin(), rims->end(),
                             [&](const ImageRim& rim) { return rim.strength < least; }),
              rims->end());
}

}  // namespace rgbdt
