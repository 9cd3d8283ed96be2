#include "services/drivers/net/network_interfaces.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace rgbdt {
namespace {

TEST(NetworkInterfaces, AddressesAreNumbers) {
  std::uint32_t address = 0;
  ASSERT_TRUE(ParseAddress("192.168.7.20", &address));
  EXPECT_EQ(address, 0xc0a80714u);
  EXPECT_EQ(AddressText(address), "192.168.7.20");
  EXPECT_FALSE(ParseAddress("192.168.7", &address));
  EXPECT_FALSE(ParseAddress("", &address));
  EXPECT_EQ(PrefixLength(0xffff0000), 16);
  EXPECT_TRUE(SameSubnet(0xc0a80714, 0xc0a80701, 0xffffff00));
  EXPECT_FALSE(SameSubnet(0xc0a80714, 0xc0a80601, 0xffffff00));
}

TEST(NetworkInterfaces, HasTheLoopback) {
  const std::vector<NetworkInterface> all = ListInterfaces();
  const auto loopback = std::find_if(all.begin(), all.end(),
                                     [](const auto& interface) { return interface.loopback; });
  ASSERT_NE(loopback, all.end());
  EXPECT_EQ(loopback->name, "lo");
  EXPECT_GT(loopback->index, 0);
  EXPECT_GT(loopback->mtu, 0);
  if (!loopback->up) GTEST_SKIP() << "the loopback is down";
  EXPECT_EQ(RouteTo(0x7f000001).interface, "lo");
  EXPECT_EQ(RouteTo(0x7f000001).error, 0);
}

}  // namespace
}  // namespace rgbdt
