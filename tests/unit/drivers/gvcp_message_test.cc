#include "services/drivers/camera/gvcp_message.h"

#include <gmock/gmock.h>

#include <algorithm>

namespace rgbdt {
namespace {

using ::testing::ElementsAre;
using Bytes = std::vector<std::uint8_t>;

constexpr std::uint16_t kId = 0x1234;

void Put(const std::string& text, std::size_t at, Bytes* bytes) {
  std::copy(text.begin(), text.end(), bytes->begin() + static_cast<std::ptrdiff_t>(at));
}

// A discovery's answer, each value where GigE Vision has it behind the header's 8 bytes.
Bytes DiscoveryAnswer() {
  Bytes bytes(8 + 248);
  Put(std::string("\0\0\0\x03\0\xf8\x12\x34", 8), 0, &bytes);
  Put(std::string("\0\x11\x1c\0\xab\xcd", 6), 8 + 10, &bytes);
  Put("\xc0\xa8\x07\x14", 8 + 36, &bytes);
  Put(std::string("\xff\xff\xff\0", 4), 8 + 52, &bytes);
  Put("\xc0\xa8\x07\x01", 8 + 68, &bytes);
  Put("Acme", 8 + 72, &bytes);
  Put("Fieldcam\x1b[2J", 8 + 104, &bytes);
  Put("0123456789abcdef", 8 + 216, &bytes);  // fills its place, no zero behind
  Put("left", 8 + 232, &bytes);
  return bytes;
}

TEST(GvcpMessage, AsksAsGigEVisionDoes) {
  EXPECT_THAT(MakeGvcpDiscovery(kId), ElementsAre(0x42, 0x11, 0, 2, 0, 0, 0x12, 0x34));
  EXPECT_THAT(MakeGvcpReadRegister(kId, kGvcpControlPrivilege),
              ElementsAre(0x42, 0x01, 0, 0x80, 0, 4, 0x12, 0x34, 0, 0, 0x0a, 0));
}

TEST(GvcpMessage, ReadsWhoAnswers) {
  const auto device = ParseGvcpDiscovery(DiscoveryAnswer(), kId);
  ASSERT_TRUE(device.has_value());
  EXPECT_EQ(device->address, 0xc0a80714u);
  EXPECT_EQ(device->mask, 0xffffff00u);
  EXPECT_EQ(device->gateway, 0xc0a80701u);
  EXPECT_EQ(device->mac, "00:11:1c:00:ab:cd");
  EXPECT_EQ(device->vendor, "Acme");
  EXPECT_EQ(device->model, "Fieldcam?[2J") << "what a terminal obeys";
  EXPECT_EQ(device->serial, "0123456789abcdef");
  EXPECT_EQ(device->user_name, "left");
}

TEST(GvcpMessage, CallsACameraWithoutSerialNumberByItsMac) {
  Bytes bytes = DiscoveryAnswer();
  bytes[8 + 216] = 0;
  EXPECT_EQ(ParseGvcpDiscovery(bytes, kId)->serial, "00:11:1c:00:ab:cd");
}

TEST(GvcpMessage, TakesNoOtherAnswer) {
  EXPECT_FALSE(ParseGvcpDiscovery(DiscoveryAnswer(), kId + 1)) << "to another question";
  for (const std::size_t wrong : {0, 1, 3, 4, 5}) {
    Bytes bytes = DiscoveryAnswer();
    bytes[wrong] ^= 0x80;
    EXPECT_FALSE(ParseGvcpDiscovery(bytes, kId)) << "byte " << wrong;
  }
  const Bytes whole = DiscoveryAnswer();
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_FALSE(ParseGvcpDiscovery(cut, kId)) << size << " bytes";
    EXPECT_FALSE(ParseGvcpRegister(cut, kId)) << size << " bytes";
  }
}

TEST(GvcpMessage, ReadsARegisterAndItsRefusal) {
  const auto read = ParseGvcpRegister({0, 0, 0, 0x81, 0, 4, 0x12, 0x34, 1, 2, 3, 4}, kId);
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->status, 0);
  EXPECT_EQ(read->value, 0x01020304u);
  const auto refused = ParseGvcpRegister({0x80, 6, 0, 0x81, 0, 0, 0x12, 0x34}, kId);
  ASSERT_TRUE(refused.has_value());
  EXPECT_EQ(refused->status, 0x8006);
  EXPECT_FALSE(ParseGvcpRegister({0, 0, 0, 0x81, 0, 0, 0x12, 0x34}, kId)) << "no value";
}

}  // namespace
}  // namespace rgbdt
