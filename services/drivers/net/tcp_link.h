#pragma once

#include <string>
#include <string_view>

#include "calib/model/time.h"

namespace rgbdt {

/// A TCP connection to a device. Never waits longer than told. What fails throws DeviceError with
/// address and port.
class TcpLink {
 public:
  TcpLink(const std::string& address, int port, int timeout_ms);
  ~TcpLink();
  TcpLink(const TcpLink&) = delete;
  TcpLink& operator=(const TcpLink&) = delete;

  void Send(std::string_view bytes);
  /// What has come, at most after `timeout_ms`; empty: nothing.
  std::string Receive(int timeout_ms);
  /// When what Receive gave came [us, UTC].
  Utime arrival() const { return arrival_; }
  /// The same moment by the machine's steady clock, for durations [us].
  Utime steady_arrival() const { return steady_arrival_; }
  /// "192.168.0.10:10940"
  const std::string& name() const { return name_; }

 private:
  [[noreturn]] void Fail(const std::string& what) const;

  std::string name_;
  int socket_ = -1;
  Utime arrival_ = 0, steady_arrival_ = 0;
};

}  // namespace rgbdt
