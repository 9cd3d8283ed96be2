#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/devices.h"
#include "services/drivers/device_report.h"
#include "services/drivers/pcap/pcap_reader.h"
#include "services/drivers/velodyne/velodyne_sweeps.h"
#include "services/runtime/device_thread.h"

namespace rgbdt {

/// A UDP port of this machine.
class UdpPort {
 public:
  /// 0: any free one. Throws DeviceError, for example where another program has it.
  explicit UdpPort(int port);
  ~UdpPort();
  UdpPort(const UdpPort&) = delete;
  UdpPort& operator=(const UdpPort&) = delete;

  int port() const { return port_; }
  struct Datagram {
    Utime utime = 0;  ///< when the kernel had it
    std::vector<std::uint8_t> payload;
  };
  /// The next datagram, at most after `timeout_ms`; nothing: none came.
  std::optional<Datagram> Receive(int timeout_ms);

 private:
  int socket_ = -1;
  int port_ = 0;
};

/// A Velodyne LIDAR, or a recording at its own pace -> CLOUD, revolution by revolution. Position
/// packets are passed over, bad ones counted and named.
class VelodyneSource {
 public:
  /// Opens the recording, if there is one: throws InputError where that fails.
  explicit VelodyneSource(const VelodyneDevice& device);

  /// Until the thread stops, or the recording ends.
  void Serve(DeviceThread& thread);
  const DeviceReport& report() const { return report_; }
  bool live() const { return device_.pcap.empty(); }
  /// The UDP port that it listens at; 0: not yet.
  int port() const { return port_; }

 private:
  void Listen(DeviceThread& thread);
  void Play(DeviceThread& thread);
  void Take(DeviceThread& thread, const std::vector<std::uint8_t>& payload, Utime utime);

  VelodyneDevice device_;
  DeviceReport report_;
  VelodyneSweeps sweeps_;
  std::int64_t lost_reported_ = 0, steps_reported_ = 0;
  std::atomic<int> port_{0};
};

}  // namespace rgbdt
