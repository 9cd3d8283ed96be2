#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>

namespace rgbdt {

/// What frames are to be called.
struct ExportFrames {
  std::string lidar;                           ///< empty: as the log's rig calls the LIDAR
  std::map<std::string, std::string> cameras;  ///< by camera; not in it: `<camera>_optical_frame`
};

/// What came of a log.
struct ExportedLog {
  struct Topic {
    std::string schema;  ///< "foxglove.PointCloud"
    std::int64_t messages = 0;
  };
  std::map<std::string, Topic> topics;           ///< by name
  std::map<std::string, std::int64_t> left_out;  ///< channels without a counterpart, and how many
  std::int64_t dropped = 0;                      ///< messages that could not be used
  std::string last_problem;
  std::int64_t unreadable_bytes = 0;  ///< of the log
};

/// An LCM log as an MCAP of Foxglove's messages (Protobuf), which viewers open without a plug-in:
///
/// | topic | of | what |
/// | /lidar/points | CLOUD | PointCloud: whole sweeps |
/// | /fused/points | RGBDT_SWEEP, or else RGBDT_CLOUD | PointCloud: whole fused sweeps |
/// | /CAMERA/image_raw | CAMERA_IMAGE | RawImage, or at .../compressed CompressedImage |
/// | /CAMERA/camera_info | RIG, CALIBRATION | CameraCalibration: the lens, as solved where it is |
/// | /tf_static | RIG, CALIBRATION | FrameTransforms: LIDAR to camera; the guess until it is solved
/// | | /tf, /pose | POSE | FrameTransforms, PoseInFrame: map to LIDAR | | /status, /events,
/// /mount_check | STATUS, SESSION_EVENT, MOUNT_CHECK | Log |
///
/// The times of the file are the sensors': a message is logged at the newest sensor time so far, so
/// the same log gives the same bytes. A calibration that is not to be used gives no transform. The
/// log is read twice. Memory does not grow with it: a sweep at a time. `out` is written whole or
/// not at all. `progress`: how far, 0 to 1. Throws InputError: no such log, nothing in it to
/// export, a disk that fails.
ExportedLog ExportLog(const std::string& log, const std::filesystem::path& out,
                      const ExportFrames& frames = {},
                      const std::function<void(double)>& progress = {});

}  // namespace rgbdt
