#include "services/replay/recording_node.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "calib/files/schema/rig_file.h"
#include "calib/model/errors.h"
#include "calib/model/printable.h"
#include "calib/model/text.h"
#include "services/messages/codec.h"
#include "services/messages/header.h"
#include "services/messages/image_channel.h"
#include "services/messages/limits.h"
#include "services/replay/wave_reader.h"

namespace rgbdt {
namespace {

constexpr std::size_t kMostChannels = 40;
constexpr const char* kClouds = "CLOUD";
constexpr const char* kRig = "RIG";

// "rgb 0.41 ms, thermal not yet"
std::string SigmasOf(const std::vector<WavedClock>& clocks) {
  std::string text;
  for (const WavedClock& clock : clocks) {
    text += (text.empty() ? "" : ", ") + clock.camera +
            (clock.time_offset_s ? Format(" %.2f ms", 1e3 * clock.time_offset_s->sigma)
                                 : std::string(" not yet"));
  }
  return text;
}

}  // namespace

RecordingNode::RecordingNode(const std::string& log, double seconds, Tell tell,
                             WavePreview* preview)
    : log_(log), length_(FromSeconds(seconds)), tell_(std::move(tell)), preview_(preview) {}

Messages RecordingNode::Handle(const Message& message) {
  const Bytes bytes = Encode(message);
  if (const auto* rig = std::get_if<RigText>(&message)) {
    const Rig parsed = ParseRig(rig->text, kRig);
    if (const std::string why = WhyNotWaved(parsed); !why.empty()) problem_ = why;
    if (preview_ != nullptr) preview_->TakeRig(parsed);
  }
  if (const auto* known = std::get_if<CalibrationMessage>(&message);
      known != nullptr && preview_ != nullptr) {
    preview_->TakeCalibration(*known);
  }
  Keep(ChannelOf(message), bytes.data(), bytes.size(), host_utime_);
  return {};
}

Messages RecordingNode::Advance(Utime now) {
  now_ = now;
  if (!started_) started_ = now;
  if (!began_ && counts_.count(kClouds) > 0) began_ = now;
  if (now - *started_ > kPatience && problem_.empty()) problem_ = WhatIsMissing();
  if (preview_ != nullptr && problem_.empty()) problem_ = preview_->WhyNot();
  if (!problem_.empty()) return {Told()};
  over_ = began_ && now - *began_ >= length_;
  if (over_ || !second_.IsDue(now)) return {};
  tell_(Progress());
  return {Told()};
}

Status RecordingNode::GetStatus() const {
  Status status;
  status.ready = began_.has_value();
  status.text = Progress();
  return status;
}

void RecordingNode::Overhear(const std::string& channel, const std::uint8_t* data, std::size_t size,
                             Utime host_utime) {
  host_utime_ = host_utime;
  const bool image = IsImageChannel(channel);
  if (channel != kClouds && !image) return;
  images_ += image ? 1 : 0;
  const Utime utime = HeaderOf(data, size).value_or(Header()).utime;
  if (utime <= kMaxInteger) newest_utime_ = std::max(newest_utime_, utime);  // not checked yet
  Keep(channel, data, size, host_utime);
  if (preview_ != nullptr) preview_->Take(channel, data, size);
}

void RecordingNode::Keep(const std::string& channel, const std::uint8_t* data, std::size_t size,
                         Utime host_utime) {
  if (finished()) return;
  if (counts_.size() >= kMostChannels && counts_.count(channel) == 0) return;  // strangers' names
  try {
    log_.Write(channel, data, size, host_utime);
    ++counts_[channel];
  } catch (const InputError& error) {
    problem_ = error.what();
  }
}

std::string RecordingNode::WhatIsMissing() const {
  const std::string wait = Format(" on the bus in %.0f s", ToSeconds(kPatience));
  if (counts_.count(kClouds) == 0) {
    return "no sweep" + wait + ": are the LIDAR and its process up (CLOUD)?";
  }
  if (counts_.count(kRig) == 0) {
    return "no RIG" + wait + ": rgbdt-session or rgbdt-monitor sends it, or rgbdt up";
  }
  return images_ == 0 ? "no image" + wait + ": are the cameras and their processes up?" : "";
}

void RecordingNode::Close() {
  if (problem_.empty() && !over_ && counts_.count(kRig) == 0) problem_ = "stopped before it began";
  if (!problem_.empty()) {
    log_.Discard();
    throw InputError(problem_);
  }
  log_.Close();
}

WaveProgress RecordingNode::Told() const {
  WaveProgress told;
  told.utime = newest_utime_;
  if (preview_ != nullptr) told.clocks = preview_->Clocks();
  if (!problem_.empty()) {
    told.phase = WavePhase::kFailed;
    told.text = PrintableText(problem_);
  } else if (!began_) {
    told.text = "waiting for a sweep ...; " + Heard();
  } else {
    told.phase = WavePhase::kRecording;
    told.left_s = Left();
    told.text = "wave the board towards the sensors and away, and tilt it; " + Heard();
  }
  return told;
}

double RecordingNode::Left() const {
  return std::max(0.0, std::ceil(ToSeconds(*began_ + length_ - now_)));
}

std::string RecordingNode::Progress() const {
  if (!began_) return "waiting for a sweep ...; " + Heard();
  if (finished()) return "recorded: " + Heard();
  const std::string known = preview_ == nullptr ? "" : SigmasOf(preview_->Clocks());
  return Format("wave the board: %.0f s left; ", Left()) +
         (known.empty() ? "" : "time offsets to (1 sigma) " + known + "; ") + Heard();
}

std::string RecordingNode::Heard() const {
  std::string heard;
  for (const auto& [channel, count] : counts_) {
    heard += (heard.empty() ? "" : ", ") + std::to_string(count) + " " + PrintableText(channel);
  }
  return heard.empty() ? "nothing heard" : heard;
}

}  // namespace rgbdt
