#include "services/drivers/dynamixel/dynamixel_protocol.h"

#include <gmock/gmock.h>

#include <random>

#include "services/drivers/dynamixel/dynamixel_models.h"
#include "services/drivers/dynamixel/round_trips.h"
#include "tests/hardware/dynamixel_peer.h"

namespace rgbdt {
namespace {

using dynamixel::Bytes;
using dynamixel::StatusDecoder;
using test::PeerStatusPacket;
using test::PeerTakeInstruction;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// The examples printed in the e-Manual, "DYNAMIXEL Protocol 2.0", Ping, Read and Write.
const Bytes kPing = {0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x03, 0x00, 0x01, 0x19, 0x4E};
const Bytes kPong = {0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x07, 0x00,
                     0x55, 0x00, 0x06, 0x04, 0x26, 0x65, 0x5D};
const Bytes kPongOf2 = {0xFF, 0xFF, 0xFD, 0x00, 0x02, 0x07, 0x00,
                        0x55, 0x00, 0x06, 0x04, 0x26, 0x6F, 0x6D};
const Bytes kRead = {0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x07, 0x00,
                     0x02, 0x84, 0x00, 0x04, 0x00, 0x1D, 0x15};
const Bytes kReadAnswer = {0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x08, 0x00, 0x55,
                           0x00, 0xA6, 0x00, 0x00, 0x00, 0x8C, 0xC0};
const Bytes kWrite = {0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x09, 0x00, 0x03,
                      0x74, 0x00, 0x00, 0x02, 0x00, 0x00, 0xCA, 0x89};
const Bytes kWriteAnswer = {0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x04, 0x00, 0x55, 0x00, 0xA1, 0x0C};

Bytes Joined(const std::vector<Bytes>& parts) {
  Bytes all;
  for (const Bytes& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

// Bytes of which headers and stuffing are made.
Bytes Tricky(std::size_t size, std::mt19937* random) {
  constexpr std::uint8_t kBytes[] = {0xFF, 0xFF, 0xFD, 0x00, 0x55};
  Bytes bytes;
  for (std::size_t i = 0; i < size; ++i) bytes.push_back(kBytes[(*random)() % 5]);
  return bytes;
}

TEST(DynamixelProtocol, EncodesThePublishedInstructions) {
  EXPECT_EQ(dynamixel::EncodePing(1), kPing);
  EXPECT_EQ(dynamixel::EncodeRead(1, 132, 4), kRead);
  EXPECT_EQ(dynamixel::EncodeWrite(1, 116, dynamixel::ToBytes(512, 4)), kWrite);
}

TEST(DynamixelProtocol, DecodesThePublishedAnswers) {
  StatusDecoder decoder;
  decoder.Add(Joined({kPong, kPongOf2, kReadAnswer, kWriteAnswer}));
  const auto pong = decoder.Next();
  ASSERT_TRUE(pong);
  EXPECT_EQ(pong->id, 1);
  EXPECT_EQ(pong->error, 0);
  EXPECT_THAT(pong->parameters, ElementsAre(0x06, 0x04, 0x26));
  EXPECT_EQ(pong->wire_size, kPong.size());
  const auto second = decoder.Next();
  ASSERT_TRUE(second);
  EXPECT_EQ(second->id, 2);
  const auto read = decoder.Next();
  ASSERT_TRUE(read);
  EXPECT_EQ(dynamixel::SignedFrom(read->parameters), 166);
  const auto write = decoder.Next();
  ASSERT_TRUE(write);
  EXPECT_TRUE(write->parameters.empty());
  EXPECT_FALSE(decoder.Next());
  EXPECT_EQ(decoder.bad_checksums(), 0);
}

// The peer is the judge of the other tests: it has to agree with the manual, too.
TEST(DynamixelProtocol, ThePeerSpeaksAsPublished) {
  EXPECT_EQ(PeerStatusPacket(1, 0, {0x06, 0x04, 0x26}), kPong);
  EXPECT_EQ(PeerStatusPacket(2, 0, {0x06, 0x04, 0x26}), kPongOf2);
  EXPECT_EQ(PeerStatusPacket(1, 0, {0xA6, 0, 0, 0}), kReadAnswer);
  EXPECT_EQ(PeerStatusPacket(1, 0, {}), kWriteAnswer);
  Bytes stream = Joined({kPing, kRead, kWrite});
  const auto ping = PeerTakeInstruction(&stream);
  ASSERT_TRUE(ping);
  EXPECT_EQ(ping->instruction, 1);
  const auto read = PeerTakeInstruction(&stream);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->instruction, 2);
  EXPECT_THAT(read->parameters, ElementsAre(0x84, 0, 4, 0));
  const auto write = PeerTakeInstruction(&stream);
  ASSERT_TRUE(write);
  EXPECT_EQ(write->instruction, 3);
  EXPECT_THAT(write->parameters, ElementsAre(0x74, 0, 0, 2, 0, 0));
  EXPECT_TRUE(stream.empty());
}

TEST(DynamixelProtocol, StuffsWhatLooksLikeAHeader) {
  const Bytes packet = dynamixel::EncodeWrite(1, 0, {0xFF, 0xFF, 0xFD, 0x00});
  EXPECT_EQ(packet.size(), 7u + 3 + 4 + 1 + 2);
  EXPECT_EQ(packet[5], 10);  // the length counts it
  EXPECT_EQ(packet[13], 0xFD);
}

TEST(DynamixelProtocol, StuffingIsUndoneByTheOtherSide) {
  std::mt19937 random(1);
  for (std::size_t i = 0; i < 2000; ++i) {
    const Bytes data = Tricky(i % 24, &random);
    StatusDecoder decoder;
    decoder.Add(PeerStatusPacket(3, 0x80, data));
    const auto status = decoder.Next();
    ASSERT_TRUE(status);
    ASSERT_EQ(status->parameters, data);
    Bytes stream = dynamixel::EncodeWrite(3, 596, data);
    const auto instruction = PeerTakeInstruction(&stream);
    ASSERT_TRUE(instruction);
    ASSERT_EQ(Bytes(instruction->parameters.begin() + 2, instruction->parameters.end()), data);
  }
}

TEST(DynamixelProtocol, DecodesHoweverTheBytesAreSplit) {
  const Bytes stream = Joined({{0xFF, 0x00}, kPong, {0xFF, 0xFF, 0xFD}, kReadAnswer});
  for (std::size_t first = 0; first <= stream.size(); ++first) {
    StatusDecoder decoder;
    const auto cut = stream.begin() + static_cast<std::ptrdiff_t>(first);
    int found = 0;
    decoder.Add(Bytes(stream.begin(), cut));
    while (decoder.Next()) ++found;
    decoder.Add(Bytes(cut, stream.end()));
    while (decoder.Next()) ++found;
    EXPECT_EQ(found, 2) << "cut after " << first << " bytes";
  }
}

TEST(DynamixelProtocol, FindsAnswersAmongRubbish) {
  std::mt19937 random(2);
  for (std::size_t i = 0; i < 500; ++i) {
    Bytes rubbish = Tricky(i % 40, &random);
    // Rubbish that is a header by itself may claim the bytes after it.
    for (std::uint8_t& byte : rubbish) byte = byte == 0x00 ? 0x12 : byte;
    StatusDecoder decoder;
    decoder.Add(rubbish);
    decoder.Add(kReadAnswer);
    const auto status = decoder.Next();
    ASSERT_TRUE(status);
    EXPECT_EQ(dynamixel::SignedFrom(status->parameters), 166);
  }
}

TEST(DynamixelProtocol, CountsBadChecksumsAndGoesOn) {
  Bytes damaged = kReadAnswer;
  damaged[9] ^= 0x10;
  StatusDecoder decoder;
  decoder.Add(Joined({damaged, kReadAnswer}));
  const auto status = decoder.Next();
  ASSERT_TRUE(status);
  EXPECT_EQ(dynamixel::SignedFrom(status->parameters), 166);
  EXPECT_EQ(decoder.bad_checksums(), 1);
}

TEST(DynamixelProtocol, FindsThePacketAfterOneThatBrokeOff) {
  StatusDecoder decoder;
  decoder.Add(Joined({Bytes(kReadAnswer.begin(), kReadAnswer.begin() + 9), kReadAnswer}));
  ASSERT_TRUE(decoder.Next());
  EXPECT_EQ(decoder.bad_checksums(), 1);
}

TEST(DynamixelProtocol, HeedsNoEchoAndNoImpossibleLength) {
  StatusDecoder decoder;
  decoder.Add(Joined({kPing, {0xFF, 0xFF, 0xFD, 0x00, 0x01, 0xFF, 0xFF}, kWriteAnswer}));
  ASSERT_TRUE(decoder.Next());
  EXPECT_FALSE(decoder.Next());
  EXPECT_EQ(decoder.bad_checksums(), 0);
}

TEST(DynamixelProtocol, NumbersAreTwosComplement) {
  for (const std::int64_t value : {std::int64_t{0}, std::int64_t{-1}, std::int64_t{250961},
                                   std::int64_t{-2147483648}, std::int64_t{2147483647}}) {
    EXPECT_EQ(dynamixel::SignedFrom(dynamixel::ToBytes(value, 4)), value);
  }
  EXPECT_EQ(dynamixel::UnsignedFrom({0x08, 0xD3}), 54024);
}

TEST(DynamixelProtocol, SaysErrorsInWords) {
  dynamixel::Status status;
  status.error = 0x86;
  EXPECT_TRUE(status.alert());
  EXPECT_THAT(dynamixel::ErrorInWords(status.ErrorNumber()), HasSubstr("limit"));
  EXPECT_EQ(dynamixel::HardwareErrorInWords(0x24), "overheating, overload");
}

TEST(DynamixelModels, KnowsOnlyWhatIsInTheManual) {
  ASSERT_NE(dynamixel::FindModel(54024), nullptr);
  EXPECT_STREQ(dynamixel::FindModel(54024)->name, "H54-200-S500-R");
  EXPECT_EQ(dynamixel::FindModel(1020)->table->present_position.address, 132);
  EXPECT_EQ(dynamixel::FindModel(350), nullptr);  // XL-320: a table of its own
}

TEST(RoundTrips, TellsUnusualOnesAndGetsUsedToASlowLine) {
  RoundTrips trips;
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(trips.IsUnusual(500 + i));
  EXPECT_TRUE(trips.IsUnusual(5000));
  EXPECT_TRUE(trips.IsUnusual(100));
  std::size_t unusual = 0;
  while (unusual < 2 * RoundTrips::kKept && trips.IsUnusual(3000)) ++unusual;
  EXPECT_LT(unusual, RoundTrips::kKept);
}

}  // namespace
}  // namespace rgbdt
