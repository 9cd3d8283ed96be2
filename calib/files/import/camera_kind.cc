#include "calib/files/import/camera_kind.h"

#include <array>
#include <initializer_list>

#include "calib/model/errors.h"
#include "calib/model/text.h"

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
  for (const char c : ToLower(name)) words += c >= 'a' && c <= 'z' ? c : ' ';
  return words + ' ';
}

}  // namespace

bool SaysThermal(const std::string& name, bool sixteen_bit) {
  const std::string words = Words(name);
  return HasAny(words, {"therm", "lwir"}) ||
         (sixteen_bit && HasAny(words, {"flir", "boson", "lepton", " tau ", " ir "}));
}

double DarkOverBright(const cv::Mat& counts) {
  if (counts.type() != CV_16UC1 || counts.empty()) {
    throw InputError("counts are of OpenCV type " + std::to_string(counts.type()) +
                     "; expected one channel of 16 bit");
  }
  std::vector<std::size_t> pixels(1 << 16);
  for (int y = 0; y < counts.rows; ++y) {
    const auto* row = counts.ptr<std::uint16_t>(y);
    for (int x = 0; x < counts.cols; ++x) ++pixels[row[x]];
  }
  const auto part = [&](double of_all) {
    const double wanted = of_all * static_cast<double>(counts.total());
    std::size_t count = 0, seen = pixels[0];
    while (static_cast<double>(seen) <= wanted) seen += pixels[++count];
    return static_cast<double>(count);
  };
  const double bright = part(0.99);
  return bright == 0 ? 0 : part(0.01) / bright;
}

SixteenBitKind KindOfSixteenBit(const std::vector<std::string>& names, double dark_over_bright) {
  for (const std::string& name : names) {
    if (SaysThermal(name, true)) return {CameraKind::kThermal, ""};
    if (HasAny(Words(name), {"rgb", "color", "colour", "visible"})) return {CameraKind::kColor, ""};
  }
  const bool thermal = dark_over_bright >= 0.5;
  const std::string values = Format(": the darkest are %.2f of the brightest", dark_over_bright);
  return {thermal ? CameraKind::kThermal : CameraKind::kColor,
          (thermal ? "16 bit, taken for a thermal camera's counts by their values"
                   : "16 bit, taken for a grey picture by its values") +
              values};
}

}  // namespace rgbdt
