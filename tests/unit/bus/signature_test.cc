#include "services/bus/signature.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <random>

#include "services/messages/codec.h"
#include "tests/numbers.h"
#include "tests/unit/bus/bus_key.h"

namespace rgbdt {
namespace {

using ::testing::HasSubstr;

class SignatureTest : public ::testing::Test {
 protected:
  Bytes Signed(const std::string& channel = "SESSION_COMMAND", Utime now = kNow) {
    SessionCommand command;
    command.verb = SessionVerb::kSweep;
    command.view = "0001";
    Bytes message = Encode(command);
    signer_.Sign(channel, now, &message);
    return message;
  }
  std::string WhyNot(const Bytes& message, Utime arrived = kNow,
                     const std::string& channel = "SESSION_COMMAND") {
    return check_.WhyNot(channel, message.data(), message.size(), arrived);
  }

  MessageSigner signer_{KeyOf(1)};
  SignatureCheck check_{KeyOf(1)};
};

TEST_F(SignatureTest, WhatWasSignedIsTakenOnce) {
  const Bytes message = Signed();
  EXPECT_EQ(WhyNot(message), "");
  EXPECT_THAT(WhyNot(message), HasSubstr("sent once more"));
}

TEST_F(SignatureTest, TheMessageIsAsItWasBeforeIt) {
  SessionCommand command;
  command.verb = SessionVerb::kSweep;
  command.view = "0001";
  const Bytes plain = Encode(command);
  const Bytes message = Signed();
  ASSERT_EQ(message.size(), plain.size() + kSignatureBytes);
  EXPECT_EQ(std::memcmp(message.data(), plain.data(), plain.size()), 0);
  EXPECT_EQ(SizeWithoutSignature("SESSION_COMMAND", message.data(), message.size()), plain.size());
  const Message decoded = Decode("SESSION_COMMAND", message.data(), message.size());
  EXPECT_EQ(Encode(decoded), plain) << "whoever has no key decodes it, too";
}

// Bytes put together by hand, their tag by Python: hashlib's BLAKE2b, and XChaCha20 and Poly1305
// written down from their specifications. A program that is not ours can sign by signature.h alone.
TEST_F(SignatureTest, TheTagIsWhatTheHeaderSays) {
  Signature signature;
  signature.sender = 0x0102030405060708;
  signature.number = 9;
  signature.utime = 1'700'000'000'000'000;
  const std::string tag = "ec2ffea2178a2dcd951c9ab90493000a";
  for (std::size_t i = 0; i < sizeof(signature.tag); ++i) {
    signature.tag[i] = static_cast<std::uint8_t>(std::stoi(tag.substr(2 * i, 2), nullptr, 16));
  }
  Bytes message = {1, 2, 3};
  AppendSignature(signature, &message);
  ASSERT_EQ(message.size(), 3 + kSignatureBytes);
  EXPECT_EQ(std::string(message.end() - 8, message.end()), "RGBDTSG1");
  EXPECT_EQ(SignatureCheck(KeyOf(7)).WhyNot("RIG", message.data(), message.size(),
                                            signature.utime + kSecond),
            "");
}

TEST_F(SignatureTest, UnsignedIsRefused) {
  const Bytes plain = Encode(SessionCommand{0, 0, 1, SessionVerb::kReset, "", 0, false, {}});
  EXPECT_THAT(WhyNot(plain), HasSubstr("not signed"));
  EXPECT_THAT(WhyNot({}), HasSubstr("not signed"));
}

// Who has the key may be wrong, too: no number or time of a signature may count as another one.
TEST_F(SignatureTest, AStampThatCannotBeIsRefused) {
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  ChannelKeys keys(KeyOf(1));
  const auto why_not = [&](std::int64_t number, Utime utime) {
    Signature signature{5, number, utime, {}};
    Bytes message;
    AppendSignature(signature, &message);
    std::uint8_t tag[sizeof(Signature::tag)];
    keys.Tag("RIG", message.data(), 0, tag);
    std::copy(std::begin(tag), std::end(tag), message.begin() + kStampBytes);
    return WhyNot(message, kNow, "RIG");
  };
  for (const std::int64_t value : {std::int64_t{-1}, -kMost, -kMost - 1, kMost}) {
    EXPECT_THAT(why_not(value, kNow), HasSubstr("cannot be")) << value;
    EXPECT_THAT(why_not(0, value), HasSubstr("cannot be")) << value;
  }
  EXPECT_EQ(why_not(0, kNow), "");
}

TEST_F(SignatureTest, EveryBitCounts) {
  const Bytes message = Signed();
  for (std::size_t bit = 0; bit < 8 * message.size(); ++bit) {
    Bytes forged = message;
    forged[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
    EXPECT_NE(WhyNot(forged), "") << "bit " << bit;
  }
  EXPECT_EQ(WhyNot(message), "") << "what is forged does not use up the true one's number";
}

TEST_F(SignatureTest, AnythingCutOrAddedIsRefused) {
  const Bytes message = Signed();
  for (std::size_t size = 0; size < message.size(); ++size) {
    EXPECT_NE(WhyNot(Bytes(message.begin(), message.begin() + static_cast<long>(size))), "");
    EXPECT_NE(
        WhyNot(Bytes(message.begin() + static_cast<long>(message.size() - size), message.end())),
        "");
  }
  Bytes longer = message;
  longer.insert(longer.begin(), 0);
  EXPECT_NE(WhyNot(longer), "");
}

TEST_F(SignatureTest, AnotherKeyIsRefused) {
  SignatureCheck other(KeyOf(2));
  const Bytes message = Signed();
  EXPECT_THAT(other.WhyNot("SESSION_COMMAND", message.data(), message.size(), kNow),
              HasSubstr("another key"));
}

TEST_F(SignatureTest, AnotherChannelIsRefused) {
  EXPECT_THAT(WhyNot(Signed("SESSION_REQUEST")), HasSubstr("another key, or was changed"));
}

TEST_F(SignatureTest, RecordingsAreRefused) {
  const Bytes message = Signed();
  EXPECT_THAT(WhyNot(message, kNow + 11 * kSecond), HasSubstr("signed 11 s ago"));
  EXPECT_THAT(WhyNot(message, kNow - 11 * kSecond), HasSubstr("11 s ahead"));
  EXPECT_EQ(WhyNot(message, kNow + 9 * kSecond), "");
  Bytes far = Signed("SESSION_COMMAND", -kNow);
  EXPECT_NE(WhyNot(far), "");
}

TEST_F(SignatureTest, ReorderedOnesAreTakenOnceEach) {
  std::vector<Bytes> messages;
  for (int i = 0; i < 60; ++i) messages.push_back(Signed());
  std::shuffle(messages.begin(), messages.end(), std::mt19937(3));
  for (const Bytes& message : messages) EXPECT_EQ(WhyNot(message), "");
  for (const Bytes& message : messages) EXPECT_THAT(WhyNot(message), HasSubstr("once more"));
}

TEST_F(SignatureTest, WhatComesAfter64LaterOnesIsRefused) {
  const Bytes late = Signed();
  for (int i = 0; i < 64; ++i) EXPECT_EQ(WhyNot(Signed()), "");
  EXPECT_THAT(WhyNot(late), HasSubstr("came before"));
}

// Whose numbers are forgotten can no longer be in time.
TEST_F(SignatureTest, WhatIsRememberedIsBounded) {
  std::vector<Bytes> kept;
  Utime now = kNow;
  for (int i = 0; i < 300; ++i, now += kSecond) {
    MessageSigner signer(KeyOf(1));
    Bytes message = {0};
    signer.Sign("RIG", now, &message);
    EXPECT_EQ(WhyNot(message, now, "RIG"), "");
    kept.push_back(message);
    for (const Bytes& old : kept) EXPECT_NE(WhyNot(old, now, "RIG"), "");
  }
  EXPECT_LE(check_.senders(), 24U);
}

TEST_F(SignatureTest, TwoSendersDoNotDisturbEachOther) {
  MessageSigner second(KeyOf(1));
  for (int i = 0; i < 3; ++i) {
    Bytes message = {0};
    second.Sign("SESSION_COMMAND", kNow, &message);
    EXPECT_EQ(WhyNot(Signed()), "");
    EXPECT_EQ(WhyNot(message), "");
  }
}

TEST(SignedChannels, SensorsAreNot) {
  for (const Message& message :
       {Message(SessionCommand()), Message(SessionRequest()), Message(RigText()),
        Message(CalibrationMessage()), Message(LeftOutViews()), Message(CornerSelection()),
        Message(ViewDetection()), Message(SessionEvent()), Message(MountCheck()),
        Message(WaveProgress()), Message(ReportText()), Message(Status())}) {
    EXPECT_TRUE(IsSignedChannel(ChannelOf(message))) << ChannelOf(message);
  }
  Image image;
  image.camera = "rgb";
  for (const Message& message :
       {Message(LineScan()), Message(EncoderReading()), Message(CloudChunk()),
        Message(RgbdtCloud()), Message(StampedPose()), Message(TargetStatus()), Message(image)}) {
    EXPECT_FALSE(IsSignedChannel(ChannelOf(message))) << ChannelOf(message);
  }
}

}  // namespace
}  // namespace rgbdt
