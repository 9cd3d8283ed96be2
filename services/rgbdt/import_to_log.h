#pragma once

#include <optional>
#include <string>

#include "services/import/import_log.h"

namespace rgbdt {

/// The rig of a session, with its calibration where it has been calibrated, and what is doubtful
/// about that told; nothing where `session` is empty: the log is of clouds. Throws InputError where
/// the files cannot be read, or do not belong together.
std::optional<LogRig> LogRigOf(const std::string& session);

/// `rgbdt import --log`: writes the log to `path`, says what is in it and what to do with it. Gives
/// the exit code.
int ImportLog(const std::string& path, const std::optional<LogRig>& rig, const TopicChoice& choice,
              const CloudReader& read_cloud, BagReader* bag);

}  // namespace rgbdt
