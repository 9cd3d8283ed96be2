#include "services/drivers/camera/shutter_watch.h"

#include <cstring>
#include <opencv2/core.hpp>

namespace rgbdt {

bool ShutterWatch::IsSame(const cv::Mat& counts) const {
  if (last_.size() != counts.size() || last_.type() != counts.type()) return false;
  const std::size_t row_bytes = static_cast<std::size_t>(counts.cols) * counts.elemSize();
  for (int row = 0; row < counts.rows; ++row) {
    if (std::memcmp(counts.ptr(row), last_.ptr(row), row_bytes) != 0) return false;
  }
  return true;
}

bool ShutterWatch::IsFrozen(const cv::Mat& counts, Utime utime) {
  constexpr double kForget = 0.3;  // of a change
  const Utime period = utime - newest_;
  const Utime stands = utime - changed_;
  newest_ = utime;
  if (IsSame(counts)) {
    return static_cast<double>(stands) > usual_us_ - 0.5 * static_cast<double>(period) &&
           stands < kLongest;
  }
  if (stands < kSlowest) {
    usual_us_ += (usual_us_ > 0 ? kForget : 1) * (static_cast<double>(stands) - usual_us_);
  }
  changed_ = utime;
  last_ = counts;
  return false;
}

bool ShutterWatch::IsFlat(const cv::Mat& counts) {
  constexpr double kForget = 0.05;  // of a frame: some seconds at 9 to 30 Hz
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(counts, mean, deviation);
  const double spread = deviation[0];
  if (usual_spread_ > 0 && spread < kFlat * usual_spread_) return true;
  usual_spread_ += (usual_spread_ > 0 ? kForget : 1) * (spread - usual_spread_);
  return false;
}

bool ShutterWatch::Add(const cv::Mat& counts, Utime utime) {
  if (IsFrozen(counts, utime) || IsFlat(counts)) until_ = utime + kSettle;
  return utime <= until_;
}

}  // namespace rgbdt
