#include "services/messages/message.h"

#include <algorithm>

#include "services/messages/image_channel.h"

namespace rgbdt {
namespace {

struct Channel {
  std::string operator()(const LineScan&) const { return "LINE_SCAN"; }
  std::string operator()(const EncoderReading&) const { return "ENCODER"; }
  std::string operator()(const Image& image) const { return ImageChannel(image.camera); }
  std::string operator()(const CloudChunk&) const { return "CLOUD"; }
  std::string operator()(const CornerSelection&) const { return "CORNER_SELECTION"; }
  std::string operator()(const ViewDetection&) const { return "DETECTION"; }
  std::string operator()(const CalibrationMessage&) const { return "CALIBRATION"; }
  std::string operator()(const RgbdtCloud& cloud) const {
    return cloud.whole_sweep ? "RGBDT_SWEEP" : "RGBDT_CLOUD";
  }
  std::string operator()(const StampedPose&) const { return "POSE"; }
  std::string operator()(const RigText&) const { return "RIG"; }
  std::string operator()(const SessionCommand&) const { return "SESSION_COMMAND"; }
  std::string operator()(const SessionEvent&) const { return "SESSION_EVENT"; }
  std::string operator()(const SessionRequest&) const { return "SESSION_REQUEST"; }
  std::string operator()(const LeftOutViews&) const { return "LEFT_OUT_VIEWS"; }
  std::string operator()(const TargetStatus&) const { return "TARGET_STATUS"; }
  std::string operator()(const MountCheck&) const { return "MOUNT_CHECK"; }
  std::string operator()(const WaveProgress&) const { return "WAVE_PROGRESS"; }
  std::string operator()(const Status&) const { return "STATUS"; }
  std::string operator()(const ReportText&) const { return "REPORT"; }
  std::string operator()(const SweepOdometry&) const { return "ODOMETRY"; }
};

struct Time {
  Utime operator()(const CloudChunk& chunk) const {
    return chunk.cloud.utime.empty() ? chunk.cloud.sweep_utime : chunk.cloud.utime.front();
  }
  Utime operator()(const RgbdtCloud& cloud) const {
    return cloud.utime.empty() ? cloud.sweep_utime : cloud.utime.front();
  }
  Utime operator()(const ViewDetection& detection) const {
    Utime newest = 0;
    for (const ImageDetection& image : detection.images) newest = std::max(newest, image.utime);
    return newest != 0 ? newest : detection.sweep_utime;
  }
  Utime operator()(const RigText&) const { return 0; }
  template <typename T>
  Utime operator()(const T& message) const {
    return message.utime;
  }
};

}  // namespace

std::string ChannelOf(const Message& message) { return std::visit(Channel(), message); }

std::int64_t SeqOf(const Message& message) {
  return std::visit([](const auto& m) { return m.seq; }, message);
}

void SetSeq(std::int64_t seq, Message* message) {
  std::visit([seq](auto& m) { m.seq = seq; }, *message);
}

Utime UtimeOf(const Message& message) { return std::visit(Time(), message); }

}  // namespace rgbdt
