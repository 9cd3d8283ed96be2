// A ROS 2 bag of sqlite, as bag.cc.
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/read_bag.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rgbdt;
  static const fuzz::ScratchFile file("bag.db3");
  std::string bytes = fuzz::Input(data, size).Rest();
  const std::string begin("SQLite format 3\0", 16);
  if (bytes.size() > begin.size()) bytes.replace(0, begin.size(), begin);
  file.Write(bytes);
  fuzz::Try([&] { fuzz::ReadBag(file.path()); });
  return 0;
}
