#pragma once

#include <string>

namespace rgbdt {

/// What printf makes of these.
[[gnu::format(printf, 1, 2)]] std::string Format(const char* format, ...);

/// A number with so many decimals; "nan" and "inf" where it is none.
std::string Fixed(double value, int decimals);

/// A number in as few digits as it takes to read the same bits back.
std::string Exact(double value);

/// ASCII letters only.
std::string ToLower(std::string text);

/// "view2" before "view10": digits compare as numbers.
bool NaturalLess(const std::string& a, const std::string& b);

/// A path as a shell takes it for one word, in quotes where it must be: for a command that a person
/// is to copy.
std::string ForShell(const std::string& path);

/// `text` with every byte that is not UTF-8 replaced: Protobuf, JSON and HTML take nothing else.
std::string ValidUtf8(const std::string& text);

}  // namespace rgbdt
