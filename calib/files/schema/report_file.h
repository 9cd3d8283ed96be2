#pragma once

#include <filesystem>
#include <string>

#include "calib/model/calibration.h"

namespace rgbdt {

/// report.json: Protobuf's JSON of the message Report (calib/files/schema/report.proto), its own
/// field names, cameras by name in alphabetical order. What is unknown is absent. The same report
/// gives the same bytes.
std::string ReportToJson(const Report& report);

/// The reverse; `where` stands for the file in error messages. Throws InputError.
Report ReportFromJson(const std::string& json, const std::string& where = "report");

/// ReportToJson into a file, atomically; and from it.
void WriteReport(const std::filesystem::path& path, const Report& report);
Report ReadReport(const std::filesystem::path& path);

}  // namespace rgbdt
