#include "services/runtime/device_thread.h"

#include <gmock/gmock.h>

#include <future>

namespace rgbdt {
namespace {

using ::testing::HasSubstr;

TEST(DeviceThread, ServesAgainAfterAFailureAndWarnsWhy) {
  std::promise<void> served_again;
  int calls = 0;
  DeviceThread thread([&](DeviceThread& self) {
    if (++calls == 1) throw DeviceError("unplugged");
    EncoderReading reading;
    reading.ticks = 7;
    self.Publish(reading);
    served_again.set_value();
    while (self.Sleep(1'000'000)) {
    }
  });
  served_again.get_future().wait();
  const DeviceOutput output = thread.Take();
  ASSERT_EQ(output.warnings.size(), 1u);
  EXPECT_EQ(output.warnings[0], "unplugged");
  ASSERT_EQ(output.messages.size(), 1u);
  EXPECT_EQ(std::get<EncoderReading>(output.messages[0]).ticks, 7);
  EXPECT_FALSE(thread.ended());
}

TEST(DeviceThread, StopsAtOnceWhileItSleeps) {
  std::promise<void> sleeping;
  DeviceThread thread([&](DeviceThread& self) {
    sleeping.set_value();
    EXPECT_FALSE(self.Sleep(1'000'000'000));
  });
  sleeping.get_future().wait();
  thread.Stop();
  EXPECT_TRUE(thread.ended());
}

TEST(DeviceThread, GivesUpTheOldestMessagesAndSaysHowMany) {
  std::promise<void> done;
  DeviceThread thread([&](DeviceThread& self) {
    for (std::size_t i = 0; i < DeviceThread::kMaxWaiting + 3; ++i) {
      EncoderReading reading;
      reading.ticks = static_cast<std::int64_t>(i);
      self.Publish(reading);
    }
    done.set_value();
  });
  done.get_future().wait();
  const DeviceOutput output = thread.Take();
  ASSERT_EQ(output.messages.size(), DeviceThread::kMaxWaiting);
  EXPECT_EQ(std::get<EncoderReading>(output.messages[0]).ticks, 3);
  ASSERT_EQ(output.warnings.size(), 1u);
  EXPECT_THAT(output.warnings[0], HasSubstr("3 messages"));
}

}  // namespace
}  // namespace rgbdt
