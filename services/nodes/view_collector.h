#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/model/rig.h"
#include "calib/model/session.h"
#include "calib/model/view_detection.h"
#include "calib/scan_assembly/sweep_collector.h"

namespace rgbdt {

/// The view that a capture command asks for, put together from the bus: the sweep it names, each
/// camera's first image with utime >= the command's and at most kImageWait after it, up to two of
/// its images from the sweep's start and middle (to see whether the board stood still), and the
/// picks made in those images where the command asks for a person's. Which of these arrives first
/// does not matter. The newest images before the command are kept (kKept a camera) so that one may
/// come early; an image older than those by more than kClockReset means that the clock was set
/// back, and they go. A thermal camera's images from while its shutter corrects are left out.
///
/// Detector, session and viewer have one each and get the same view, since it depends on the
/// messages' times alone (services/README.md, "A view").
class ViewCollector {
 public:
  static constexpr Utime kImageWait = 5 * kMicrosecondsPerSecond;
  static constexpr Utime kClockReset = 10 * kMicrosecondsPerSecond;
  static constexpr std::size_t kKept = 3;
  static constexpr std::size_t kSecondsKept = 60;  ///< of the first image of each second

  /// `seconds_kept`: 0 where nobody asks whether the board stood still.
  explicit ViewCollector(std::size_t seconds_kept = kSecondsKept) : seconds_kept_(seconds_kept) {}

  void Add(CloudChunk chunk) { sweeps_.Add(std::move(chunk)); }
  void Add(const Image& image);
  void Add(const CornerSelection& picks);
  /// A new capture replaces one that never became complete.
  void Begin(const SessionCommand& capture);
  /// The capture at hand, if any, is of no use any more.
  void GiveUp() { capture_.reset(); }
  /// Forgets everything but the newest images.
  void Reset();

  /// The view, once, as soon as it is complete.
  std::optional<View> Take(const Rig& rig);
  /// The image that a camera has in the view of the capture at hand; null: it has not come yet, or
  /// there is no capture.
  const Image* ImageOf(const std::string& camera) const;
  /// A camera's newest image; null: none came yet.
  const Image* Newest(const std::string& camera) const;
  const SweepCollector& sweeps() const { return sweeps_; }
  bool active() const { return capture_.has_value(); }
  const SessionCommand& capture() const { return *capture_; }
  /// What is missing, in words; empty when nothing is.
  std::string Missing(const Rig& rig) const;

 private:
  std::vector<Image> DuringSweep(const Image& at_capture) const;
  void KeepForSweep(const Image& image);
  const CornerSelection* PicksOf(const std::string& camera, Utime image_utime) const;
  bool PersonPicks(const std::string& camera) const;

  std::size_t seconds_kept_;
  std::optional<SessionCommand> capture_;
  SweepCollector sweeps_;
  std::map<std::string, std::deque<Image>> images_;
  std::map<std::string, std::map<Utime, Image>> seconds_;  // by camera and whole second
  std::map<std::string, CornerSelection> picks_;
};

}  // namespace rgbdt
