#include "calib/files/import/internal/view_names.h"

#include "calib/files/name_keys.h"
#include "calib/model/printable.h"

namespace rgbdt {

std::string ViewNames::NameOf(const std::string& file) {
  constexpr std::size_t kMost = 90;  // bytes, of the 100 that a view's name may have
  std::string wanted = StemOf(file);
  for (char& c : wanted) {
    if (static_cast<unsigned char>(c) <= ' ') c = '_';
  }
  wanted = PrintableText(wanted).substr(0, kMost);
  while (!IsPrintable(wanted)) wanted.pop_back();  // a character was cut through
  return names_.Make(wanted);
}

}  // namespace rgbdt
