#include "viewer/live/bus_monitor.h"

#include <gtest/gtest.h>

#include "services/messages/codec.h"

namespace rgbdt::viewer {
namespace {

constexpr Utime kNow = 1'700'000'000'000'000;

class BusMonitorTest : public ::testing::Test {
 protected:
  void Add(const Message& message, double now_s) {
    const Bytes bytes = Encode(message);
    monitor_.Add(ChannelOf(message), bytes.data(), bytes.size(), now_s,
                 kNow + static_cast<Utime>(now_s * 1e6));
  }
  nlohmann::json Channel(const std::string& name, double now_s) const {
    for (const auto& channel : monitor_.Channels(now_s)) {
      if (channel.at("name") == name) return channel;
    }
    return {};
  }
  EncoderReading Reading(std::int64_t seq, Utime utime) const {
    EncoderReading reading;
    reading.seq = seq;
    reading.utime = utime;
    return reading;
  }

  BusMonitor monitor_;
};

TEST_F(BusMonitorTest, RateSizeAndLatency) {
  for (int i = 0; i < 60; ++i) {  // 10 Hz, each 20 ms old
    const double now_s = 0.1 * i;
    Add(Reading(i, kNow + static_cast<Utime>(now_s * 1e6) - 20'000), now_s);
  }
  const auto encoder = Channel("ENCODER", 5.9);
  EXPECT_EQ(encoder.at("count"), 60);
  EXPECT_NEAR(encoder.at("rate_hz"), 10, 0.5);
  EXPECT_NEAR(encoder.at("latency_ms"), 20, 0.01);
  const std::size_t size = Encode(Reading(0, kNow)).size();
  EXPECT_EQ(encoder.at("size_bytes"), size);
  EXPECT_NEAR(encoder.at("bytes_per_s"), 10.0 * static_cast<double>(size), 20);
  EXPECT_EQ(encoder.at("lost"), 0);
  EXPECT_EQ(Channel("ENCODER", 100).at("rate_hz"), 0);
}

TEST_F(BusMonitorTest, ASimulationsTimeHasNoLatency) {
  Add(Reading(0, 1'433'160'000'000'000), 0);
  EXPECT_TRUE(Channel("ENCODER", 0).at("latency_ms").is_null());
}

TEST_F(BusMonitorTest, MissingNumbersAreLostAndEachSenderCountsForItself) {
  for (const int seq : {0, 1, 4}) Add(Reading(seq, kNow), 0);
  EXPECT_EQ(Channel("ENCODER", 0).at("lost"), 2);
  for (int seq = 0; seq < 3; ++seq) {
    for (const char* process : {"solver", "detector"}) {
      Status status;
      status.process = process;
      status.seq = seq + (process[0] == 's' ? 1000 : 0);
      Add(status, 0);
      SessionEvent event;
      event.source = process;
      event.seq = status.seq;
      Add(event, 0);
    }
  }
  EXPECT_EQ(Channel("STATUS", 0).at("lost"), 0);
  EXPECT_EQ(Channel("SESSION_EVENT", 0).at("lost"), 0);
}

TEST_F(BusMonitorTest, AnyBytesAreCountedAndStrangersAreBounded) {
  const std::uint8_t few[3] = {1, 2, 3};
  monitor_.Add("STATUS", few, 3, 0, kNow);
  monitor_.Add("STATUS", few, 0, 0, kNow);
  EXPECT_EQ(Channel("STATUS", 0).at("count"), 2);
  for (const std::uint8_t first : {0x00, 0x7f, 0x80, 0xff}) {  // the largest and smallest numbers
    std::vector<std::uint8_t> bytes(24, first == 0x7f || first == 0xff ? 0xff : 0x00);
    bytes[8] = bytes[16] = first;
    monitor_.Add("ENCODER", bytes.data(), bytes.size(), 0, kNow);
  }
  EXPECT_EQ(Channel("ENCODER", 0).at("count"), 4);
  EXPECT_EQ(Channel("ENCODER", 0).at("lost"), 0);
  EXPECT_TRUE(Channel("ENCODER", 0).at("latency_ms").is_null());
  for (int i = 0; i < 1000; ++i) monitor_.Add("X" + std::to_string(i), few, 3, 0, kNow);
  EXPECT_EQ(monitor_.Channels(0).size(), BusMonitor::kMaxChannels);
}

}  // namespace
}  // namespace rgbdt::viewer
