#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "services/runtime/node.h"

namespace rgbdt {

/// A device does not do what it should: which one, what, and what to do. It is tried again.
class DeviceError : public std::runtime_error {
 public:
  explicit DeviceError(const std::string& what) : std::runtime_error(what) {}
};

/// What a device's thread has published and warned of since it was asked last.
struct DeviceOutput {
  Messages messages;
  std::vector<std::string> warnings;
};

/// A thread that serves one device and may wait for it, and its output for the process's loop.
///
/// `serve` opens the device and serves it until Stopping(). When it throws, the reason is a warning
/// and it is called again kRetryMs later, for as long as it takes: a device that was unplugged
/// comes back without a restart. When it returns, there is nothing more to serve (a file's end).
class DeviceThread {
 public:
  static constexpr int kRetryMs = 500;
  static constexpr std::size_t kMaxWaiting = 1000;  ///< messages; the oldest go first

  using Serve = std::function<void(DeviceThread& thread)>;
  /// `most_waiting`: fewer, where messages are large.
  explicit DeviceThread(Serve serve, std::size_t most_waiting = kMaxWaiting);
  /// Waits until `serve` has returned.
  ~DeviceThread() { Stop(); }
  DeviceThread(const DeviceThread&) = delete;
  DeviceThread& operator=(const DeviceThread&) = delete;

  /// For `serve`.
  bool Stopping() const { return stopping_; }
  /// Sleeps, but not once it is to stop: then false.
  bool Sleep(Utime us);
  void Publish(Message message);
  void Warn(const std::string& warning);

  /// For the process's loop.
  DeviceOutput Take();
  /// `serve` has returned and all its output was taken.
  bool ended() const;
  void Stop();

 private:
  void Run();

  Serve serve_;
  std::size_t most_waiting_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  DeviceOutput output_;
  std::int64_t overflown_ = 0;
  std::atomic<bool> stopping_{false};
  std::atomic<bool> returned_{false};
  std::thread thread_;  // last: it uses all the others
};

/// A node that speaks for a device, which a thread of its own serves.
class DeviceNode : public Node {
 public:
  Utime LongestWait() const override { return 2000; }

 protected:
  /// The thread's messages; its warnings become the node's.
  Messages TakeFrom(DeviceThread* thread) const;
};

}  // namespace rgbdt
