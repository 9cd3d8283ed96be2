#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <limits>
#include <random>

#include "services/bus/internal/repaired_streams.h"
#include "services/bus/internal/sent_messages.h"
#include "services/messages/limits.h"
#include "tests/datagrams.h"

namespace rgbdt {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Bytes Noise(std::size_t size, std::mt19937* random) {
  Bytes bytes(size);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>((*random)());
  return bytes;
}

Bytes DatagramOf(const SentMessage& message, std::size_t number) {
  Bytes bytes = message.Header(number);
  const auto [data, size] = message.Data(number);
  bytes.insert(bytes.end(), data, data + size);
  return bytes;
}

/// A sender, a receiver and a network between them that loses a share of what either says, in
/// virtual time: a millisecond each way.
class Link {
 public:
  explicit Link(double loss) : loss_(loss) { Beat(); }

  void Send(const std::string& channel, const Bytes& bytes) {
    const SentMessage& message = sent_.Add(channel, bytes, now_);
    for (std::size_t i = 0; i < message.datagrams(); ++i) {
      ++datagrams_;
      if (Loses()) {
        ++lost;
        continue;
      }
      Receive(DatagramOf(message, i), false);
    }
  }

  /// As the bus does: every 5 ms what is due, and a Beat every 20 ms.
  void Run(Utime time) {
    for (const Utime end = now_ + time; now_ < end; now_ += 5'000) {
      if (now_ % 20'000 == 0 && !Loses()) Beat();
      for (const RepairRequest& request : receiver_.Ask(now_)) {
        ++requests;
        if (Loses()) continue;
        EXPECT_LE(Encode(request).size(), 1400U);
        for (const Bytes& datagram : sent_.Repeat(request.parts, now_ + 1'000)) {
          repeated_bytes += datagram.size();
          if (!Loses()) Receive(datagram, true);
        }
      }
      Take();
    }
  }

  void Beat() {
    receiver_.OnBeat(kSender, {7, sent_.oldest(), sent_.next(), datagrams_, kWall + now_, "other"},
                     now_, kWall + now_);
    Take();
  }

  bool cut = false;
  std::int64_t lost = 0, requests = 0;
  std::size_t repeated_bytes = 0;
  std::vector<WholeMessage> came;
  LinkReport report() const { return receiver_.report(); }

 private:
  static constexpr RepairedStreams::Sender kSender{0x0200000a, 7};
  static constexpr Utime kWall = 1'500'000'000'000'000;

  bool Loses() { return cut || std::uniform_real_distribution<>(0, 1)(random_) < loss_; }

  void Receive(const Bytes& bytes, bool repair) {
    const char* why = nullptr;
    const auto datagram = ParseDatagram(bytes.data(), bytes.size(), &why);
    ASSERT_TRUE(datagram) << why;
    if (repair) {
      receiver_.AddRepair(kSender, *datagram, now_, &why);
    } else {
      EXPECT_TRUE(receiver_.Add(kSender, *datagram, now_, &why));
    }
    EXPECT_EQ(why, nullptr);
    Take();
  }

  void Take() {
    for (WholeMessage& message : receiver_.Take()) came.push_back(std::move(message));
  }

  double loss_;
  Utime now_ = 20'000;
  std::uint64_t datagrams_ = 0;
  SentMessages sent_;
  RepairedStreams receiver_{[](const std::string& channel) { return channel != "UNWANTED"; }};
  std::mt19937 random_{5};
};

// A stranger's numbers.
TEST(RepairedStreams, LossesThatCannotBeAddNothingUpToLessThanNothing) {
  RepairedStreams streams([](const std::string&) { return true; });
  for (std::uint64_t id = 1; id <= 3; ++id) {
    const Reassembly::Sender sender(static_cast<std::uint32_t>(id), 7667);
    streams.OnBeat(sender, {id, 0, 0, 0, 1, "a"}, 1, 1);
    streams.OnBeat(sender, {id, 0, 0, std::uint64_t{1} << 62, 1, "a"}, 2, 1);
  }
  EXPECT_EQ(streams.report().datagrams_lost, kMaxInteger);
  streams.OnBeat({1, 7667}, {9, 0, 0, 0, 1, "another on that port"}, 3, 1);
  EXPECT_EQ(streams.report().datagrams_lost, kMaxInteger);
}

TEST(SentMessage, FitsAFrameAndIsWhatLcmReads) {
  std::mt19937 random(1);
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{1}, std::size_t{1389}, std::size_t{1390}, std::size_t{1391},
        std::size_t{2770}, std::size_t{100'000}, kMaxMessageBytes}) {
    const Bytes bytes = Noise(size, &random);
    const SentMessage message(9, "A", bytes);
    Reassembly reassembly([](const std::string&) { return true; });
    std::optional<WholeMessage> whole;
    for (std::size_t i = 0; i < message.datagrams(); ++i) {
      ASSERT_FALSE(whole);
      const Bytes datagram = DatagramOf(message, i);
      EXPECT_LE(datagram.size(), SentMessage::kDatagramBytes);
      const char* why = nullptr;
      const auto parsed = ParseDatagram(datagram.data(), datagram.size(), &why);
      ASSERT_TRUE(parsed) << size << ": " << why;
      EXPECT_EQ(parsed->seq, 9U);
      whole = reassembly.Add({1, 1}, *parsed, &why);
      EXPECT_EQ(why, nullptr) << why;
    }
    ASSERT_TRUE(whole) << size;
    EXPECT_EQ(whole->channel, "A");
    EXPECT_EQ(test::Arrived(whole->bytes), bytes);
  }
  EXPECT_FALSE(SentMessage::Fits("A", 100'000'000));
}

class RepairTest : public ::testing::TestWithParam<double> {};

TEST_P(RepairTest, EveryMessageComesOnceInOrder) {
  std::mt19937 random(2);
  Link link(GetParam());
  std::vector<Bytes> sent;
  for (int i = 0; i < 60; ++i) {
    sent.push_back(Noise(i % 4 == 0 ? 1'500'000 : random() % 5'000, &random));
    link.Send("A", sent.back());
    if (i % 10 == 0) link.Send("UNWANTED", sent.back());
    link.Run(50'000);
  }
  link.Run(3'000'000);
  ASSERT_EQ(link.came.size(), sent.size());
  for (std::size_t i = 0; i < sent.size(); ++i)
    EXPECT_EQ(test::Arrived(link.came[i].bytes), sent[i]) << i;
  const LinkReport report = link.report();
  EXPECT_EQ(report.datagrams_lost, link.lost);
  EXPECT_EQ(report.messages_given_up, 0);
  EXPECT_GT(link.lost, 0);
  EXPECT_GT(report.datagrams_repaired, 0);
  EXPECT_LE(report.datagrams_repaired, link.lost);
  EXPECT_THAT(report.worst, HasSubstr("other (10.0.0.2): "));
}

INSTANTIATE_TEST_SUITE_P(Losses, RepairTest, ::testing::Values(0.001, 0.01, 0.05, 0.2));

TEST(Repair, NothingIsAskedWhereNothingIsLost) {
  Link link(0);
  for (int i = 0; i < 20; ++i) {
    link.Send("A", Bytes(300'000, 1));
    link.Run(100'000);
  }
  EXPECT_EQ(link.requests, 0);
  EXPECT_EQ(link.came.size(), 20U);
}

TEST(Repair, AMachineThatWasCutOffGoesOnAndItsLossIsCounted) {
  Link link(0);
  link.Send("A", Bytes(100, 1));
  link.Run(100'000);
  link.cut = true;
  for (int i = 0; i < 100; ++i) {
    link.Send("A", Bytes(10'000, 2));
    link.Run(100'000);
  }
  link.cut = false;
  link.Send("A", Bytes(100, 3));
  link.Run(3'000'000);
  ASSERT_GE(link.came.size(), 2U);
  EXPECT_EQ(test::Arrived(link.came.back().bytes), Bytes(100, 3));
  const LinkReport report = link.report();
  EXPECT_EQ(report.datagrams_lost, link.lost);
  // What the sender still had came, the rest is told.
  EXPECT_EQ(static_cast<std::size_t>(report.messages_given_up) + link.came.size(), 102U);
  EXPECT_LT(report.messages_given_up, 65);
  EXPECT_GE(report.messages_given_up, 55);
}

TEST(Repair, WhatIsRepeatedIsBounded) {
  SentMessages sent;
  sent.Add("A", Bytes(3'000'000, 1), 0);
  std::vector<MissingParts> all(1);
  for (std::uint16_t i = 0; i < 2000; ++i) all[0].fragments.push_back(i);
  std::size_t bytes = 0;
  const auto ask = [&](Utime now) {
    for (const Bytes& datagram : sent.Repeat(all, now)) bytes += datagram.size();
  };
  ask(10'000);
  ask(10'000);
  EXPECT_LE(bytes, static_cast<std::size_t>(SentMessages::kRepeatedAtOnce) + 1400);
  bytes = 0;
  for (Utime now = 10'000; now < 1'010'000; now += 1'000) ask(now);
  EXPECT_LE(bytes, static_cast<std::size_t>(SentMessages::kRepeatedPerSecond) + 1400);
  EXPECT_THAT(sent.Repeat({{5, {}}, {0, {5000}}}, 5'000'000), IsEmpty());  // none of its
}

TEST(Repair, MemoryIsBounded) {
  SentMessages sent;
  for (int i = 0; i < 100; ++i) sent.Add("A", Bytes(3'000'000, 1), 1000 + i);
  EXPECT_GE(sent.next() - sent.oldest(), 20U);
  EXPECT_LE((sent.next() - sent.oldest()) * 3'000'000U, SentMessages::kMaxBytes);
  // Messages of which one fragment came each.
  RepairedStreams streams([](const std::string&) { return true; });
  streams.OnBeat({1, 1}, {7, 0, 0, 0, 0, "x"}, 0, 0);
  const char* why = nullptr;
  for (std::uint32_t seq = 0; seq < 1000; ++seq) {
    const Bytes bytes = DatagramOf(SentMessage(seq, "A", Bytes(2'900'000, 1)), 0);
    EXPECT_TRUE(streams.Add({1, 1}, *ParseDatagram(bytes.data(), bytes.size(), &why), 0, &why));
  }
  EXPECT_GE(streams.report().messages_given_up, 1000 - 23);
}

// A beat of 60 bytes that speaks of 4096 messages.
void BeatFarAhead(std::uint32_t sender, RepairedStreams* streams) {
  for (const std::uint32_t next : {0U, OrderedStream::kMaxAhead}) {
    streams->OnBeat({sender, 1}, {sender, 0, next, 0, 0, "x"}, 0, 0);
  }
}

TEST(Repair, MessagesOfWhichNothingCameTakeMemoryThatIsBounded) {
  RepairedStreams streams([](const std::string&) { return true; });
  streams.OnBeat({1, 1}, {1, 0, 0, 0, 0, "x"}, 0, 0);
  const char* why = nullptr;
  for (std::uint32_t seq = 0; seq < 22; ++seq) {
    const Bytes bytes = DatagramOf(SentMessage(seq, "A", Bytes(2'900'000, 1)), 0);
    EXPECT_TRUE(streams.Add({1, 1}, *ParseDatagram(bytes.data(), bytes.size(), &why), 0, &why));
  }
  EXPECT_EQ(streams.report().messages_given_up, 0);
  const std::size_t before = streams.bytes_held();
  BeatFarAhead(2, &streams);
  EXPECT_GE(streams.bytes_held() - before, 4096 * sizeof(Utime));
  for (std::uint32_t sender = 3; sender <= RepairedStreams::kMaxSenders; ++sender) {
    BeatFarAhead(sender, &streams);
    EXPECT_LE(streams.bytes_held(), RepairedStreams::kMaxBytesHeld) << sender;
  }
  EXPECT_GE(streams.report().messages_given_up, 10);
}

// The thread that receives does so for each hundred datagrams.
TEST(Repair, ToLookWhetherSomethingIsDueCostsLittleHoweverMuchIsMissing) {
  RepairedStreams streams([](const std::string&) { return true; });
  for (std::uint32_t sender = 1; sender <= RepairedStreams::kMaxSenders; ++sender) {
    BeatFarAhead(sender, &streams);
  }
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < 20'000; ++i) {
    EXPECT_THAT(streams.Ask(OrderedStream::kGrace - 1), IsEmpty());
    EXPECT_EQ(streams.NextAsk(), OrderedStream::kGrace);
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
  EXPECT_THAT(streams.Ask(OrderedStream::kGrace), ::testing::Not(IsEmpty()));
}

// Whoever calls Ask at NextAsk only misses nothing.
TEST(Repair, WhatIsMissingIsAskedForInTimeAndGivenUp) {
  OrderedStream stream(0, [](const std::string&) { return true; });
  stream.OnBeat(0, 3, 0);
  const char* why = nullptr;
  const Bytes bytes = DatagramOf(SentMessage(1, "A", Bytes(10, 1)), 0);
  EXPECT_TRUE(stream.Add(*ParseDatagram(bytes.data(), bytes.size(), &why), 2'000, &why));
  std::size_t asked = 0;
  Utime now = 0;
  while (const std::optional<Utime> next = stream.NextAsk()) {
    ASSERT_GT(*next, now);
    now = *next;
    for (const MissingParts& part : stream.Ask(now)) asked += part.seq != 1 ? 1 : 100;
  }
  EXPECT_EQ(asked, 2U * OrderedStream::kMaxAsked);
  EXPECT_EQ(stream.given_up(), 2);
  EXPECT_NEAR(static_cast<double>(now), 2.4e6, 0.2e6);
  EXPECT_EQ(stream.Take().size(), 1U);
  EXPECT_EQ(stream.bytes_held(), 0U);
}

TEST(Repair, WhatWaitsBehindAGapIsNotGivenUpWithIt) {
  RepairedStreams streams([](const std::string&) { return true; });
  streams.OnBeat({1, 1}, {7, 0, 0, 0, 0, "x"}, 0, 0);
  const char* why = nullptr;
  for (std::uint32_t seq = 1; seq < 25; ++seq) {  // more than 64 MiB wait for message 0
    const SentMessage message(seq, "A", Bytes(2'900'000, 1));
    for (std::size_t i = 0; i < message.datagrams() - (seq == 23 ? 1 : 0); ++i) {
      const Bytes bytes = DatagramOf(message, i);
      streams.Add({1, 1}, *ParseDatagram(bytes.data(), bytes.size(), &why), 0, &why);
    }
  }
  EXPECT_EQ(streams.report().messages_given_up, 1);
  EXPECT_EQ(streams.Take().size(), 22U);
}

TEST(Repair, WhatIsNotWholeMakesNoMessage) {
  std::mt19937 random(3);
  for (int i = 0; i < 20'000; ++i) {
    Bytes bytes = Noise(random() % 60, &random);
    if (!bytes.empty()) bytes[0] = static_cast<std::uint8_t>("BRDX"[random() % 4]);
    const RepairMessage message = DecodeRepairMessage(bytes.data(), bytes.size());
    RepairedStreams streams([](const std::string&) { return true; });
    streams.OnBeat({1, 1}, {7, 0, 0, 0, 0, "x"}, 0, 0);
    if (const auto* beat = std::get_if<Beat>(&message)) streams.OnBeat({1, 1}, *beat, 0, 0);
    if (const auto* request = std::get_if<RepairRequest>(&message)) {
      streams.OnRequest(*request, 0);
      SentMessages().Repeat(request->parts, 0);
    }
    EXPECT_THAT(streams.Take(), IsEmpty());
  }
  EXPECT_TRUE(std::holds_alternative<std::monostate>(DecodeRepairMessage(nullptr, 0)));
}

TEST(Repair, MessagesAreWhatTheyWere) {
  const Beat beat{0x0123456789abcdef, 7, 9, 1'000'000'000'000, 1'500'000'000'000'000, "sensor"};
  const Bytes encoded = Encode(beat);
  const auto decoded = std::get<Beat>(DecodeRepairMessage(encoded.data(), encoded.size()));
  EXPECT_EQ(decoded.id, beat.id);
  EXPECT_EQ(decoded.oldest, 7U);
  EXPECT_EQ(decoded.next, 9U);
  EXPECT_EQ(decoded.datagrams, beat.datagrams);
  EXPECT_EQ(decoded.host_utime, beat.host_utime);
  EXPECT_EQ(decoded.host, "sensor");
  const Bytes request = Encode(RepairRequest{5, {{3, {}}, {4, {1, 65535}}}});
  const auto parts = std::get<RepairRequest>(DecodeRepairMessage(request.data(), request.size()));
  EXPECT_EQ(parts.id, 5U);
  ASSERT_EQ(parts.parts.size(), 2U);
  EXPECT_THAT(parts.parts[1].fragments, ElementsAre(1, 65535));
}

TEST(Repair, ABeatOfNoTimeIsNone) {
  for (const std::int64_t utime : {std::numeric_limits<std::int64_t>::min(), std::int64_t{-1},
                                   std::numeric_limits<std::int64_t>::max()}) {
    const Bytes encoded = Encode(Beat{1, 0, 0, 0, utime, "x"});
    const RepairMessage message = DecodeRepairMessage(encoded.data(), encoded.size());
    EXPECT_TRUE(std::holds_alternative<std::monostate>(message)) << utime;
  }
}

TEST(Clocks, OfVeryManyBeatsTheNewestCount) {
  constexpr Utime kWall = 1'500'000'000'000'000;
  RepairedStreams streams([](const std::string&) { return true; });
  streams.OnBeat({1, 1}, {7, 0, 0, 0, kWall + 9'000'000, "x"}, 0, kWall);
  for (std::size_t i = 0; i < RepairedStreams::kMaxClockSamples; ++i) {
    streams.OnBeat({1, 1}, {7, 0, 0, 0, kWall, "x"}, 1, kWall);
  }
  ASSERT_EQ(streams.report().clocks.size(), 1U);
  EXPECT_EQ(streams.report().clocks[0].ahead, 0);
}

TEST(Clocks, OtherMachinesClocksAreToldByTheirBeats) {
  RepairedStreams streams([](const std::string&) { return true; });
  constexpr Utime kWall = 1'500'000'000'000'000;
  const auto beat = [&](std::uint32_t address, const char* host, Utime ahead, Utime path,
                        Utime now) {
    streams.OnBeat({address, 1}, {address, 0, 0, 0, kWall + now + ahead - path, host}, now,
                   kWall + now);
  };
  for (int i = 0; i < 5; ++i) {
    const Utime now = i * 1'000'000;
    beat(0x0100000a, "compute", 0, 0, now);
    beat(0x0200000a, "sensor", -200'000, i == 2 ? 1'000 : 60'000, now);  // a busy machine
  }
  std::vector<ClockOffset> clocks = streams.report().clocks;
  ASSERT_EQ(clocks.size(), 2U);
  EXPECT_EQ(clocks[1].host, "sensor (10.0.0.2)");
  EXPECT_EQ(clocks[1].ahead, -201'000);
  EXPECT_THAT(ClockProblems(clocks),
              ElementsAre(HasSubstr("host sensor (10.0.0.2) is 0.20 s behind this machine's")));
  for (int i = 0; i < 5; ++i) beat(0x0300000a, "log", -200'000, 500, 5'000'000 + i);
  EXPECT_THAT(ClockProblems(streams.report().clocks),
              ElementsAre(HasSubstr("host compute (10.0.0.1) is 0.20 s ahead of the others'")));
  EXPECT_THAT(ClockProblems({{"a", 0}, {"b", 15'000}}), IsEmpty());
  EXPECT_THAT(ClockProblems({}), IsEmpty());
}

}  // namespace
}  // namespace rgbdt
