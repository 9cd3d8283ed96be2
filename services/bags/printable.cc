#include "services/bags/printable.h"

#include "calib/model/printable.h"

namespace rgbdt {

std::string Printable(const std::string& text) {
  constexpr std::size_t kMost = 255;
  return PrintableText(text.substr(0, kMost));
}

}  // namespace rgbdt
