#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "services/runtime/node.h"
#include "services/runtime/periodic.h"

namespace rgbdt {

/// Tells the bus how far the solving of a recording is (WAVE_PROGRESS, once a second), and three
/// times what came of it; then it is finished. Tell and End may be called on any thread.
class TellingNode : public Node {
 public:
  /// `recorded`: what was told last of the recording.
  explicit TellingNode(const WaveProgress& recorded);

  void Tell(const std::string& text);
  /// `phase`: kDone or kFailed.
  void End(WavePhase phase, const std::string& text, const std::vector<WavedClock>& clocks);

  std::string name() const override { return "sync"; }
  std::vector<std::string> Subscriptions() const override { return {}; }
  Messages Handle(const Message& /*message*/) override { return {}; }
  Messages Advance(Utime now) override;
  Status GetStatus() const override;
  bool finished() const override { return farewells_ == 0; }

 private:
  static constexpr int kFarewells = 3;  // since one may be lost
  static constexpr Utime kBetweenFarewells = kMicrosecondsPerSecond / 5;

  mutable std::mutex mutex_;
  WaveProgress progress_;  // guarded by mutex_
  Periodic second_{kMicrosecondsPerSecond}, farewell_{kBetweenFarewells};
  int farewells_ = kFarewells;  // left
};

}  // namespace rgbdt
