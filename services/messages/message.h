#pragma once

#include <string>
#include <variant>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/cloud.h"
#include "calib/model/image.h"
#include "calib/model/mount_check.h"
#include "calib/model/rgbdt_cloud.h"
#include "calib/model/session.h"
#include "calib/model/view_detection.h"
#include "calib/model/wave_progress.h"

namespace rgbdt {

/// One camera's calibration as it travels.
struct CalibrationMessage {
  std::int64_t seq = 0;
  Utime utime = 0;
  std::string rig_hash;
  std::string method;
  CameraCalibration calibration;
};

/// Everything that crosses the bus, decoded and checked.
using Message =
    std::variant<LineScan, EncoderReading, Image, CloudChunk, CornerSelection, ViewDetection,
                 CalibrationMessage, RgbdtCloud, StampedPose, RigText, SessionCommand, SessionEvent,
                 SessionRequest, LeftOutViews, TargetStatus, MountCheck, WaveProgress, Status,
                 ReportText, SweepOdometry>;
using Messages = std::vector<Message>;

/// The channel a message travels on, e.g. "CLOUD", "RGB_IMAGE".
std::string ChannelOf(const Message& message);

/// The message's own number, as its sender counted it on its channel.
std::int64_t SeqOf(const Message& message);
void SetSeq(std::int64_t seq, Message* message);

/// The message's own time; 0 where it has none.
Utime UtimeOf(const Message& message);

}  // namespace rgbdt
