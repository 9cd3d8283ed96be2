#include <gmock/gmock.h>

#include <cerrno>

#include "tests/unit/doctor/doctor_testing.h"

namespace rgbdt {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr std::uint32_t kGroup = 0xefff4c43;  // 239.255.76.67

MulticastFacts GoodMulticast() {
  MulticastFacts facts;
  facts.group = kGroup;
  facts.route.interface = "lo";
  facts.interface = NetworkInterface{"lo", 1, true, true, true, 65536, {}};
  facts.loopback_up = true;
  facts.came_back = true;
  return facts;
}

TEST(DoctorMachine, ABufferThatHoldsLessThanLargeMessages) {
  EXPECT_THAT(CheckBuffer({33554432, false}), Is(kOk));
  EXPECT_THAT(CheckBuffer({33554431, false}),
              Says(kProblem, "33554431 bytes", "sudo sysctl -w net.core.rmem_max=33554432"));
  EXPECT_THAT(CheckBuffer({212992, true}), Says(kProblem, "lost", "# on the host"));
}

TEST(DoctorMachine, MulticastWithoutARoute) {
  EXPECT_THAT(CheckMulticast(GoodMulticast()), Is(kOk));
  MulticastFacts facts;
  facts.group = kGroup;
  facts.route.error = ENETUNREACH;
  facts.loopback_up = true;
  EXPECT_EQ(CheckMulticast(facts).fix,
            "sudo ip route add 239.0.0.0/8 dev lo; sudo ip link set lo multicast on");
  facts.loopback_up = false;
  EXPECT_THAT(CheckMulticast(facts), Says(kProblem, "unreachable", "sudo ip link set lo up; "));
  facts.group = 0xe0010203;
  EXPECT_THAT(CheckMulticast(facts), Says(kProblem, "224.1.2.3", "route add 224.1.2.3/32"));
}

TEST(DoctorMachine, MulticastThatIsSwitchedOffOrDoesNotComeBack) {
  MulticastFacts facts = GoodMulticast();
  facts.interface->multicast = false;
  EXPECT_THAT(CheckMulticast(facts), Says(kWarning, "lo", "sudo ip link set lo multicast on"));
  facts.came_back = false;
  EXPECT_THAT(CheckMulticast(facts), Is(kProblem));
  facts.interface->multicast = true;
  EXPECT_THAT(CheckMulticast(facts), Says(kProblem, "firewall", "nft"));
}

TEST(DoctorMachine, WhereTheBusesMessagesGo) {
  Route by_cable;
  by_cable.interface = "eth0";
  Route by_loopback;
  by_loopback.interface = "lo";
  EXPECT_THAT(CheckBusUrl(ParseBusUrl("udpm://"), by_cable), ElementsAre(Is(kOk)));
  EXPECT_THAT(CheckBusUrl(ParseBusUrl("udpm://?ttl=1"), by_cable),
              ElementsAre(Says(kWarning, "go out by eth0", "ttl=0")));
  EXPECT_THAT(CheckBusUrl(ParseBusUrl("udpm://?ttl=1"), by_loopback),
              ElementsAre(Says(kWarning, "hear nothing", "ip route replace 239.255.76.67/32")));
  EXPECT_THAT(CheckBusUrl(ParseBusUrl("udpm://?recv_buf_size=1000"), by_cable),
              ElementsAre(Says(kWarning, "recv_buf_size=1000", "leave"), Is(kOk)));
  EXPECT_THAT(CheckBusUrl(ParseBusUrl("tcpq://"), by_cable),
              ElementsAre(Says(kProblem, "\"tcpq://\"", "LCM_DEFAULT_URL=")));
}

TEST(DoctorMachine, ClockAndDisk) {
  EXPECT_THAT(CheckClock({true, false}), Is(kOk));
  EXPECT_EQ(CheckClock({false, false}).fix, "sudo timedatectl set-ntp true");
  EXPECT_THAT(CheckClock({false, true}), Says(kWarning, "not sync", "# on the host"));
  EXPECT_THAT(CheckDisk({"/data", 2'000'000'000}), Is(kOk));
  EXPECT_THAT(CheckDisk({"/data", 1'900'000'000}), Says(kWarning, "1.9 GB free in /data", "du "));
  EXPECT_THAT(CheckDisk({"/data", 50'000'000}), Is(kProblem));
  EXPECT_THAT(CheckDisk({"/data", -1}), Is(kWarning));
}

TEST(DoctorMachine, DatagramsThatLackedAPiece) {
  EXPECT_THAT(CheckReassembly(0), Is(kOk));
  EXPECT_THAT(CheckReassembly(12), Says(kWarning, "12 datagrams", "nstat -az IpReasmFails"));
}

TEST(DoctorFinding, ProblemsComeLastWhereTheEyeIs) {
  const Findings findings{Problem("a", "is broken", "fix it"), Ok("b", "is well"),
                          Warning("c", "is old"), Ok("d", "is well")};
  EXPECT_EQ(FindingsText(findings),
            "ok       b: is well\nok       d: is well\nWARNING  c: is old\n"
            "PROBLEM  a: is broken\n  fix: fix it\n1 problem, 1 warning\n");
  EXPECT_TRUE(HasProblem(findings));
  EXPECT_FALSE(HasProblem({Ok("b", ""), Warning("c", "")}));
  EXPECT_THAT(FindingsText({}), HasSubstr("0 problems, 0 warnings"));
}

}  // namespace
}  // namespace rgbdt
