#include "calib/model/text.h"

#include <charconv>
#include <cstdarg>
#include <cstdio>

namespace rgbdt {

std::string Format(const char* format, ...) {
  std::va_list values;
  va_start(values, format);
  std::va_list again;
  va_copy(again, values);
  const int size = std::vsnprintf(nullptr, 0, format, values);
  va_end(values);
  std::string text(static_cast<std::size_t>(size > 0 ? size : 0), '\0');
  std::vsnprintf(text.data(), text.size() + 1, format, again);
  va_end(again);
  return text;
}

std::string Fixed(double value, int decimals) { return Format("%.*f", decimals, value); }

std::string Exact(double value) {
  char text[32];  // 24 characters at most
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

}  // namespace rgbdt
