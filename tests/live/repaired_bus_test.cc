// A bus that leaves its machine (ttl=1), here with nobody beyond: what it says is what LCM says.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lcm/lcm.h>

#include <chrono>
#include <functional>
#include <string>

#include "services/bus/bus.h"

namespace rgbdt {
namespace {

using Clock = std::chrono::steady_clock;

std::string Url() {
  std::string url = CompleteUrl("");
  const std::size_t ttl = url.find("ttl=0");
  return ttl == std::string::npos ? url : url.replace(ttl, 5, "ttl=1");
}

Bytes NumberedBytes(int number, std::size_t size) {
  Bytes bytes(size);
  for (std::size_t i = 0; i < size; ++i) {
    bytes[i] = static_cast<std::uint8_t>(i * 31 + static_cast<std::size_t>(number));
  }
  return bytes;
}

/// LCM's own receiver and sender.
class Lcm {
 public:
  Lcm() : lcm_(lcm_create(Url().c_str())) {}
  ~Lcm() { lcm_destroy(lcm_); }
  Lcm(const Lcm&) = delete;
  Lcm& operator=(const Lcm&) = delete;

  void Subscribe(const std::string& channel) {
    lcm_subscription_t* subscription = lcm_subscribe(
        lcm_, channel.c_str(),
        [](const lcm_recv_buf_t* buffer, const char*, void* user) {
          const auto* data = static_cast<const std::uint8_t*>(buffer->data);
          static_cast<Lcm*>(user)->came.emplace_back(data, data + buffer->data_size);
        },
        this);
    lcm_subscription_set_queue_capacity(subscription, 1000);
  }
  void Publish(const std::string& channel, const Bytes& bytes) {
    EXPECT_EQ(lcm_publish(lcm_, channel.c_str(), bytes.data(), static_cast<unsigned>(bytes.size())),
              0);
  }
  /// Until so many came, or half a minute is over.
  bool Has(std::size_t messages) {
    const Clock::time_point end = Clock::now() + std::chrono::seconds(30);
    while (came.size() < messages && Clock::now() < end) lcm_handle_timeout(lcm_, 50);
    return came.size() == messages;
  }

  std::vector<Bytes> came;

 private:
  lcm_t* lcm_;
};

TEST(RepairedBus, OtherLcmProgramsHearIt) {
  Lcm lcm;
  lcm.Subscribe("A");
  LcmBus bus(Url());
  std::size_t sent = 0;
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{1}, std::size_t{1390}, std::size_t{1391}, std::size_t{70'000},
        std::size_t{2'900'000}, std::size_t{10}}) {
    bus.Publish("A", NumberedBytes(static_cast<int>(sent++), size));
    ASSERT_TRUE(lcm.Has(sent)) << size;
    EXPECT_EQ(lcm.came.back(), NumberedBytes(static_cast<int>(sent) - 1, size)) << size;
  }
}

TEST(RepairedBus, HearsOtherLcmProgramsAndItself) {
  Lcm lcm;
  LcmBus bus(Url());
  std::vector<Bytes> came;
  bus.Subscribe("A", [&](const std::string&, const std::uint8_t* data, std::size_t size) {
    came.emplace_back(data, data + size);
  });
  for (int i = 0; i < 20; ++i) {
    const Bytes bytes = NumberedBytes(i, i % 3 == 0 ? 200'000 : 100);
    if (i % 2 == 0) {
      bus.Publish("A", bytes);
    } else {
      lcm.Publish("A", bytes);
    }
    const Clock::time_point end = Clock::now() + std::chrono::seconds(30);
    while (came.size() <= static_cast<std::size_t>(i) && Clock::now() < end) bus.Run(20);
    ASSERT_EQ(came.size(), static_cast<std::size_t>(i) + 1);
    EXPECT_EQ(came.back(), bytes);
  }
  EXPECT_EQ(bus.malformed().count, 0) << bus.malformed().newest;
}

TEST(RepairedBus, ItsOwnTalkIsNotHandedOver) {
  LcmBus bus(Url());
  std::vector<std::string> heard;
  bus.Subscribe(".*", [&](const std::string& channel, const std::uint8_t*, std::size_t) {
    heard.push_back(channel);
  });
  const Clock::time_point end = Clock::now() + std::chrono::milliseconds(1500);
  while (Clock::now() < end) bus.Run(20);
  EXPECT_THAT(heard, ::testing::IsEmpty());
  EXPECT_FALSE(bus.links().clocks.empty());  // and yet it was there
}

}  // namespace
}  // namespace rgbdt
