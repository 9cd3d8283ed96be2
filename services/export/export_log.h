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
  std::int64_t torn_sweeps = 0;                  ///< of which lines or the end never came
  std::int64_t dropped = 0;                      ///< messages that could not be used
  std::string last_problem;
  std::int64_t unreadable_bytes = 0;  ///< of the log
};

/// An LCM log as an MCAP of Foxglove's messages (Protobuf), which viewers open without a plug-in:
///
/// - /lidar/points, of CLOUD: PointCloud, a message a sweep; lines that never came are NaN;
/// - /fused/points, of RGBDT_SWEEP, or else RGBDT_CLOUD: PointCloud, a message a fused sweep;
/// - /CAMERA/image_raw, of CAMERA_IMAGE: RawImage, or at .../compressed CompressedImage;
/// - /CAMERA/camera_info, of RIG and CALIBRATION: CameraCalibration, the lens, solved or not;
/// - /tf_static, of RIG and CALIBRATION: FrameTransforms, LIDAR to camera; the guess until solved;
/// - /tf and /pose, of POSE: FrameTransforms and PoseInFrame, map to LIDAR;
/// - /status, /events, /mount_check, of STATUS, SESSION_EVENT, MOUNT_CHECK: Log.
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
