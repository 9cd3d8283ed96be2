#include "services/drivers/net/tcp_probe.h"

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include "calib/model/descriptor.h"

namespace rgbdt {
namespace {

// A socket on a port of the loopback that the kernel chooses.
struct Local {
  Local() : tcp(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in in{};
    in.sin_family = AF_INET;
    in.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof in;
    auto* address = reinterpret_cast<sockaddr*>(&in);
    EXPECT_EQ(bind(tcp.get(), address, size), 0);
    getsockname(tcp.get(), address, &size);
    port = ntohs(in.sin_port);
  }
  Descriptor tcp;
  int port = 0;
};

TEST(TcpProbe, TellsWhoListensFromWhoDoesNot) {
  const Local local;
  EXPECT_EQ(ProbeTcp("127.0.0.1", local.port), TcpAnswer::kRefused);
  ASSERT_EQ(listen(local.tcp.get(), 1), 0);
  EXPECT_EQ(ProbeTcp("127.0.0.1", local.port), TcpAnswer::kConnected);
}

TEST(TcpProbe, GivesUpWhereNobodyAnswers) {
  const Local local;
  ASSERT_EQ(listen(local.tcp.get(), 0), 0);
  EXPECT_EQ(ProbeTcp("127.0.0.1", local.port), TcpAnswer::kConnected);
  // Nobody accepts: once the queue is full the kernel leaves who calls without an answer.
  TcpAnswer answer = TcpAnswer::kConnected;
  for (int i = 0; i < 8 && answer == TcpAnswer::kConnected; ++i) {
    answer = ProbeTcp("127.0.0.1", local.port, 50);
  }
  EXPECT_EQ(answer, TcpAnswer::kTimedOut);
}

TEST(TcpProbe, KnowsNoSuchAddress) {
  EXPECT_EQ(ProbeTcp("192.168.0.10.10", 10940), TcpAnswer::kBadAddress);
  EXPECT_EQ(ProbeTcp("the scanner", 10940), TcpAnswer::kBadAddress);
}

}  // namespace
}  // namespace rgbdt
