#include "calib/present/report/words.h"

#include <cmath>
#include <ctime>

#include "calib/model/text.h"

namespace rgbdt {

std::string Number(double value, int decimals) {
  return std::isfinite(value) ? Fixed(value, decimals) : "–";
}

std::string WithUnit(double value, int decimals, const std::string& unit) {
  std::string text = Number(value, decimals);
  if (!std::isfinite(value)) return text;
  if (text.front() == '-') text.replace(0, 1, "−");
  const bool joined = unit == "°";
  return text + (joined ? "" : "\u202f") + unit;  // a narrow space without a line break
}

std::string WithUnit(const std::optional<double>& value, int decimals, const std::string& unit) {
  return value ? WithUnit(*value, decimals, unit) : "–";
}

bool IsDate(Utime utime) {
  constexpr Utime kFirstDate = 946'684'800 * kMicrosecondsPerSecond;  // 2000-01-01
  return utime >= kFirstDate;
}

std::string TimeText(Utime utime) {
  if (!IsDate(utime)) return Number(ToSeconds(utime), 1) + " s";
  const std::time_t seconds = static_cast<std::time_t>(utime / kMicrosecondsPerSecond);
  std::tm utc{};
  char text[64] = "";
  if (gmtime_r(&seconds, &utc) != nullptr) {
    std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S UTC", &utc);
  }
  return text;
}

std::string PoseErrorText(const PoseError& error) {
  return Number(error.rotation_deg, 3) + "° and " + Number(error.translation_mm, 1) + " mm";
}

std::string Count(std::size_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

std::string Joined(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ", ") + name;
  return out;
}

}  // namespace rgbdt
