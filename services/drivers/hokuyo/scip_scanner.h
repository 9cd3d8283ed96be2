#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "calib/model/cloud.h"
#include "calib/model/devices.h"
#include "services/drivers/device_report.h"
#include "services/drivers/hokuyo/scip_clock.h"
#include "services/drivers/hokuyo/scip_protocol.h"
#include "services/drivers/net/tcp_link.h"
#include "services/runtime/device_thread.h"

namespace rgbdt {

/// A scan as the bus wants it. `utime_of_step_0` on the host's clock: the scanner's time stamp is
/// that of step 0 of the turn (C-42-03320B, 8.1), from which the first beam is first_step periods
/// away. What is nearer than DMIN (errors' numbers) or farther than DMAX is NaN.
LineScan ToLineScan(const scip::Parameters& scanner, const scip::Scan& scan, Utime utime_of_step_0);

/// Intensity 1. SCIP carries 18 bit, the manufacturer's own library (urg_library,
/// urg_get_distance_intensity) hands out 16; what is above is 1, too.
inline constexpr float kScipFullIntensity = 65535;

/// A Hokuyo scanner with SCIP 2.0 over TCP -> LINE_SCAN, intensities where it offers them.
class ScipScanner {
 public:
  explicit ScipScanner(const HokuyoDevice& device) : device_(device) {}

  /// One connection, until it fails (DeviceError) or the thread stops.
  void Serve(DeviceThread& thread);
  const DeviceReport& report() const { return report_; }

 private:
  struct Connection;
  std::optional<scip::Block> WaitForReply(Connection& c, std::string_view echo, int timeout_ms);
  scip::Block Ask(Connection& c, std::string_view command);
  void Greet(Connection& c);
  void AlignClock(Connection& c);
  void Start(Connection& c);
  void Stream(Connection& c);
  void OnScan(Connection& c, const scip::Block& block, Utime arrival);
  void TellGap(Connection& c);

  HokuyoDevice device_;
  DeviceReport report_;
  std::optional<Utime> last_line_;  // when it came, by the steady clock
};

}  // namespace rgbdt
