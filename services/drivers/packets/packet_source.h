#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "calib/model/devices.h"
#include "services/drivers/device_report.h"
#include "services/drivers/packets/packet_sweeps.h"
#include "services/runtime/device_thread.h"

namespace rgbdt {

/// A LIDAR that sends packets, or a recording of them at its own pace -> CLOUD, sweep by sweep.
/// Packets that are none of its sweeps' (positions, gyro) are passed over, bad ones counted and
/// named.
class PacketSource {
 public:
  /// Reads what says how to decode, and opens the recording, if there is one: throws InputError
  /// where that fails.
  explicit PacketSource(const VelodyneDevice& device);
  explicit PacketSource(const PacketLidarDevice& device);

  /// Until the thread stops, or the recording ends.
  void Serve(DeviceThread& thread);
  const DeviceReport& report() const { return report_; }
  /// The UDP port that it listens at; 0: not yet.
  int port() const { return port_; }

 private:
  struct Link {
    int port;
    std::string pcap;      // empty: the network
    std::string metadata;  // file; for messages
  };
  PacketSource(Link link, std::unique_ptr<PacketSweeps> sweeps, std::string name);

  void Listen(DeviceThread& thread);
  void Play(DeviceThread& thread);
  /// `counter`: of the report, what it counts as.
  void Take(DeviceThread& thread, const std::vector<std::uint8_t>& payload, Utime utime,
            const char* counter);
  std::int64_t ReportLosses(DeviceThread& thread);
  void LookAt(DeviceThread& thread, const Cloud& sweep, std::int64_t lost, Utime arrival) const;
  void Publish(DeviceThread& thread, const Cloud& sweep);
  std::string OthersText() const;
  int InformationPort() const;  // 0: none

  Link link_;
  std::unique_ptr<PacketSweeps> sweeps_;  // of a Livox none until a packet tells which
  std::string name_;                      // "OS-1-64", "Livox"
  DeviceReport report_;
  std::size_t other_bytes_ = 0;  // of the last packet that is none of its sweeps'
  std::vector<std::int64_t> lost_reported_;
  std::int64_t steps_reported_ = 0;
  std::atomic<int> port_{0};
};

}  // namespace rgbdt
