// A PCD as a sweep; PCD and PLY as a fused cloud and as a map.
#include "calib/files/points/cloud_files.h"
#include "calib/files/points/map_files.h"
#include "tests/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rgbdt;
  static const fuzz::ScratchFile file("cloud");
  const std::string bytes = fuzz::Input(data, size).Rest();
  file.Write(bytes);
  fuzz::Try([&] {
    const Cloud cloud = ReadPcd(file.path(), 1'700'000'000'000'000);
    fuzz::Require(cloud.points.size() ==
                      static_cast<std::size_t>(cloud.lines) * static_cast<std::size_t>(cloud.beams),
                  "lines x beams points");
  });
  fuzz::Try([&] {
    const RgbdtCloud cloud = ParseFused(bytes, "cloud");
    fuzz::Require(cloud.rgb.size() == cloud.size() && cloud.utime.size() == cloud.size() &&
                      cloud.valid.size() == cloud.size(),
                  "vectors of one length");
  });
  fuzz::Try([&] { ReadMapOrCloud(file.path()); });
  return 0;
}
