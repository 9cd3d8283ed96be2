#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>

#include "calib/model/method.h"
#include "calib/model/rig.h"
#include "services/nodes/view_collector.h"
#include "services/runtime/node.h"

namespace rgbdt {

/// CLOUD + `<CAMERA>_IMAGE` + CORNER_SELECTION + SESSION_COMMAND capture -> DETECTION, one a view,
/// then SESSION_EVENT done; or failed, where the view's parts cannot be made into one. A view whose
/// sweep is not whole (SweepCollector::WhyTorn) is not looked at: failed, with the sweep's utime,
/// and done after all, once the session has said again what it lacks. A view that never becomes
/// complete is dropped when the next capture or a reset comes; the status says what it waits for.
/// Where the session lacks what one of the newest kKeptViews views was detected in (say_view), all
/// of it is said again, and the detection. Another rig forgets everything. Corners that a person
/// picks in an image of one of the newest kKeptViews views have that view detected once more, with
/// them: its DETECTION comes again, and the event of its capture. In spare time, so not in a
/// replay, it looks whether a sensor sees the board now, and says so (TARGET_STATUS): one sensor at
/// a time, the next in turn that has something new; ten times a second, or as often as takes a
/// quarter of a core, once a second at least; less often where messages wait
/// (NodeRunner::UseSpareTime).
class DetectorNode : public Node {
 public:
  static constexpr std::size_t kKeptViews = 6;
  static constexpr Utime kSayEvery = kMicrosecondsPerSecond;  ///< a view again, whoever asks

  /// Throws InputError for an unknown method.
  explicit DetectorNode(std::string method = kAutoMethod);
  std::string name() const override { return "detector"; }
  std::vector<std::string> Subscriptions() const override {
    return {"RIG", "CLOUD", ".*_IMAGE", "CORNER_SELECTION", "SESSION_COMMAND"};
  }
  Messages Handle(const Message& message) override;
  Messages Advance(Utime now) override;
  Messages UseSpareTime(Utime now) override;
  Status GetStatus() const override;

 private:
  Messages LookAtNext();
  void OnRig(const RigText& text);
  void OnCommand(const SessionCommand& command);
  Messages OnPicks(const CornerSelection& picks);
  Messages SayAgain(const SessionCommand& asked);
  std::string Missing() const;
  Messages DetectIfComplete();
  Messages DetectOrFail(const View& view, SessionEvent event);
  Messages Detect(const View& view, SessionEvent event);

  std::string method_;
  // When the newest look began; the next Advance says how long it took.
  std::optional<Utime> looked_at_;
  Utime look_from_ = 0;
  std::optional<Rig> rig_;
  ViewCollector view_;
  std::int64_t views_ = 0;
  std::int64_t images_without_board_ = 0;
  std::int64_t clouds_without_board_ = 0;
  std::int64_t torn_sweeps_ = 0;
  std::int64_t torn_told_ = -1;  // the newest capture that failed for it

  struct Kept {
    View view;
    SessionEvent event;  // as its capture is answered, without text
  };
  std::deque<Kept> kept_;
  std::size_t next_look_ = 0;            // whose turn: a camera of the rig, or after them the LIDAR
  std::map<std::string, Utime> looked_;  // newest looked at, by camera; "": the LIDAR
  Utime now_ = 0;                        // Advance's newest
  std::optional<Utime> said_again_;      // when a view was
};

}  // namespace rgbdt
