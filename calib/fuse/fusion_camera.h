#pragma once

#include <deque>
#include <limits>
#include <memory>
#include <optional>

#include "calib/camera/camera.h"
#include "calib/fuse/temperature_table.h"
#include "calib/model/calibration.h"
#include "calib/model/image.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// An image made ready to be sampled many times: a mosaic is demosaiced once.
struct PreparedImage {
  Utime utime = 0;
  cv::Mat pixels;  ///< CV_8UC3 BGR of a colour camera, CV_32FC1 counts of a thermal one
  Radiometry radiometry;
  std::shared_ptr<const TemperatureTable> temperatures = nullptr;  ///< FusionCamera::AddImage's
};

/// Throws InputError for an image that is not the camera's size or kind.
PreparedImage Prepare(const CameraSpec& camera, const Image& image);

/// The image that serves a time, and from when until before when it or its absence holds.
struct Serving {
  const PreparedImage* image = nullptr;  ///< null: none serves
  Utime from = std::numeric_limits<Utime>::min();
  Utime until = std::numeric_limits<Utime>::max();
};

/// One camera of the rig with its calibration and its newest images.
class FusionCamera {
 public:
  /// How long the last image goes on serving when no newer one comes.
  static constexpr Utime kMaxAge = 3 * kMicrosecondsPerSecond;
  static constexpr std::size_t kMaxImages = 16;

  explicit FusionCamera(const CameraSpec& spec);

  /// Which of more than kMaxImages goes: kThin where clouds wait for their poses, so that all of
  /// the time since then keeps images.
  enum class Full { kDropOldest, kThin };

  /// Keeps images in the order of their times, however they arrive.
  void AddImage(PreparedImage image, Full full = Full::kDropOldest);

  /// The LIDAR's time of an image's middle row: its utime and what the calibration's timing says.
  Utime TakenAt(const PreparedImage& image) const { return image.utime + offset_; }

  /// An image serves a point when it is the newest whose TakenAt + readout_s, and utime +
  /// readout_s, is not after the point's time, and whose TakenAt is not more than kMaxAge before
  /// it: a camera whose utime is late does not have its image earlier.
  Serving ServingAt(Utime point_utime) const;

  /// All points are served by the newest image, whatever their times: for files, where a view's
  /// image belongs to its cloud because the session says so.
  void ServeAllTimes() { all_times_ = true; }

  /// Images that served only points before `utime` are forgotten, but for the newest.
  void ForgetBefore(Utime utime);
  void ForgetImages() { images_.clear(); }

  /// Where it sits from now on, and the lens that belongs to that.
  void SetCalibration(const CameraCalibration& calibration, Utime utime);
  /// Whether it is set to this already.
  bool Has(const CameraCalibration& calibration, Utime utime) const;

  const CameraSpec& spec() const { return spec_; }
  const Camera& camera() const { return camera_; }

  bool calibrated = false;
  Rigid3 camera_from_lidar;
  Utime calibration_utime = 0;
  std::optional<RangeErrors> range_errors;  ///< of the LIDAR, as the calibration has them

 private:
  Utime ServesFrom(const PreparedImage& image) const;
  void Thin();

  CameraSpec spec_;
  Lens given_;  // by the rig
  double given_rolling_s_ = 0;
  std::optional<CameraTiming> timing_;
  Utime offset_ = 0;
  Camera camera_;
  Utime readout_ = 0;
  bool all_times_ = false;
  std::deque<PreparedImage> images_;
  std::shared_ptr<const TemperatureTable> temperatures_;  // of the newest radiometry
};

}  // namespace rgbdt
