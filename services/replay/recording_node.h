#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "services/bus/log_writer.h"
#include "services/replay/wave_preview.h"
#include "services/runtime/node.h"
#include "services/runtime/periodic.h"

namespace rgbdt {

/// Keeps what tells of a waved board (RIG, CALIBRATION, CLOUD, images) as a log, for so many
/// seconds from the first sweep on, and tells once a second how much is left and what came:
/// WAVE_PROGRESS. `preview`, if any, gets the same and is asked what it says so far. It
/// gives up where no sweep comes, or no RIG or image with the sweeps, within kPatience, and at once
/// where the rig cannot do it: a turned scanner, a plain board.
///
/// RIG and CALIBRATION are kept as a process takes them (with a key: signed ones), clouds and
/// images byte by byte: whoever runs the node hands all that is on the bus to Overhear.
class RecordingNode : public Node {
 public:
  using Tell = std::function<void(const std::string& line)>;
  static constexpr Utime kPatience = 10 * kMicrosecondsPerSecond;

  /// The log gets its name when it is whole (Close). Throws InputError where it cannot be made.
  RecordingNode(const std::string& log, double seconds, Tell tell, WavePreview* preview = nullptr);

  std::string name() const override { return "sync"; }
  std::vector<std::string> Subscriptions() const override { return {"RIG", "CALIBRATION"}; }
  Messages Handle(const Message& message) override;
  Messages Advance(Utime now) override;
  Status GetStatus() const override;
  bool finished() const override { return over_ || !problem_.empty(); }

  /// Keeps it, if it is a cloud or an image. `host_utime`: the wall clock [us].
  void Overhear(const std::string& channel, const std::uint8_t* data, std::size_t size,
                Utime host_utime);

  /// What it tells the bus.
  WaveProgress Told() const;

  /// All is in the log. Throws InputError where it is not: the disk is full, or there was no sweep.
  void Close();

 private:
  void Keep(const std::string& channel, const std::uint8_t* data, std::size_t size,
            Utime host_utime);
  std::string WhatIsMissing() const;
  std::string Heard() const;
  double Left() const;
  std::string Progress() const;

  LogWriter log_;
  Utime length_;
  Tell tell_;
  WavePreview* preview_;
  Periodic second_{kMicrosecondsPerSecond};
  std::optional<Utime> started_, began_;  // the node's clock; began_: the first sweep
  Utime now_ = 0;
  std::map<std::string, int> counts_;  // by channel
  int images_ = 0;
  Utime host_utime_ = 0;    // of the newest message
  Utime newest_utime_ = 0;  // of clouds and images
  bool over_ = false;
  std::string problem_;
};

}  // namespace rgbdt
