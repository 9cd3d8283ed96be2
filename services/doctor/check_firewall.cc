#include <regex>
#include <sstream>

#include "services/doctor/checks.h"

namespace rgbdt {
namespace {

// Whether what other machines send to the port is dropped on its way in: by a rule of a chain that
// hooks there, as the one that is advised. Other firewalls may do as much in other words.
bool DropsOthers(const std::string& ruleset, int port) {
  const std::string number = std::to_string(port);
  const std::regex drops("udp dport (" + number + "|\\{[^}]*\\b" + number +
                         "\\b[^}]*\\}) .*fib saddr type != local .*drop");
  std::istringstream lines(ruleset);
  bool incoming = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.find("chain ") != std::string::npos) incoming = false;
    if (line.find(" hook input ") != std::string::npos) incoming = true;
    if (incoming && std::regex_search(line, drops)) return true;
  }
  return false;
}

}  // namespace

Finding CheckFirewall(const FirewallFacts& facts) {
  const std::string check = "LCM firewall";
  if (!facts.others_reach) return Ok(check, "no other machine is connected");
  if (!facts.readable) {
    return Ok(check, "not looked at: the kernel's rules are root's to see, by nft (nftables)");
  }
  const std::string port = std::to_string(facts.port);
  if (DropsOthers(facts.ruleset, facts.port)) {
    return Ok(check, "what other machines send to UDP port " + port + " is dropped");
  }
  return Warning(check,
                 "no rule of nftables drops what other machines send to UDP port " + port +
                     ": two forged datagrams end lcm-logger and lcm-logplayer, at ttl=0, too "
                     "(not the processes of rgbdt)",
                 "sudo nft add table ip lcm; sudo nft 'add chain ip lcm input { type filter hook "
                 "input priority 0; }'; sudo nft add rule ip lcm input udp dport " +
                     port + " fib saddr type != local drop");
}

}  // namespace rgbdt
