#include "services/bags/printable.h"

#include <algorithm>

#include "calib/model/text.h"

namespace rgbdt {

std::string Printable(const std::string& text) {
  constexpr std::size_t kMost = 255;
  std::string printable = text.substr(0, kMost);
  const auto is_control = [](unsigned char c) { return c < ' ' || c == 0x7f; };
  std::replace_if(printable.begin(), printable.end(), is_control, '?');
  return ValidUtf8(printable);
}

}  // namespace rgbdt
