#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "calib/model/time.h"

namespace rgbdt {

/// One scan as a scripted scanner measures it.
struct ScipPeerScan {
  std::vector<std::uint32_t> range_mm;   ///< one a step from first_step to last_step
  std::vector<std::uint32_t> intensity;  ///< as long
};

struct ScipPeerOptions {
  /// What it measures in its scan number `index`, whose step 0 is at `device_ms` on its clock.
  std::function<ScipPeerScan(std::int64_t index, double device_ms)> scan;
  int port = 0;  ///< on 127.0.0.1; 0: any free one
  std::string model = "UTM-30LX-EW(Hokuyo Automatic Co.,Ltd.)";
  int least_mm = 23, most_mm = 60000;
  int steps = 1440, first_step = 0, last_step = 1080, front_step = 540, rpm = 2400;
  bool intensities = true;    ///< whether it knows ME
  bool time_mode = true;      ///< whether it knows TM
  bool time_mode_on = false;  ///< whether somebody left it there; then it takes nothing but TM
  double clock_rate = 1;      ///< of its clock against the true one
  double clock_start_ms = 0;  ///< its clock when it is made
  double send_ms = 2;         ///< from the last step to the sending
  double send_jitter_ms = 1;  ///< on top, 0 to this much, differing from scan to scan
};

/// A scanner with SCIP 2.0 on 127.0.0.1, for tests and demos: answers commands and, once told to
/// measure, sends its scans at the pace of its motor. One client at a time. It shares no code with
/// the driver.
class ScipPeer {
 public:
  enum class Fault {
    kBadChecksum,  ///< the next scan has one wrong character
    kClose,        ///< closes the connection instead of the next scan
    kSilent,       ///< sends nothing more to this client
    kPieces,       ///< sends the next scan in pieces of a few bytes
    kRubbish,      ///< sends bytes that mean nothing before the next scan
  };

  explicit ScipPeer(ScipPeerOptions options);
  ~ScipPeer();
  ScipPeer(const ScipPeer&) = delete;
  ScipPeer& operator=(const ScipPeer&) = delete;

  int port() const { return port_; }
  /// Happens once.
  void Inject(Fault fault);
  /// When scan `index` was at step 0, true time [us, UTC].
  Utime StepZero(std::int64_t index) const;
  std::int64_t scans_sent() const { return scans_sent_; }
  std::int64_t clients() const { return clients_; }
  /// Commands as they came, without line feeds.
  std::vector<std::string> commands() const;

 private:
  struct Client;
  void Run();
  void Serve(int socket);
  void Answer(Client* client, const std::string& command);
  bool SendDueScan(Client* client);
  bool SendScan(Client* client, std::int64_t index);
  double DeviceMs(double utime) const;
  bool TakeFault(Fault fault);

  ScipPeerOptions options_;
  int listener_ = -1;
  int port_ = 0;
  double epoch_us_ = 0;        // scan 0 at step 0
  bool time_mode_on_ = false;  // of the thread
  std::atomic<bool> stopping_{false};
  std::atomic<std::int64_t> scans_sent_{0}, clients_{0};
  mutable std::mutex mutex_;
  std::vector<Fault> faults_;
  std::vector<std::string> commands_;
  std::thread thread_;
};

}  // namespace rgbdt
