#pragma once

#include <string>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// When a calibration is used.
enum class Use {
  kIfSound,  ///< where nothing speaks against it
  kAnyway,   ///< in any case, as the user said `--anyway`
};

/// Whose calibration is to be used with which rig, as a person knows them: files or messages.
struct UseNames {
  std::string calibration;  ///< e.g. "out/a/calibration.textproto"
  std::string rig;          ///< e.g. "out/b/rig.textproto"
};

/// In what the rig is not the one that the calibration holds for, a line for each field, the
/// calibration's value first: "camera rgb: pinhole.fx: 600 -> 610". What counts is the LIDAR's
/// scanner and model, and of each calibrated camera its kind, size and lens. Needs
/// `calibration.sensors`.
std::vector<std::string> SensorDifferences(const Calibration& calibration, const Rig& rig);

/// Why the calibration does not belong to the rig, what differs, and what to do, in one line;
/// empty: it belongs to it. It does where the hash is the same, where all that counts is the same
/// (SensorDifferences), and where it was written by hand and names no rig. Where there is only a
/// hash, and another one, it does not.
std::string WhyAnotherRig(const Calibration& calibration, const Rig& rig, const UseNames& names);

/// Why a camera's calibration is not to be used (`do not use`), and what to do, in one line; empty:
/// it may be. `name`: of the file that it stands in; empty: none.
std::string WhyNotToUse(const CameraCalibration& camera, const std::string& name = "");

/// The same of a further LIDAR's pose.
std::string WhyNotToUse(const LidarCalibration& lidar, const std::string& name = "");

/// What is to be known of a calibration that may be used all the same, a line each: which cameras
/// are doubtful, and why; whether the rig calls its LIDAR by another name, which may be another
/// one.
std::vector<std::string> DoubtsOf(const Calibration& calibration, const Rig& rig,
                                  const std::string& name);

/// Whether the poses of LIDARs beside the reference are used, too.
enum class Further { kUnused, kUsed };

/// All of this, of a calibration that is to be used with a rig: throws InputError with the first
/// that speaks against it. With Use::kAnyway nothing is thrown, and all that does is returned.
std::vector<std::string> RequireSound(const Calibration& calibration, const Rig& rig,
                                      const UseNames& names, Use use,
                                      Further further = Further::kUnused);

/// The same of the rig alone: for who judges the calibration itself.
std::vector<std::string> RequireSameRig(const Calibration& calibration, const Rig& rig,
                                        const UseNames& names, Use use);

/// What is to be shown of a report that is refused: none of its cameras has a pose, and why.
[[nodiscard]] Report WithoutPoses(Report report, const std::string& why);

}  // namespace rgbdt
