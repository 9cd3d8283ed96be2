#include "services/bus/internal/reassembly.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/datagrams.h"

namespace rgbdt {
namespace {

using test::Fragment;
using ::testing::HasSubstr;

class ReassemblyTest : public ::testing::Test {
 protected:
  std::optional<WholeMessage> Add(const Bytes& bytes, std::uint16_t port = 1) {
    // A copy of just these bytes: who reads beyond them is caught by the sanitizer.
    const Bytes exact(bytes.begin(), bytes.end());
    const char* problem = nullptr;
    std::optional<WholeMessage> message;
    if (const auto datagram = ParseDatagram(exact.data(), exact.size(), &problem)) {
      message = reassembly_.Add({1, port}, *datagram, &problem);
    }
    why_ = problem == nullptr ? "" : problem;
    return message;
  }

  // A message in fragments of so many bytes of data, as LCM sends it.
  static std::vector<Bytes> Sent(std::uint32_t seq, const Bytes& message, std::size_t each) {
    std::vector<Bytes> datagrams;
    const auto count = static_cast<std::uint32_t>((message.size() + each - 1) / each);
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::size_t begin = i * each, end = std::min(message.size(), begin + each);
      datagrams.push_back(Fragment{seq, static_cast<std::uint32_t>(message.size()),
                                   static_cast<std::uint32_t>(begin), i, count,
                                   i == 0 ? std::string("A\0", 2) : "",
                                   Bytes(&message[begin], &message[begin] + (end - begin))}
                              .Datagram());
    }
    return datagrams;
  }

  static Bytes Noise(std::size_t size, std::mt19937* random) {
    Bytes bytes(size);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>((*random)());
    return bytes;
  }

  Reassembly reassembly_{[](const std::string& channel) { return channel == "A"; }};
  std::string why_;
  std::mt19937 random_{1};
};

TEST_F(ReassemblyTest, ShortMessages) {
  const auto message = Add(test::ShortDatagram(1, std::string("A\0", 2), {1, 2}));
  ASSERT_TRUE(message);
  EXPECT_EQ(message->channel, "A");
  EXPECT_EQ(test::Arrived(message->bytes), Bytes({1, 2}));
  EXPECT_FALSE(Add(test::ShortDatagram(2, std::string("B\0", 2), {1})));
  EXPECT_EQ(why_, "");
  const auto empty = Add(test::ShortDatagram(3, std::string("A\0", 2), {}));
  EXPECT_TRUE(empty && empty->bytes.empty());
}

TEST_F(ReassemblyTest, FragmentsBehindTheFirstInAnyOrderAndTwice) {
  for (int i = 0; i < 50; ++i) {
    const Bytes message = Noise(1 + random_() % 5000, &random_);
    std::vector<Bytes> sent = Sent(static_cast<std::uint32_t>(i), message, 1 + random_() % 700);
    const std::vector<Bytes> once = sent;
    std::shuffle(sent.begin() + 1, sent.end(), random_);
    std::optional<WholeMessage> came;
    for (std::size_t k = 0; k < sent.size(); ++k) {
      ASSERT_FALSE(came);
      EXPECT_FALSE(k > 0 && Add(once.front()));
      came = Add(sent[k]);
      ASSERT_EQ(why_, "");
    }
    ASSERT_TRUE(came);
    EXPECT_EQ(test::Arrived(came->bytes), message);
    EXPECT_EQ(reassembly_.bytes_held(), 0U);
  }
}

TEST_F(ReassemblyTest, WithoutItsBeginningOrOnAnotherChannelAMessageIsPassedOver) {
  const std::vector<Bytes> sent = Sent(1, Noise(1000, &random_), 400);
  EXPECT_FALSE(Add(sent[1]) || Add(sent[2]));
  EXPECT_EQ(why_, "");
  EXPECT_FALSE(Add(Fragment{2, 1000, 0, 0, 3, std::string("B\0", 2), Bytes(9)}.Datagram()));
  EXPECT_EQ(why_, "");
  EXPECT_EQ(reassembly_.senders_held(), 0U);
}

TEST_F(ReassemblyTest, EachAttackIsRefusedAndNamed) {
  for (const test::Attack& attack : test::Attacks("A")) {
    for (const Bytes& datagram : attack.datagrams) {
      Add(datagram);
      EXPECT_EQ(why_.empty(), &datagram != &attack.datagrams.back()) << attack.why << ": " << why_;
    }
    EXPECT_THAT(why_, HasSubstr(attack.why));
  }
}

TEST_F(ReassemblyTest, WhatIsHeldIsBounded) {
  constexpr std::uint32_t kLargest = 3 * 1024 * 1024;
  const std::string name("A\0", 2);
  for (std::uint16_t port = 1; port < 1000; ++port) {
    const std::uint32_t size = port < 500 ? kLargest : 10;
    Add(Fragment{1, size, 0, 0, 2, name, Bytes(5)}.Datagram(), port);
    EXPECT_LE(reassembly_.bytes_held(), std::size_t{64} << 20);
    EXPECT_LE(reassembly_.senders_held(), 256U);
  }
  // The newest is there, the oldest gave way.
  EXPECT_TRUE(Add(Fragment{1, 10, 5, 1, 2, "", Bytes(5)}.Datagram(), 999));
  EXPECT_FALSE(Add(Fragment{1, 10, 5, 1, 2, "", Bytes(5)}.Datagram(), 500));
}

// Fragments by lot of messages that are sevens only: what comes out is nothing else.
TEST_F(ReassemblyTest, WhateverComesOutWasSent) {
  int came = 0;
  for (int i = 0; i < 200'000; ++i) {
    const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random_() % n); };
    Fragment fragment{below(2), below(20), below(24), below(4), below(4), "", Bytes(below(12), 7)};
    if (below(50) == 0) fragment.begin = 0xffffffff - fragment.begin;
    if (fragment.number == 0 && below(9) != 0) fragment.text = std::string("A\0", 2);
    if (fragment.number == 0 && below(9) != 0) fragment.begin = 0;
    Bytes bytes = fragment.Datagram();
    if (below(10) == 0) bytes.resize(below(static_cast<std::uint32_t>(bytes.size())));
    if (const auto message = Add(bytes)) {
      EXPECT_EQ(message->bytes, MessageBytes(message->bytes.size(), 7));
      ++came;
    }
  }
  EXPECT_GT(came, 100);
}

}  // namespace
}  // namespace rgbdt
