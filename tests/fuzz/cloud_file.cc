// PCD, PLY and floats without a head as a sweep; PCD and PLY as a fused cloud and as a map. What
// was read is written and read once more, of which nothing may be refused.
#include "calib/files/points/cloud_files.h"
#include "calib/files/points/map_files.h"
#include "tests/fuzz/fuzz.h"

namespace rgbdt {
namespace {

template <typename Write, typename Read>
void ReadBack(const fuzz::ScratchFile& file, std::size_t points, Write write, Read read) {
  constexpr std::size_t kFew = 200;  // writing syncs
  if (points > kFew) return;
  try {
    write(file.path());
    fuzz::Require(read(file.path()).size() == points, "as many points as were written");
  } catch (const InputError& error) {
    fuzz::Require(false, std::string("a cloud that is written and read; ") + error.what());
  }
}

void CheckSweep(const std::filesystem::path& path) {
  fuzz::Try([&] {
    const Cloud cloud = ReadSweep(path, 1'700'000'000'000'000);
    const std::size_t points = cloud.points.size();
    fuzz::Require(
        points == static_cast<std::size_t>(cloud.lines) * static_cast<std::size_t>(cloud.beams),
        "lines x beams points");
    for (const std::size_t other :
         {cloud.ring.size(), cloud.intensity.size(), cloud.utime.size()}) {
      fuzz::Require(other == 0 || other == points, "a value for each point, or none");
    }
  });
}

}  // namespace
}  // namespace rgbdt

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rgbdt;
  static const fuzz::ScratchFile file("cloud"), written("written");
  static const fuzz::ScratchFile kitti("cloud.bin"), nuscenes("cloud.pcd.bin");
  const std::string bytes = fuzz::Input(data, size).Rest();
  for (const fuzz::ScratchFile* sweep : {&file, &kitti, &nuscenes}) {
    sweep->Write(bytes);
    CheckSweep(sweep->path());
  }
  fuzz::Try([&] {
    const RgbdtCloud cloud = ParseFused(bytes, "cloud");
    fuzz::Require(cloud.rgb.size() == cloud.size() && cloud.utime.size() == cloud.size() &&
                      cloud.valid.size() == cloud.size(),
                  "vectors of one length");
    for (const bool ply : {false, true}) {
      ReadBack(
          written, cloud.size(),
          [&](const auto& path) { ply ? WritePly(path, cloud) : WritePcd(path, cloud); },
          ReadFused);
    }
  });
  fuzz::Try([&] {
    const MapCloud map = ReadMapOrCloud(file.path());
    if (map.voxel_m == 0) return;  // no map
    ReadBack(
        written, map.size(), [&](const auto& path) { WriteMapPly(path, map); }, ReadMapPly);
  });
  return 0;
}
