// A Livox's messages of a second are one cloud.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calib/files/atomic_file.h"
#include "services/bags/mcap_writer.h"
#include "services/import/import_bag.h"
#include "tests/unit/files/test_data.h"
#include "tests/unit/import/ros_bytes.h"

namespace rgbdt {
namespace {

using test::RosBytes;

constexpr Utime kBegin = 1'700'000'000'000'000;
constexpr std::uint32_t kPoints = 5;

// One of ten messages a second; its points' x tells its number.
std::string Message(int number) {
  const Utime utime = kBegin + 100'000 * static_cast<Utime>(number);
  RosBytes m(BagEncoding::kCdr);
  m.Header(static_cast<std::uint32_t>(utime / 1'000'000),
           static_cast<std::uint32_t>(utime % 1'000'000 * 1000), "livox_frame");
  m.Add(static_cast<std::uint64_t>(utime) * 1000).Add(kPoints).Add(std::uint32_t{0}).Add(kPoints);
  for (std::uint32_t i = 0; i < kPoints; ++i) {
    m.Add(i * 1'000'000).Add(static_cast<float>(number + 1)).Add(0.5F).Add(0.5F);
    m.Add(std::uint8_t{51}).Add(static_cast<std::uint8_t>(i == 4 ? 2 : 0)).Add(std::uint8_t{1});
  }
  return m.Bytes();
}

TEST(LivoxClouds, TheMessagesOfASecondAreOne) {
  const test::TempDir dir;
  std::string bytes;
  McapWriter writer([&](std::string_view more) { bytes += more; }, "test");
  const auto schema = writer.AddSchema("livox_ros_driver2/msg/CustomMsg", "ros2msg", "");
  const auto channel = writer.AddChannel("/livox/lidar", schema, "cdr");
  for (int i = 0; i < 30; ++i) writer.Write(channel, kBegin + i, kBegin + i, Message(i));
  writer.Finish();
  WriteFileAtomically(dir / "x.mcap", bytes);
  const auto bag = OpenBag(dir / "x.mcap");
  const BagSurvey survey = SurveyBag(bag.get(), nullptr);
  const BagSurvey::Topic* topic = survey.Find("/livox/lidar");
  ASSERT_NE(topic, nullptr);
  ASSERT_EQ(topic->stamped.size(), 30U) << topic->problem;
  EXPECT_TRUE(topic->livox);
  const CloudReader read = CloudMessages(bag.get(), *topic);
  const Cloud middle = read(topic->stamped[15]);
  EXPECT_EQ(middle.size(), 10 * (kPoints - 1)) << "of each, one is noise";
  EXPECT_EQ(middle.points.front().x(), 11);
  EXPECT_EQ(middle.points.back().x(), 20);
  EXPECT_EQ(middle.sweep_utime, kBegin + 1'000'000);
  EXPECT_EQ(middle.utime.back(), kBegin + 1'903'000);
  EXPECT_FALSE(middle.organised);
  EXPECT_TRUE(middle.ring.empty());
  EXPECT_EQ(middle.beams, 40);
  EXPECT_EQ(read(topic->stamped[0]).size(), 5 * (kPoints - 1)) << "what there is";
}

}  // namespace
}  // namespace rgbdt
