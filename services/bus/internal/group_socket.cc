#include "services/bus/internal/group_socket.h"

#include <linux/filter.h>
#include <net/if_arp.h>
#include <netinet/in.h>
#include <netpacket/packet.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>

#include "calib/model/errors.h"

namespace rgbdt {
namespace {

void Check(int result, const char* what) {
  if (result == 0) return;
  throw InputError(std::string(what) + ": " + std::strerror(errno));
}

void SetOption(const Descriptor& udp, int level, int name, const void* value, std::size_t size,
               const char* what) {
  Check(setsockopt(udp.get(), level, name, value, static_cast<socklen_t>(size)), what);
}

// What this machine sent is looped back by the interface that it leaves by, or came by the loopback
// interface; nobody else's datagram is either, whatever its source address says.
void RefuseOtherMachines(const Descriptor& udp) {
  const auto special = [](int field) { return static_cast<std::uint32_t>(SKF_AD_OFF + field); };
  sock_filter program[] = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, special(SKF_AD_PKTTYPE)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, PACKET_LOOPBACK, 2, 0),
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, special(SKF_AD_HATYPE)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, ARPHRD_LOOPBACK, 0, 1),
      BPF_STMT(BPF_RET | BPF_K, 0xffffffff),  // all of it
      BPF_STMT(BPF_RET | BPF_K, 0),
  };
  const sock_fprog filter{sizeof program / sizeof *program, program};
  SetOption(udp, SOL_SOCKET, SO_ATTACH_FILTER, &filter, sizeof filter, "a filter for ttl=0");
}

}  // namespace

Descriptor OpenGroupSocket(const BusUrl& url) {
  Descriptor udp(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  Check(udp ? 0 : -1, "a socket");
  const int on = 1;
  SetOption(udp, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on, "sharing the port");
  if (url.buffer_bytes > 0) {
    const int bytes = static_cast<int>(url.buffer_bytes);
    SetOption(udp, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes, "the receive buffer");
  }
  if (url.ttl == 0) RefuseOtherMachines(udp);
  sockaddr_in group{};
  group.sin_family = AF_INET;
  group.sin_addr.s_addr = htonl(url.group);
  group.sin_port = htons(static_cast<std::uint16_t>(url.port));
  Check(bind(udp.get(), reinterpret_cast<const sockaddr*>(&group), sizeof group), "the port");
  ip_mreq membership{};
  membership.imr_multiaddr = group.sin_addr;
  SetOption(udp, IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership,
            "joining the group");
  return udp;
}

}  // namespace rgbdt
