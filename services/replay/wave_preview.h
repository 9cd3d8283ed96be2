#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "services/messages/bytes.h"
#include "services/replay/wave_reader.h"

namespace rgbdt {

/// What a solve tells of each camera's clock.
std::vector<WavedClock> ClocksOf(const SyncResult& result);

/// What a wave tells so far, for who waves: how well each camera's time offset is known, anew every
/// few seconds, on a thread of its own that yields to all others. Of images that come faster than
/// boards are found some are passed over, so it knows less than the recording tells afterwards.
class WavePreview {
 public:
  /// `calibration`: in place of the bus's.
  WavePreview(std::optional<Calibration> calibration, const WavedLogOptions& options);
  ~WavePreview();
  WavePreview(const WavePreview&) = delete;
  WavePreview& operator=(const WavePreview&) = delete;

  void TakeRig(const Rig& rig);
  void TakeCalibration(const CalibrationMessage& calibration);
  /// A message of CLOUD or of an image's channel, undecoded. Before the rig is known, and of
  /// cameras that are not the rig's, none is kept.
  void Take(const std::string& channel, const std::uint8_t* data, std::size_t size);

  /// Of each camera; empty: nothing was solved so far.
  std::vector<WavedClock> Clocks() const;
  /// Why nothing can be solved: the calibration is another rig's; empty: it can.
  std::string WhyNot() const;

 private:
  using Batch = std::vector<std::pair<std::string, Bytes>>;  // channel, message
  /// The newest messages of a channel, in their order: those for which there is no room go.
  struct Queue {
    std::size_t most_messages = 0, bytes = 0;
    std::deque<Bytes> messages;
    void Add(Bytes message);
    Bytes Next();
  };

  void Run();
  void Watch();
  bool Stopping() const;
  void TakeAll(const Batch& batch, WaveReader* reader) const;
  std::optional<WaveReader> Begin();
  Batch Wait();
  void Solve(const WavedBoard& board);

  std::optional<Calibration> calibration_;
  const WavedLogOptions options_;
  const int threads_before_;  // of OpenCV
  mutable std::mutex mutex_;  // guards all below but the thread
  std::condition_variable wake_;
  std::optional<Rig> rig_;
  std::map<std::string, CalibrationMessage> cameras_;
  std::map<std::string, Queue> waiting_;
  std::vector<WavedClock> clocks_;
  std::string why_not_;
  bool stopping_ = false;
  std::thread thread_;  // last: it uses all the others
};

}  // namespace rgbdt
