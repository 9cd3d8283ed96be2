#pragma once

#include <opencv2/core/mat.hpp>

#include "calib/model/time.h"

namespace rgbdt {

/// Tells when a thermal camera corrects itself against its shutter (FFC, about half a second).
/// GenICam has no feature that says so for each frame, so the frames themselves tell: a core
/// freezes its picture meanwhile, which noise never repeats, or shows the shutter, which is flat.
/// What follows within kSettle is not trusted either. A slow core's frames (9 Hz) may be sent
/// several times each: that is learnt. What stands for longer than kLongest is no correction.
class ShutterWatch {
 public:
  static constexpr Utime kSettle = kMicrosecondsPerSecond / 5;
  static constexpr Utime kLongest = 2 * kMicrosecondsPerSecond;
  static constexpr Utime kSlowest = kMicrosecondsPerSecond / 5;  ///< between a core's new pictures
  /// Of the scene's usual spread of counts; below, the picture is flat.
  static constexpr double kFlat = 0.1;

  /// Takes the next frame, CV_16UC1 or CV_8UC1, of `utime`. True: it is not to be used.
  bool Add(const cv::Mat& counts, Utime utime);

 private:
  bool IsSame(const cv::Mat& counts) const;
  bool IsFrozen(const cv::Mat& counts, Utime utime);
  bool IsFlat(const cv::Mat& counts);

  cv::Mat last_;
  Utime newest_ = 0, changed_ = 0;  // times of the last frame, and of the first one like it
  double usual_us_ = 0;             // between changes
  double usual_spread_ = 0;         // of counts, over the last seconds
  Utime until_ = 0;
};

}  // namespace rgbdt
