#include "calib/files/import/camera_kind.h"

#include <cctype>
#include <initializer_list>

namespace rgbdt {
namespace {

bool HasAny(const std::string& text, std::initializer_list<const char*> words) {
  for (const char* word : words) {
    if (text.find(word) != std::string::npos) return true;
  }
  return false;
}

// In small letters, all else blanks, blanks around: "/IR/left2" is " ir left  ".
std::string Words(const std::string& name) {
  std::string words = " ";
  for (const char c : name) {
    const auto u = static_cast<unsigned char>(c);
    words += std::isalpha(u) != 0 ? static_cast<char>(std::tolower(u)) : ' ';
  }
  return words + ' ';
}

}  // namespace

bool SaysThermal(const std::string& name, bool sixteen_bit) {
  const std::string words = Words(name);
  return HasAny(words, {"therm", "lwir"}) ||
         (sixteen_bit && HasAny(words, {"flir", "boson", "lepton", " tau ", " ir "}));
}

}  // namespace rgbdt
