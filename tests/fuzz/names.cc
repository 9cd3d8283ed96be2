// Names of files: a line each of images, and behind an empty line those of clouds. The first byte:
// whether they are paired in order.
#include <algorithm>
#include <set>

#include "calib/files/import/pairing.h"
#include "tests/fuzz/fuzz.h"

namespace rgbdt {
namespace {

// At least one, as a folder without any is refused before. No more than a few: names are short.
FileList TakeNames(std::string* text, const char* what) {
  constexpr std::size_t kMost = 50;
  FileList files{"folder", {}, what};
  while (files.names.size() < kMost) {
    const std::size_t end = std::min(text->find('\n'), text->size());
    const std::string name = text->substr(0, end);
    text->erase(0, std::min(end + 1, text->size()));
    if (name.empty()) break;
    files.names.push_back(name);
  }
  if (files.names.empty()) files.names.emplace_back("0001");
  return files;
}

bool IsTime(Utime utime) {
  constexpr Utime kFirst = 978'307'200'000'000, kLast = 4'102'531'200'000'000;  // 2001, 2100
  return utime == 0 || (utime >= kFirst && utime < kLast);
}

void CheckPairs(const Pairs& pairs, const FileList& images, const FileList& clouds) {
  std::set<std::size_t> taken;
  std::size_t count = 0;
  for (const auto& cloud : pairs.cloud_of) {
    if (!cloud) continue;
    ++count;
    fuzz::Require(*cloud < clouds.names.size() && taken.insert(*cloud).second,
                  "each cloud once at most");
  }
  fuzz::Require(count == pairs.count && count > 0, "as many pairs as it says");
  fuzz::Require(pairs.cloud_of.size() == images.names.size() &&
                    pairs.image_utime.size() == images.names.size() &&
                    pairs.cloud_utime.size() == clouds.names.size(),
                "an entry for each file");
  fuzz::Require(std::all_of(pairs.image_utime.begin(), pairs.image_utime.end(), IsTime) &&
                    std::all_of(pairs.cloud_utime.begin(), pairs.cloud_utime.end(), IsTime),
                "times from 2001 to 2099");
}

}  // namespace
}  // namespace rgbdt

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rgbdt;
  fuzz::Input input(data, size);
  PairOptions options;
  options.in_order = input.Byte() % 4 == 1;
  std::string text = input.Rest();
  const FileList images = TakeNames(&text, "image"), clouds = TakeNames(&text, "cloud");
  fuzz::Try([&] { CheckPairs(PairFiles(images, clouds, options), images, clouds); });
  return 0;
}
