#pragma once

#include <string>

namespace rgbdt {

/// What printf makes of these.
[[gnu::format(printf, 1, 2)]] std::string Format(const char* format, ...);

/// A number with so many decimals; "nan" and "inf" where it is none.
std::string Fixed(double value, int decimals);

/// A number in as few digits as it takes to read the same bits back.
std::string Exact(double value);

}  // namespace rgbdt
