#include "viewer/server/internal/origin.h"

#include <gtest/gtest.h>

#include <boost/asio/ip/host_name.hpp>
#include <string>

#include "viewer/server/internal/net.h"

namespace rgbdt::viewer {
namespace {

TEST(Origin, LoopbackIsKnownUnderItsThreeNames) {
  for (const char* bound : {"127.0.0.1", "::1"}) {
    const HostRule rule = RuleFor(bound, 8080);
    for (const char* host : {"localhost:8080", "127.0.0.1:8080", "[::1]:8080", "LocalHost:8080"}) {
      EXPECT_TRUE(rule.Allows(host)) << bound << " " << host;
    }
  }
}

TEST(Origin, LoopbackIsKnownUnderNoOtherName) {
  const HostRule rule = RuleFor("127.0.0.1", 8080);
  for (const char* host : {"",
                           ":8080",
                           "localhost",
                           "localhost:80",
                           "localhost:8081",
                           "localhost:",
                           "localhost:x",
                           "localhost:8080x",
                           "localhost:+8080",
                           "localhost:108080",
                           "localhost.evil.example:8080",
                           "evil.example:8080",
                           "192.168.0.1:8080",
                           "127.0.0.2:8080",
                           "[::1:8080",
                           "::1:8080",
                           "localhost:8080:8080",
                           "user@localhost:8080",
                           "localhost:8080/",
                           "localhost.:8080"}) {
    EXPECT_FALSE(rule.Allows(host)) << host;
  }
}

TEST(Origin, NoPortIsPort80) {
  const HostRule rule = RuleFor("127.0.0.1", 80);
  EXPECT_TRUE(rule.Allows("localhost"));
  EXPECT_TRUE(rule.Allows("localhost:80"));
  EXPECT_FALSE(rule.Allows("localhost:8080"));
}

// Other sites' names are what an attacker can point here; addresses and this machine's are not.
TEST(Origin, ByTlsTheUsualPortIs443AndTheOriginHttps) {
  const HostRule rule = RuleFor("127.0.0.1", 443, true);
  EXPECT_TRUE(rule.Allows("localhost"));
  EXPECT_FALSE(rule.Allows("localhost:80"));
  EXPECT_TRUE(OriginIsHost("https://localhost:8080", "localhost:8080", true));
  EXPECT_TRUE(OriginIsHost("https://localhost", "localhost:443", true));
  EXPECT_FALSE(OriginIsHost("http://localhost:8080", "localhost:8080", true));
  EXPECT_FALSE(OriginIsHost("https://localhost:8080", "localhost:8080"));
  EXPECT_FALSE(OriginIsHost("https://localhost", "localhost:80", true));
}

TEST(Origin, BeyondLoopbackAddressesAndTheMachinesNameCount) {
  const std::string name = net::ip::host_name();
  for (const char* bound : {"0.0.0.0", "::", "192.168.0.1"}) {
    const HostRule rule = RuleFor(bound, 8080);
    for (const std::string& host :
         {std::string("192.168.0.1"), std::string("[fe80::1]"), std::string("localhost"), name,
          name.substr(0, name.find('.')) + ".local"}) {
      EXPECT_TRUE(rule.Allows(host + ":8080")) << bound << " " << host;
      EXPECT_FALSE(rule.Allows(host + ":8081")) << bound << " " << host;
    }
    EXPECT_FALSE(rule.Allows("evil.example:8080")) << bound;
    EXPECT_FALSE(rule.Allows(name + ".evil.example:8080")) << bound;
    EXPECT_FALSE(rule.Allows("192.168.0.1.evil.example:8080")) << bound;
  }
}

TEST(Origin, OnlyThatHostsOwnOriginIsItsOwn) {
  EXPECT_TRUE(OriginIsHost("http://localhost:8080", "localhost:8080"));
  EXPECT_TRUE(OriginIsHost("http://[::1]:8080", "[::1]:8080"));
  EXPECT_TRUE(OriginIsHost("http://localhost", "localhost:80"));
  for (const char* origin :
       {"", "null", "localhost:8080", "https://localhost:8080", "http://localhost",
        "http://127.0.0.1:8080", "http://localhost:8081", "http://evil.example:8080",
        "http://localhost:8080/", "http://localhost:8080.evil.example", "http://",
        "http://x@localhost:8080", "file://localhost:8080"}) {
    EXPECT_FALSE(OriginIsHost(origin, "localhost:8080")) << origin;
  }
}

}  // namespace
}  // namespace rgbdt::viewer
