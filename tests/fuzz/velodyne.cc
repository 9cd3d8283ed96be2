// Packets of a spinning LIDAR, one after the other. The first byte says of which sensor, and
// whether each block's flag is put right.
#include "services/drivers/velodyne/velodyne_packets.h"
#include "services/drivers/velodyne/velodyne_sweeps.h"
#include "tests/fuzz/fuzz.h"

namespace rgbdt {
namespace {

// A block has 100 bytes and begins with FF EE; of an HDL-64E's every second one with FF DD.
void MendFlags(bool lower_too, std::string* packet) {
  constexpr std::size_t kBlock = 100, kBlocks = 12;
  for (std::size_t block = 0; block < kBlocks && (block + 1) * kBlock <= packet->size(); ++block) {
    (*packet)[block * kBlock] = '\xff';
    (*packet)[block * kBlock + 1] = lower_too && block % 2 == 1 ? '\xdd' : '\xee';
  }
}

}  // namespace
}  // namespace rgbdt

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rgbdt;
  using Model = VelodyneDevice::Model;
  constexpr Model kModels[] = {Model::kVlp16, Model::kVlp32c, Model::kHdl32e, Model::kHdl64e};
  fuzz::Input input(data, size);
  const unsigned kind = input.Byte();
  const Model model = kModels[kind % 4];
  VelodyneSweeps sweeps(model);
  Utime arrival = 1'700'000'000'000'000;
  while (!input.empty()) {
    arrival += 64 * input.Word();
    std::string bytes = input.Take(velodyne::kDataBytes);
    if ((kind & 4) != 0) MendFlags(model == Model::kHdl64e, &bytes);
    fuzz::Try([&] {
      const auto packet =
          velodyne::Decode(velodyne::SensorOf(model), fuzz::Data(bytes), bytes.size());
      for (const Cloud& cloud : sweeps.Add(packet, arrival)) {
        fuzz::Require(cloud.points.size() == static_cast<std::size_t>(cloud.lines) *
                                                 static_cast<std::size_t>(cloud.beams),
                      "lines x beams points");
      }
    });
  }
  return 0;
}
