#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace rgbdt {

/// A serial port, raw, 8N1, for this process alone. Works on a pseudo-terminal.
/// What goes wrong is a DeviceError that says what to do.
class SerialPort {
 public:
  /// `baud` [bit/s]: any that the hardware can make, 1 to 4 million included. Where the driver
  /// offers it (USB adapters), what has been received is handed on at once.
  SerialPort(const std::string& path, int baud);
  ~SerialPort();
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;

  void Write(const std::vector<std::uint8_t>& bytes);
  /// What has been received; waits `timeout_us` for the first byte. Empty: nothing came.
  std::vector<std::uint8_t> Read(std::int64_t timeout_us);
  /// Forgets what has been received.
  void Discard();

 private:
  void Open();
  void Configure(int baud);
  /// True once `events` (of poll) are there.
  bool Wait(short events, std::int64_t timeout_us);
  [[noreturn]] void Fail(const std::string& what) const;

  std::string path_;
  int fd_ = -1;
};

}  // namespace rgbdt
