#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/rig.h"

namespace rgbdt {

/// One buffer of a camera's stream. `data` is the stream's own: valid while it is taken.
struct CameraFrame {
  std::string problem;  ///< why it is not whole; empty: it is
  const void* data = nullptr;
  std::size_t size = 0;  ///< bytes
  int width = 0, height = 0;
  std::uint32_t format = 0;  ///< GenicamFormat
  std::int64_t number = 0;   ///< the device's own count
  Utime device_utime = 0;    ///< the device's own clock, its own epoch
  Utime arrival_utime = 0;   ///< of its first packet, host's clock
};

/// A GigE Vision or USB3 Vision camera through Aravis: found, set, streaming for as long as this
/// lives. Everything throws DeviceError, with what to do, where the camera is not there or lost.
class GenicamCamera {
 public:
  static constexpr int kBuffers = 16;
  static constexpr int kSocketBytes = 8 * 1024 * 1024;

  /// Sets size, pixel format and trigger as the rig file says, then the features that it lists, in
  /// order; reads each back. What the camera did not take is in warnings().
  explicit GenicamCamera(const CameraSpec& spec);
  ~GenicamCamera();

  const std::vector<std::string>& warnings() const;

  /// Hands over the next buffer, whole or not; false: none came in time.
  bool Next(int timeout_ms, const std::function<void(const CameraFrame& frame)>& take);

  /// Takes one image, with CameraDevice::Trigger::kSoftware.
  void Trigger();

  /// Asked of the camera; nothing where it does not tell.
  std::optional<double> ExposureSeconds();
  std::optional<double> TemperatureCelsius();
  /// Its clock follows PTP: device_utime is TAI or UTC (PtpToUtc).
  bool FollowsPtp();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rgbdt
