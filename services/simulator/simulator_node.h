#pragma once

#include <functional>
#include <map>
#include <string>

#include "calib/simulate/simulator.h"
#include "services/runtime/node.h"
#include "services/runtime/pacer.h"

namespace rgbdt {

/// SESSION_COMMAND -> LINE_SCAN, ENCODER, `<CAMERA>_IMAGE`, CORNER_SELECTION, SESSION_EVENT: the
/// synthetic rig on the bus. Its time is simulated, `speed` times as fast as Advance's, and stands
/// still until a command comes; what takes long to render holds it up. Cameras take an image at
/// each full second of simulated time and at each capture; each message leaves when the real sensor
/// would have sent it (a line after its last beam, an image after read-out). One that is started
/// anew in the midst of a session goes on: its time is not before the session's, and the board
/// stands where the view "0003" had it, by its number.
class SimulatorNode : public Node {
 public:
  static constexpr Utime kEpoch = 1'433'160'000'000'000;  ///< 2015-06-01, a sunny day
  static constexpr Utime kEncoderPeriod = 10'000;         ///< 100 Hz

  /// Who keeps the truth; called when the board has been put elsewhere.
  using OnTruth = std::function<void(const Truth& truth)>;

  explicit SimulatorNode(const simulate::Options& options, double speed = 1, OnTruth on_truth = {});

  std::string name() const override { return "simulator"; }
  std::vector<std::string> Subscriptions() const override { return {"SESSION_COMMAND"}; }
  Messages Handle(const Message& message) override;
  /// May render for seconds.
  Messages Advance(Utime now) override;
  Utime LongestWait() const override { return 2000; }
  Status GetStatus() const override;

  const simulate::Simulator& simulator() const { return simulator_; }
  /// The simulated time.
  Utime simulated_now() const { return now_; }
  bool time_stands_still() const { return agenda_.empty(); }

 private:
  struct Task {
    enum class Kind { kShow, kEncoder, kLine, kImages, kPicks, kEvent };
    Kind kind = Kind::kEvent;
    Utime utime = 0;  // of the data
    int line = 0;
    Utime sweep_utime = 0;
    std::string text;  // kShow: the view; kEvent: for a person; kPicks: the camera
    std::int64_t command = 0;
    EventKind event = EventKind::kDone;
    double fraction = 0;
  };

  Messages Do(const Task& task);
  void ShowView(const std::string& view);
  void At(Utime due, Task task) { agenda_.emplace(due, std::move(task)); }
  void PlanPose(const SessionCommand& command);
  void PlanSweep(const SessionCommand& command);
  void PlanCapture(const SessionCommand& command);
  Utime BeginOf(const SessionCommand& command) const;
  void PlanShow(Utime begin, const std::string& view);
  void PlanImages(Utime from, Utime to);
  void PlanEvent(Utime due, std::int64_t command, EventKind kind, const std::string& text,
                 Utime sweep_utime, double fraction);
  Utime Delay() const;

  simulate::Simulator simulator_;
  OnTruth on_truth_;
  Pacer pacer_;
  std::multimap<Utime, Task> agenda_;  // by the time they are due
  Utime now_ = kEpoch;
  Utime newest_planned_ = kEpoch;
  int views_ = 0;
};

}  // namespace rgbdt
