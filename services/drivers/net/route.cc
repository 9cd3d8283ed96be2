#include <arpa/inet.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "calib/model/descriptor.h"
#include "services/drivers/net/network_interfaces.h"

namespace rgbdt {
namespace {

// What `ip route get` asks. A connected socket would tell this machine's address only, and where
// the way leads over the loopback, that is another interface's.
struct Question {
  nlmsghdr header{};
  rtmsg route{};
  rtattr attribute{};
  std::uint32_t address = 0;
};

Question MakeQuestion(std::uint32_t address) {
  Question question;
  question.header.nlmsg_len = sizeof question;
  question.header.nlmsg_type = RTM_GETROUTE;
  question.header.nlmsg_flags = NLM_F_REQUEST;
  question.route.rtm_family = AF_INET;
  question.route.rtm_dst_len = 32;
  question.attribute.rta_len = RTA_LENGTH(sizeof address);
  question.attribute.rta_type = RTA_DST;
  question.address = htonl(address);
  return question;
}

using Answer = std::array<char, 4096>;

template <typename T>
T Read(const Answer& answer, std::size_t at) {
  T value{};
  if (at + sizeof value <= answer.size()) std::memcpy(&value, answer.data() + at, sizeof value);
  return value;
}

Route ReadRoute(const Answer& answer, std::size_t size) {
  Route route;
  std::size_t at = NLMSG_LENGTH(sizeof(rtmsg));
  while (at + sizeof(rtattr) <= size) {
    const auto attribute = Read<rtattr>(answer, at);
    if (attribute.rta_len < sizeof attribute) break;
    const std::size_t value = at + RTA_LENGTH(0);
    if (attribute.rta_type == RTA_PREFSRC) route.source = ntohl(Read<std::uint32_t>(answer, value));
    if (attribute.rta_type == RTA_OIF) {
      char name[IF_NAMESIZE] = "";
      if_indextoname(Read<std::uint32_t>(answer, value), name);
      route.interface = name;
    }
    at += RTA_ALIGN(attribute.rta_len);
  }
  return route;
}

Route Failed(int error) {
  Route route;
  route.error = error;
  return route;
}

}  // namespace

Route RouteTo(std::uint32_t address) {
  const Descriptor netlink(socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE));
  const Question question = MakeQuestion(address);
  if (send(netlink.get(), &question, sizeof question, 0) < 0) return Failed(errno);
  Answer answer{};
  const ssize_t size = recv(netlink.get(), answer.data(), answer.size(), 0);
  if (size < static_cast<ssize_t>(sizeof(nlmsghdr))) return Failed(EIO);
  if (Read<nlmsghdr>(answer, 0).nlmsg_type == NLMSG_ERROR) {
    return Failed(-Read<nlmsgerr>(answer, NLMSG_HDRLEN).error);
  }
  return ReadRoute(answer, static_cast<std::size_t>(size));
}

}  // namespace rgbdt
