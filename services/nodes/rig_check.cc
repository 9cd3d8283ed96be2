#include "services/nodes/rig_check.h"

namespace rgbdt {

std::vector<std::string> RequireRigOf(const CalibrationMessage& message, const Rig& rig,
                                      const Rig* before, Use use) {
  const std::string hash = message.rig_hash.empty() ? "none" : message.rig_hash;
  Calibration calibration{message.method, hash, message.utime, {message.calibration}, {}};
  if (before != nullptr && before->hash == hash) calibration.sensors = SensorsOf(*before);
  return RequireSameRig(calibration, rig,
                        {"the calibration of camera " + message.calibration.camera,
                         "the one that is heard on the bus (RIG)"},
                        use);
}

}  // namespace rgbdt
