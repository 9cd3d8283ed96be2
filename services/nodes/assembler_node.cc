#include "services/nodes/assembler_node.h"

#include <utility>

#include "calib/files/schema/rig_file.h"
#include "calib/model/errors.h"

namespace rgbdt {
namespace {

Messages ToMessages(std::vector<CloudChunk> chunks) {
  Messages messages;
  messages.reserve(chunks.size());
  for (CloudChunk& chunk : chunks) messages.emplace_back(std::move(chunk));
  return messages;
}

}  // namespace

Messages AssemblerNode::Handle(const Message& message) {
  if (const auto* rig = std::get_if<RigText>(&message)) {
    OnRig(*rig);
    return {};
  }
  if (rig_hash_.empty()) {
    throw InputError("no rig heard yet; start rgbdt-session, or publish RIG");
  }
  if (!assembler_) return {};
  if (const auto* reading = std::get_if<EncoderReading>(&message)) {
    return ToMessages(assembler_->Add(*reading));
  }
  if (const auto* line = std::get_if<LineScan>(&message)) return ToMessages(assembler_->Add(*line));
  return {};
}

void AssemblerNode::OnRig(const RigText& text) {
  if (!rig_hash_.empty() && rig_hash_ == text.hash) return;
  const Rig rig = ParseRig(text.text, "RIG message");
  if (!rig.lidar.turned_scanner) {
    assembler_.reset();
  } else if (assembler_) {
    assembler_->SetScanner(*rig.lidar.turned_scanner);
  } else {
    assembler_.emplace(*rig.lidar.turned_scanner);
  }
  rig_hash_ = rig.hash;
}

Status AssemblerNode::GetStatus() const {
  const auto counts = assembler_ ? assembler_->counts() : Assembler::Counts{};
  const auto lines = assembler_ ? assembler_->LinesOfSweep() : std::nullopt;
  Status status;
  status.ready = !rig_hash_.empty();
  status.text = rig_hash_.empty() ? "waits for the rig (RIG)"
                : !assembler_     ? "nothing to assemble: the LIDAR gives whole sweeps"
                : lines           ? "assembling a sweep, " + std::to_string(*lines) + " lines"
                                  : "waits for a sweep";
  status.counters = {
      {"lines", counts.lines_used}, {"lines lost", counts.lines_lost}, {"sweeps", counts.sweeps}};
  return status;
}

}  // namespace rgbdt
