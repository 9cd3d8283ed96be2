#pragma once

#include <deque>
#include <vector>

#include "calib/camera/camera.h"
#include "calib/model/cloud.h"
#include "calib/model/image.h"
#include "calib/model/rgbdt_cloud.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// An image made ready to be sampled many times: a mosaic is demosaiced once.
struct PreparedImage {
  Utime utime = 0;
  cv::Mat pixels;  ///< CV_8UC3 BGR of a colour camera, CV_32FC1 counts of a thermal one
  Radiometry radiometry;
};

/// Throws InputError for an image that is not the camera's size or kind.
PreparedImage Prepare(const CameraSpec& camera, const Image& image);

/// One camera of the rig with its calibration and its newest images.
class FusionCamera {
 public:
  /// How long the last image goes on serving when no newer one comes.
  static constexpr Utime kMaxAge = 3 * kMicrosecondsPerSecond;
  static constexpr std::size_t kMaxImages = 16;

  explicit FusionCamera(const CameraSpec& spec);

  /// Keeps images in the order of their times, however they arrive; the oldest go first.
  void AddImage(PreparedImage image);

  /// The image that serves a point: the newest whose utime + readout_s is not after the point's
  /// time and not more than kMaxAge before it. Null: none.
  const PreparedImage* ImageAt(Utime point_utime) const;

  /// All points are served by the newest image, whatever their times: for files, where a view's
  /// image belongs to its cloud because the session says so.
  void ServeAllTimes() { all_times_ = true; }

  /// Images that served only points before `utime` are forgotten.
  void ForgetBefore(Utime utime);

  const CameraSpec& spec() const { return spec_; }
  const Camera& camera() const { return camera_; }

  bool calibrated = false;
  Rigid3 camera_from_lidar;

 private:
  CameraSpec spec_;
  Camera camera_;
  Utime readout_ = 0;
  bool all_times_ = false;
  std::deque<PreparedImage> images_;
};

/// Colours a cloud: each hit is projected into the image of each camera that serves its time and
/// sampled bilinearly. No colour for a point behind a camera, outside its image, or beyond the
/// angle where the lens polynomial folds back. Where several cameras of a kind see a point, the
/// first of the rig counts. `seq`, `sweep_end` and `calibration_utime` are left to the caller.
RgbdtCloud Fuse(const Cloud& cloud, const std::vector<FusionCamera>& cameras);

}  // namespace rgbdt
