// An MCAP, or a ROS 1 bag: all of it, then some of its images and clouds once more; and as one of
// two parts of a bag that is split.
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/read_bag.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rgbdt;
  static const fuzz::ScratchFile file("bag_2.mcap");
  static const std::filesystem::path first = file.folder() / "bag_1.mcap";
  const std::string bytes = fuzz::Input(data, size).Rest();
  file.Write(bytes);
  fuzz::Try([&] { fuzz::ReadBag(file.path()); });
  constexpr std::size_t kFew = 1000;  // the larger ones take their time
  if (size > kFew) return 0;
  std::filesystem::copy_file(file.path(), first);
  fuzz::Try([&] { fuzz::ReadBag(file.folder()); });
  std::filesystem::remove(first);
  return 0;
}
