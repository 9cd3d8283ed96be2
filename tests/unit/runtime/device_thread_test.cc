#include "services/runtime/device_thread.h"

#include <gmock/gmock.h>

#include <future>

namespace rgbdt {
namespace {

using ::testing::HasSubstr;

TEST(DeviceThread, ServesAgainAfterAFailureAndTellsWhy) {
  std::promise<void> served_again;
  int calls = 0;
  DeviceThread thread([&](DeviceThread& self) {
    if (++calls == 1) throw DeviceError("unplugged");
    EncoderReading reading;
    reading.ticks = 7;
    self.Say(reading);
    served_again.set_value();
    while (self.Sleep(1000)) {
    }
  });
  served_again.get_future().wait();
  const DeviceNews news = thread.TakeNews();
  ASSERT_EQ(news.problems.size(), 1u);
  EXPECT_EQ(news.problems[0], "unplugged");
  ASSERT_EQ(news.messages.size(), 1u);
  EXPECT_EQ(std::get<EncoderReading>(news.messages[0]).ticks, 7);
  EXPECT_FALSE(thread.ended());
}

TEST(DeviceThread, StopsAtOnceWhileItSleeps) {
  std::promise<void> sleeping;
  DeviceThread thread([&](DeviceThread& self) {
    sleeping.set_value();
    EXPECT_FALSE(self.Sleep(1'000'000));
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
      self.Say(reading);
    }
    done.set_value();
  });
  done.get_future().wait();
  const DeviceNews news = thread.TakeNews();
  ASSERT_EQ(news.messages.size(), DeviceThread::kMaxWaiting);
  EXPECT_EQ(std::get<EncoderReading>(news.messages[0]).ticks, 3);
  ASSERT_EQ(news.problems.size(), 1u);
  EXPECT_THAT(news.problems[0], HasSubstr("3 messages"));
}

}  // namespace
}  // namespace rgbdt
