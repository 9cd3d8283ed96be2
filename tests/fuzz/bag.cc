// An MCAP, or a ROS 1 bag: all of it, then some of its images and clouds once more.
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/read_bag.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rgbdt;
  static const fuzz::ScratchFile file("bag");
  file.Write(fuzz::Input(data, size).Rest());
  fuzz::Try([&] { fuzz::ReadBag(file.path()); });
  return 0;
}
