#pragma once

// Numbers and lists as a person reads them.

#include <optional>
#include <string>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/time.h"

namespace rgbdt {

/// The number with so many digits behind the point; "–" where it is not finite.
std::string Number(double value, int decimals);

/// The same with its unit, which a line break does not part from it; "–" where there is none.
std::string WithUnit(double value, int decimals, const std::string& unit);
std::string WithUnit(const std::optional<double>& value, int decimals, const std::string& unit);

/// Whether a time is one of the calendar: of a clock that was never set it is not.
bool IsDate(Utime utime);

/// "2015-06-01 12:01:53 UTC"; of a clock that was never set its seconds, "12.3 s".
std::string TimeText(Utime utime);

/// "0.012° and 3.4 mm"
std::string PoseErrorText(const PoseError& error);

/// "1 view", "2 views"
std::string Count(std::size_t count, const std::string& what);

/// "a, b, c"
std::string Joined(const std::vector<std::string>& names);

}  // namespace rgbdt
