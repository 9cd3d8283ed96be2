#include "services/import/import_log.h"

#include <gtest/gtest.h>

#include <ctime>

#include "calib/files/atomic_file.h"
#include "services/bags/mcap_writer.h"
#include "services/bus/log.h"
#include "tests/unit/files/test_data.h"
#include "tests/unit/import/ros_bytes.h"

namespace rgbdt {
namespace {

// A message of a Livox that tells no time: the bag's is its.
std::string Timeless() {
  test::RosBytes m(BagEncoding::kCdr);
  m.Header(0, 0, "livox_frame").Add(std::uint64_t{0}).Add(1U).Add(0U).Add(1U);
  m.Add(0U).Add(1.0F).Add(0.5F).Add(0.5F);
  return m.Add(std::uint8_t{51}).Add(std::uint8_t{0}).Add(std::uint8_t{1}).Bytes();
}

TEST(WriteLog, ALivoxsSecondsAreNotCountedOneByOne) {
  constexpr Utime kEarly = 1'000'000, kLate = 9'000'000'000'000'000;
  const test::TempDir dir;
  std::string bytes;
  McapWriter writer([&](std::string_view more) { bytes += more; }, "test");
  const auto schema = writer.AddSchema("livox_ros_driver2/msg/CustomMsg", "ros2msg", "");
  const auto channel = writer.AddChannel("/livox/lidar", schema, "cdr");
  for (const Utime utime : {kEarly, kEarly + 900'000, kEarly + 1'100'000, kLate}) {
    writer.Write(channel, utime, utime, Timeless());
  }
  writer.Finish();
  WriteFileAtomically(dir / "x.mcap", bytes);
  const auto bag = OpenBag(dir / "x.mcap");
  const BagSurvey survey = SurveyBag(bag.get(), nullptr);
  TopicWishes wishes;
  wishes.clouds_alone = true;
  const TopicChoice choice = ChooseTopics(survey, wishes);
  const std::clock_t begin = std::clock();
  const WrittenLog written =
      WriteLog(bag.get(), choice, std::nullopt, CloudMessages(bag.get(), *choice.lidar.clouds),
               dir / "log", {});
  EXPECT_LT(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC, 1);
  EXPECT_EQ(written.clouds, 3) << written.last_problem;
  LogReader log(dir / "log");
  std::vector<Utime> heard;
  while (const auto event = log.Next()) heard.push_back(event->receive_utime);
  EXPECT_EQ(heard, (std::vector<Utime>{kEarly + 1'000'000, kEarly + 2'000'000, kLate + 1'000'000}));
}

}  // namespace
}  // namespace rgbdt
