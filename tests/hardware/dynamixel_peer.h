#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "tests/hardware/dynamixel_peer_motion.h"

namespace rgbdt::test {

/// The packets as the servo sees them; written anew, so that a mistake of the driver's is not made
/// twice.
using PeerBytes = std::vector<std::uint8_t>;
struct PeerInstruction {
  int id = 0;
  int instruction = 0;
  PeerBytes parameters;
};
PeerBytes PeerStatusPacket(int id, int error, const PeerBytes& parameters);
/// Takes the first instruction that is whole and undamaged off the stream.
std::optional<PeerInstruction> PeerTakeInstruction(PeerBytes* stream);

/// A Dynamixel Pro servo on a pseudo-terminal, in a thread of its own. It knows where it is at any
/// time, takes the time that its bytes need on the wire, and can be made to fail.
class DynamixelPeer {
 public:
  struct Options {
    int id = 1;
    int model = 54024;  ///< H54-200-S500-R
    double position = 0;
    std::int64_t min_position = -250961, max_position = 250961;
    int operating_mode = 3;
    int return_delay = 250;         ///< its Return Delay Time at first [2 us], as it is delivered
    double sample_latency_us = 20;  ///< from the request's last bit to the position's
    double reply_latency_us = 100;  ///< from there to the answer's first bit, beside the delay
    std::string link;               ///< a name for the port that stays the same when plugged in
  };
  struct Faults {
    int bad_checksum_every = 0;  ///< each nth answer; 0: none
    bool silent = false;
    std::optional<double> stall_at;  ///< [ticks]: nothing moves it past
    int hardware_error = 0;          ///< Hardware Error Status; torque goes off
    int noise_bytes = 0;             ///< before each answer
  };
  struct State {
    bool torque = false;
    int return_delay = 0;
    std::int64_t goal = 0;
    int moves = 0;  ///< goals that it was told while under torque
    int answers = 0;
  };

  explicit DynamixelPeer(const Options& options);
  ~DynamixelPeer();
  DynamixelPeer(const DynamixelPeer&) = delete;
  DynamixelPeer& operator=(const DynamixelPeer&) = delete;

  /// The port to open: the link, where there is one.
  std::string port() const;
  void SetFaults(const Faults& faults);
  State state() const;
  /// Truth, for any time [us UTC] since it was made.
  double TrueTicksAt(double utime) const;
  double TrueSpeedAt(double utime) const;  ///< [ticks/s]

  void Unplug();
  void PlugIn();

 private:
  void Run();
  void Answer(const PeerInstruction& instruction);
  void Reply(int error, const PeerBytes& parameters);
  int Write(int address, const PeerBytes& value);
  PeerBytes Read(int address, int size) const;
  void Move();
  double ByteUs() const;

  const Options options_;
  mutable std::mutex mutex_;  // guards all of these
  std::map<int, std::uint8_t> table_;
  PeerMotion motion_;
  Faults faults_;
  State state_;
  std::string port_;
  int master_ = -1, slave_ = -1;

  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace rgbdt::test
