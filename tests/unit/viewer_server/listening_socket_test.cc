#include "viewer/server/listening_socket.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

#include "calib/model/descriptor.h"
#include "calib/model/errors.h"
#include "test_browser.h"
#include "viewer/server/internal/acceptor.h"

namespace rgbdt::viewer {
namespace {

using testing::AllOf;
using testing::HasSubstr;

template <typename Function>
std::string ErrorOf(const Function& function) {
  try {
    function();
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

// On a free port of 127.0.0.1.
Descriptor ListeningSocket() {
  Descriptor made(socket(AF_INET, SOCK_STREAM, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  EXPECT_EQ(bind(made.get(), reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
  EXPECT_EQ(listen(made.get(), 5), 0);
  return made;
}

TEST(ListeningSocket, PortInUseSaysWhatToDo) {
  net::io_context io;
  const tcp::acceptor first = ListenAt(&io, "127.0.0.1", 0);
  const int port = first.local_endpoint().port();
  EXPECT_EQ(ErrorOf([&] { ListenAt(&io, "127.0.0.1", port); }),
            "127.0.0.1:" + std::to_string(port) +
                " is in use; another rgbdt-viewer? use --listen 127.0.0.1:" +
                std::to_string(port == 65535 ? 8080 : port + 1));
}

TEST(ListeningSocket, AnotherMachinesAddressIsRefused) {
  net::io_context io;
  EXPECT_EQ(ErrorOf([&] { ListenAt(&io, "192.0.2.1", 8080); }),
            "192.0.2.1 is no address of this machine; use --listen 127.0.0.1:8080");
}

TEST(ListeningSocket, OptionsNameTheFieldAndItsValue) {
  const auto refusal = [](auto change) {
    ServerOptions options;
    change(&options);
    return ErrorOf([&] { options.Check(); });
  };
  EXPECT_EQ(refusal([](ServerOptions*) {}), "");
  EXPECT_THAT(refusal([](auto* o) { o->address = "localhost"; }),
              AllOf(HasSubstr("address"), HasSubstr("localhost")));
  EXPECT_THAT(refusal([](auto* o) { o->port = 65536; }),
              AllOf(HasSubstr("port"), HasSubstr("65536")));
  EXPECT_THAT(refusal([](auto* o) { o->socket = -2; }),
              AllOf(HasSubstr("socket"), HasSubstr("-2")));
  EXPECT_THAT(refusal([](auto* o) { o->token = "a b"; }), HasSubstr("token"));
  EXPECT_THAT(refusal([](auto* o) { o->hello = {1, 2}; }), HasSubstr("hello"));
}

TEST(HandedInSocket, ServesThePage) {
  const Descriptor handed_in = ListeningSocket();
  ServerOptions options;
  options.socket = dup(handed_in.get());
  options.page = "<p>handed in";
  const Server server(options, nullptr);
  const int port = PortOf(server);
  EXPECT_THAT(Exchange(port, GetRequest("/", "localhost:" + std::to_string(port))),
              HasSubstr("<p>handed in"));
}

TEST(HandedInSocket, IsTakenOnlyByTheProcessThatItIsFor) {
  const Descriptor handed_in = ListeningSocket();
  const std::string pid = std::to_string(getpid());
  EXPECT_EQ(HandedInSocket(pid.c_str(), "1", handed_in.get()), handed_in.get());
  EXPECT_NE(fcntl(handed_in.get(), F_GETFD) & FD_CLOEXEC, 0);
  EXPECT_EQ(HandedInSocket("1", "1", handed_in.get()), -1);
  EXPECT_EQ(HandedInSocket("", "1", handed_in.get()), -1);
  EXPECT_EQ(HandedInSocket(nullptr, "1", handed_in.get()), -1);
  EXPECT_EQ(HandedInSocket(pid.c_str(), nullptr, handed_in.get()), -1);
  EXPECT_EQ(HandedInSocket(pid.c_str(), "0", handed_in.get()), -1);
}

TEST(HandedInSocket, MoreThanOneIsRefused) {
  const std::string pid = std::to_string(getpid());
  for (const char* count : {"2", "x", "", "-1"}) {
    EXPECT_THAT(ErrorOf([&] { HandedInSocket(pid.c_str(), count, 3); }),
                HasSubstr("LISTEN_FDS is " + std::string(count)));
  }
}

TEST(HandedInSocket, WhatDoesNotListenOverTcpIsRefused) {
  const std::string pid = std::to_string(getpid());
  const auto refusal = [&](int socket) {
    return ErrorOf([&] { HandedInSocket(pid.c_str(), "1", socket); });
  };
  const Descriptor not_listening(socket(AF_INET, SOCK_STREAM, 0));
  EXPECT_THAT(refusal(not_listening.get()), HasSubstr("no listening TCP socket"));
  const Descriptor udp(socket(AF_INET, SOCK_DGRAM, 0));
  EXPECT_THAT(refusal(udp.get()), HasSubstr("no listening TCP socket"));
  const Descriptor local(socket(AF_UNIX, SOCK_STREAM, 0));
  EXPECT_THAT(refusal(local.get()), HasSubstr("no listening TCP socket"));
  const Descriptor file(open("/dev/null", O_RDONLY));
  EXPECT_THAT(refusal(file.get()), HasSubstr("no listening TCP socket"));
  net::io_context io;
  EXPECT_THAT(ErrorOf([&] { ListenOn(&io, file.get()); }), HasSubstr("no listening TCP socket"));
}

// As systemd hands it in: descriptor 3 and two environment variables of the final process.
TEST(HandedInSocket, IsDescriptorThree) {
  const Descriptor handed_in = ListeningSocket();
  const pid_t child = fork();
  if (child == 0) {
    const bool in_place = handed_in.get() == 3 || dup2(handed_in.get(), 3) == 3;
    setenv("LISTEN_PID", std::to_string(getpid()).c_str(), 1);
    setenv("LISTEN_FDS", "1", 1);
    _exit(in_place && HandedInSocket() == 3 ? 0 : 1);
  }
  int status = -1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

}  // namespace
}  // namespace rgbdt::viewer
