#pragma once

#include <filesystem>
#include <string>

#include "calib/model/calibration.h"

namespace rgbdt {

/// Reads a calibration.textproto (schema: calib/files/schema/report.proto), or that of a directory.
/// Throws InputError with file, line and key.
Calibration ReadCalibration(const std::filesystem::path& given);

/// The calibration as text; the same calibration gives the same bytes. A comment on top says which
/// way the transforms go.
std::string PrintCalibration(const Calibration& calibration);

/// PrintCalibration into a file, atomically.
void WriteCalibration(const std::filesystem::path& path, const Calibration& calibration);

}  // namespace rgbdt
