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
#include "services/messages/message.h"

namespace rgbdt {

/// The view that a capture command asks for, put together from the bus: the sweep it names, each
/// camera's first image with utime >= the command's and at most kImageWait after it, up to two of
/// its images from the sweep's start and middle (to see whether the board stood still), and the
/// picks made in those images where the command asks for a person's. Which of these arrives first
/// does not matter. The newest images before the command are kept (kKept a camera) so that one may
/// come early; an image older than those by more than kClockReset means that the clock was set
/// back, and they go. A thermal camera's images from while its shutter corrects are left out.
///
/// Of the images from during a sweep the first of each second is kept, as far as a view may still
/// need them: of the newest kSweepsKept sweeps that have begun, and of the newest kTail seconds. Of
/// a sweep that is too long for kMostBytes every second, fourth, ... of them stays.
///
/// Detector, session and viewer have one each and get the same view, since it depends on the
/// messages' times alone (services/README.md, "A view").
class ViewCollector {
 public:
  static constexpr Utime kImageWait = 5 * kMicrosecondsPerSecond;
  static constexpr Utime kClockReset = 10 * kMicrosecondsPerSecond;
  static constexpr std::size_t kKept = 3;
  static constexpr std::size_t kSweepsKept = 2;
  static constexpr Utime kTail = 10;                                 ///< [s]
  static constexpr std::size_t kLeastOfSweep = 4, kMostOfSweep = 8;  ///< images
  static constexpr std::size_t kMostBytes = 24'000'000;              ///< a sweep and camera

  enum class During { kKeep, kForget };
  /// kForget: nobody asks whether the board stood still.
  explicit ViewCollector(During during = During::kKeep) : during_(during) {}

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
  /// All messages that a view of this collector's was put together from, to be said again
  /// (kSaidAgain): its images and picks, then its sweep, whose end completes the view for whoever
  /// has been asked for it. Images too large for a message raw go as PNG. Empty where the sweep is
  /// no longer kept.
  Messages Again(const View& view) const;
  /// The image that a camera has in the view of the capture at hand; null: it has not come yet, or
  /// there is no capture.
  const Image* ImageOf(const std::string& camera) const;
  /// A camera's newest image; null: none came yet.
  const Image* Newest(const std::string& camera) const;
  const SweepCollector& sweeps() const { return sweeps_; }
  /// Of all images that are kept.
  std::size_t ImageBytes() const;
  bool active() const { return capture_.has_value(); }
  const SessionCommand& capture() const { return *capture_; }
  /// What is missing, in words; empty when nothing is.
  std::string Missing(const Rig& rig) const;

 private:
  std::vector<Image> DuringSweep(const Image& at_capture) const;
  void KeepForSweep(const Image& image);
  void ForgetSeconds(std::map<Utime, Image>* seconds) const;
  const CornerSelection* PicksOf(const std::string& camera, Utime image_utime) const;
  bool PersonPicks(const std::string& camera) const;

  During during_;
  std::optional<SessionCommand> capture_;
  SweepCollector sweeps_;
  std::map<std::string, std::deque<Image>> images_;
  std::map<std::string, std::map<Utime, Image>> seconds_;  // by camera and whole second
  std::map<std::string, CornerSelection> picks_;
};

}  // namespace rgbdt
