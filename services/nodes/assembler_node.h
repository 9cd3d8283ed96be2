#pragma once

#include <map>
#include <optional>
#include <set>

#include "calib/model/rig.h"
#include "calib/scan_assembly/assembler.h"
#include "services/nodes/node.h"

namespace rgbdt {

/// LINE_SCAN + ENCODER -> CLOUD. A chunk (one line) leaves as soon as the encoder has been read at
/// or after the line's last beam. A line's place in the sweep is its number minus that of the
/// sweep's first line, so lines and readings may arrive a little out of order, on one channel or
/// between the two. The sweep ends with the first reading kGrace after the encoder stopped naming
/// it, or with a line of another sweep: then an empty chunk with `sweep_end`. Lines whose numbers
/// never came and lines whose angles are not known (readings missing for more than kMaxGap) are
/// counted in `lines_lost`. Refused: a line seen before, and one whose sweep has ended. Between
/// sweeps (sweep_utime 0) lines make no cloud.
class AssemblerNode : public Node {
 public:
  static constexpr std::size_t kMaxWaiting = 1000;               ///< lines
  static constexpr std::int64_t kMaxLines = 100000;              ///< of a sweep
  static constexpr Utime kMaxGap = kMicrosecondsPerSecond / 10;  ///< between encoder readings
  static constexpr Utime kGrace = kMicrosecondsPerSecond / 10;   ///< for late lines

  std::string name() const override { return "assembler"; }
  std::vector<std::string> Subscriptions() const override {
    return {"RIG", "LINE_SCAN", "ENCODER"};
  }
  Messages Handle(const Message& message) override;
  Status GetStatus() const override;

 private:
  struct Sweep {
    Utime utime = 0;
    std::int64_t first_seq = 0;
    std::set<int> lines;  // sent, by their place in the sweep
  };

  void OnRig(const RigText& rig);
  void OnLine(const LineScan& line);
  Messages Drain();
  void Add(const LineScan& line, Messages* out);
  void EndSweep(Messages* out);

  std::optional<Rig> rig_;
  EncoderTrack track_;
  std::map<Utime, LineScan> waiting_;
  std::optional<Sweep> sweep_;
  Utime ended_ = 0;  // the newest sweep that has ended
  std::int64_t lines_used_ = 0;
  std::int64_t lines_lost_ = 0;
  std::int64_t sweeps_ = 0;
};

}  // namespace rgbdt
