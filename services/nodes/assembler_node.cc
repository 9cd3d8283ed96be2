#include "services/nodes/assembler_node.h"

#include "calib/files/rig_file.h"
#include "calib/model/errors.h"

namespace rgbdt {

Messages AssemblerNode::Handle(const Message& message) {
  if (const auto* rig = std::get_if<RigText>(&message)) {
    OnRig(*rig);
    return {};
  }
  if (!rig_) throw InputError("no rig heard yet; start rgbdt-session, or publish RIG");
  if (const auto* reading = std::get_if<EncoderReading>(&message)) {
    if (!track_.Add(*reading)) {
      throw InputError("encoder reading of " + std::to_string(reading->utime) +
                       " us is not after the one before it (" + std::to_string(track_.newest()) +
                       " us)");
    }
  } else if (const auto* line = std::get_if<LineScan>(&message)) {
    OnLine(*line);
  }
  return Drain();
}

void AssemblerNode::OnRig(const RigText& text) {
  if (rig_ && rig_->hash == text.hash) return;
  Rig rig = ParseRig(text.text, "RIG message");
  if (!rig.lidar.turned_scanner) {
    throw InputError("the rig's lidar has no turned_scanner: nothing to assemble");
  }
  rig_ = std::move(rig);
}

void AssemblerNode::OnLine(const LineScan& line) {
  if (waiting_.count(line.utime) != 0) {
    throw InputError("line of " + std::to_string(line.utime) + " us came twice");
  }
  if (waiting_.size() >= kMaxWaiting) {
    waiting_.erase(waiting_.begin());
    ++lines_lost_;
  }
  waiting_.emplace(line.utime, line);
}

Messages AssemblerNode::Drain() {
  Messages out;
  const auto last_beam = [](const LineScan& line) {
    return line.utime + FromSeconds(static_cast<double>(line.range.size()) * line.beam_period_s);
  };
  while (!waiting_.empty() && last_beam(waiting_.begin()->second) <= track_.newest()) {
    const LineScan line = std::move(waiting_.begin()->second);
    waiting_.erase(waiting_.begin());
    Add(line, &out);
  }
  if (sweep_ && track_.SweepAt(track_.newest() - kGrace) != sweep_->utime) EndSweep(&out);
  track_.ForgetBefore(track_.newest() - 10 * kGrace);
  return out;
}

void AssemblerNode::Add(const LineScan& line, Messages* out) {
  const Utime sweep_utime = track_.SweepAt(line.utime);
  if (sweep_utime == 0) return;
  if (sweep_utime <= ended_) {
    ++lines_lost_;
    throw InputError("line of " + std::to_string(line.utime) +
                     " us came after its sweep had ended");
  }
  if (sweep_ && sweep_->utime != sweep_utime) EndSweep(out);
  if (!sweep_) sweep_ = Sweep{sweep_utime, line.seq, {}};
  const std::int64_t place = line.seq - sweep_->first_seq;
  if (place < 0 || place > kMaxLines || !sweep_->lines.insert(static_cast<int>(place)).second) {
    ++lines_lost_;
    throw InputError("line number " + std::to_string(line.seq) +
                     " does not fit the sweep that began with number " +
                     std::to_string(sweep_->first_seq));
  }
  std::vector<double> angles;
  angles.reserve(line.range.size());
  for (std::size_t i = 0; i < line.range.size(); ++i) {
    const Utime beam = line.utime + FromSeconds(static_cast<double>(i) * line.beam_period_s);
    const auto angle = track_.AngleAt(*rig_->lidar.turned_scanner, beam, kMaxGap);
    if (!angle) {
      sweep_->lines.erase(static_cast<int>(place));
      ++lines_lost_;
      return;
    }
    angles.push_back(*angle);
  }
  CloudChunk chunk;
  chunk.cloud = LineToCloud(*rig_->lidar.turned_scanner, line, angles);
  chunk.cloud.sweep_utime = sweep_utime;
  chunk.cloud.first_line = static_cast<int>(place);
  out->push_back(std::move(chunk));
  ++lines_used_;
}

void AssemblerNode::EndSweep(Messages* out) {
  CloudChunk end;
  end.cloud.sweep_utime = sweep_->utime;
  end.sweep_lines = sweep_->lines.empty() ? 0 : *sweep_->lines.rbegin() + 1;
  end.cloud.first_line = end.sweep_lines;
  end.sweep_end = true;
  end.lines_lost = end.sweep_lines - static_cast<int>(sweep_->lines.size());
  out->push_back(std::move(end));
  ended_ = sweep_->utime;
  sweep_.reset();
  ++sweeps_;
}

Status AssemblerNode::GetStatus() const {
  Status status;
  status.ready = rig_.has_value();
  status.text = !rig_    ? "waits for the rig (RIG)"
                : sweep_ ? "assembling a sweep, " + std::to_string(sweep_->lines.size()) + " lines"
                         : "waits for a sweep";
  status.counters = {{"lines", lines_used_}, {"lines lost", lines_lost_}, {"sweeps", sweeps_}};
  return status;
}

}  // namespace rgbdt
