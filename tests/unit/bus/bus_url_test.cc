#include "services/bus/bus_url.h"

#include <gmock/gmock.h>

namespace rgbdt {
namespace {

using ::testing::HasSubstr;

TEST(BusUrl, ReadsWhatLcmReads) {
  const BusUrl url = ParseBusUrl("udpm://239.1.2.3:8000?ttl=2&recv_buf_size=1000");
  EXPECT_EQ(url.error, "");
  EXPECT_EQ(url.group, 0xef010203u);
  EXPECT_EQ(url.port, 8000);
  EXPECT_EQ(url.ttl, 2);
  EXPECT_EQ(url.buffer_bytes, 1000);
}

TEST(BusUrl, HasLcmsDefaults) {
  for (const char* text : {"udpm://", "udpm://?", "udpm://239.255.76.67", "udpm://:7667"}) {
    const BusUrl url = ParseBusUrl(text);
    EXPECT_EQ(url.error, "") << text;
    EXPECT_EQ(url.group, 0xefff4c43u) << text;
    EXPECT_EQ(url.port, 7667) << text;
    EXPECT_EQ(url.ttl, 0) << text;
    EXPECT_LT(url.buffer_bytes, 0) << text;
  }
}

TEST(BusUrl, NamesWhatIsWrong) {
  const auto error = [](const std::string& text) { return ParseBusUrl(text).error; };
  EXPECT_THAT(error(""), HasSubstr("udpm://"));
  EXPECT_THAT(error("239.255.76.67:7667"), HasSubstr("udpm://"));
  EXPECT_THAT(error("udpm://192.168.0.1:7667"), HasSubstr("\"192.168.0.1\" is no multicast"));
  EXPECT_THAT(error("udpm://239.255.76.67:"), HasSubstr("the port is \"\""));
  EXPECT_THAT(error("udpm://239.255.76.67:65536"), HasSubstr("1 to 65535"));
  EXPECT_THAT(error("udpm://:99999999999999999999"), HasSubstr("the port"));
  EXPECT_THAT(error("udpm://?ttl=-1"), HasSubstr("ttl is \"-1\""));
  EXPECT_THAT(error("udpm://?ttl"), HasSubstr("ttl is \"\""));
  EXPECT_THAT(error("udpm://?hops=1"), HasSubstr("no option \"hops\""));
}

}  // namespace
}  // namespace rgbdt
