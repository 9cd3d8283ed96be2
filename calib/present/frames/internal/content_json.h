#pragma once

#include <nlohmann/json.hpp>

#include "calib/present/report/report_content.h"

namespace rgbdt {

/// As viewer/page/src/protocol.ts has them.
nlohmann::json VerdictJson(const Verdict& verdict);
nlohmann::json PosesJson(const std::vector<NamedPose>& poses);
nlohmann::json TableJson(const Table& table);
nlohmann::json ContentJson(const ReportContent& content);

}  // namespace rgbdt
