#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/drivers/ouster/ouster_sweeps.h"
#include "tests/unit/packets/ouster_encoder.h"

namespace rgbdt {
namespace {

using test::OusterEncoder;
using testing::SizeIs;

constexpr Utime kFirstArrival = 1'700'000'000'000'000;

TEST(OusterTimes, ALatePacketKeepsItsTime) {
  OusterEncoder encoder;
  encoder.first_ns = (kFirstArrival + 37'000'000) * 1000;
  OusterSweeps sweeps(ouster::ParseMetadata(encoder.Metadata(), "os.json"));
  std::vector<Cloud> done;
  for (int i = 0; i < 6; ++i) {
    const auto bytes = encoder.Packet(i / 2, i % 2);
    const Utime late = i == 2 ? 500'000 : 0;
    const auto packet = ouster::Decode(sweeps.metadata(), bytes.data(), bytes.size());
    if (auto sweep = sweeps.Add(packet, kFirstArrival + 1600 * i + late))
      done.push_back(std::move(*sweep));
  }
  ASSERT_THAT(done, SizeIs(2));
  EXPECT_EQ(done[1].sweep_utime, kFirstArrival + 32 * 97);
}

TEST(OusterTimes, WithinATurnAreTheSensorsHoweverPacketsArrive) {
  const OusterEncoder encoder;  // its clock counts since it was switched on
  OusterSweeps sweeps(ouster::ParseMetadata(encoder.Metadata(), "os.json"));
  std::vector<Cloud> done;
  for (int i = 0; i < 6; ++i) {
    const auto bytes = encoder.Packet(i / 2, i % 2);
    const Utime late = i % 2 == 0 ? 1000 - 100 * i : 0;
    const auto packet = ouster::Decode(sweeps.metadata(), bytes.data(), bytes.size());
    if (auto sweep = sweeps.Add(packet, kFirstArrival + 1552 * i + late))
      done.push_back(std::move(*sweep));
  }
  ASSERT_THAT(done, SizeIs(2));
  for (const Cloud& sweep : done) {
    for (int column = 0; column < 32; ++column) {
      const int beam = (column + encoder.shifts[3] + 32) % 32;
      EXPECT_NEAR(
          static_cast<double>(sweep.utime[static_cast<std::size_t>(beam)] - sweep.sweep_utime),
          column * 97.0, 1);
    }
  }
  EXPECT_EQ(done[1].sweep_utime - done[0].sweep_utime, 32 * 97 - 1000)
      << "by the packets before it, the first of which was late";
}

}  // namespace
}  // namespace rgbdt
