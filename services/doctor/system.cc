#include "services/doctor/system.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <set>
#include <sstream>

namespace rgbdt {
namespace {

namespace fs = std::filesystem;

// What a folder holds, in the order of the names; nothing where one may not look.
std::vector<fs::path> Entries(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    entries.push_back(entry->path());
  }
  std::sort(entries.begin(), entries.end());
  return entries;
}

std::string FirstLine(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

bool IsNumber(const std::string& text) {
  return !text.empty() && text.size() < 10 &&
         text.find_first_not_of("0123456789") == std::string::npos;
}

// Every process but this one that `wanted` says yes to, by pid.
std::vector<Holder> Processes(const SystemRoots& roots,
                              const std::function<bool(const fs::path&)>& wanted) {
  std::vector<Holder> holders;
  for (const fs::path& process : Entries(roots.proc)) {
    const std::string pid = process.filename();
    if (!IsNumber(pid) || std::stoi(pid) == getpid() || !wanted(process)) continue;
    holders.push_back({std::stoi(pid), FirstLine(process / "comm")});
  }
  std::sort(holders.begin(), holders.end(),
            [](const Holder& a, const Holder& b) { return a.pid < b.pid; });
  return holders;
}

// The sockets on a port, as /proc/*/fd names them. A line of the table:
// "sl local_address rem_address st tx:rx tr:when retrnsmt uid timeout inode ...", addresses in
// hexadecimal with the port behind the colon.
void AddSockets(const fs::path& table, int port, std::vector<std::string>* sockets) {
  std::ifstream in(table);
  std::string line;
  std::getline(in, line);  // the head
  while (std::getline(in, line)) {
    std::istringstream words(line);
    std::vector<std::string> word(10);
    for (std::string& w : word) words >> w;
    const std::size_t colon = word[1].rfind(':');
    if (!words || colon == std::string::npos) continue;
    if (std::strtol(word[1].c_str() + colon + 1, nullptr, 16) == port) {
      sockets->push_back("socket:[" + word[9] + "]");
    }
  }
}

// What one may not look into could be.
bool InOurNetwork(const SystemRoots& roots, const fs::path& process) {
  std::error_code error;
  const fs::path theirs = fs::read_symlink(process / "ns/net", error);
  return error || theirs == fs::read_symlink(roots.proc / "self/ns/net", error);
}

}  // namespace

std::string HoldersText(const std::vector<Holder>& holders) {
  std::string text;
  for (const Holder& holder : holders) {
    text += (text.empty() ? "" : ", ") + holder.name + " (pid " + std::to_string(holder.pid) + ")";
  }
  return text;
}

std::optional<std::int64_t> ReadNumber(const fs::path& file) {
  std::ifstream in(file);
  std::int64_t number = 0;
  if (!(in >> number)) return {};
  return number;
}

std::vector<Holder> HoldersOf(const SystemRoots& roots, const std::vector<std::string>& targets) {
  const std::set<std::string> wanted(targets.begin(), targets.end());
  return Processes(roots, [&](const fs::path& process) {
    const std::vector<fs::path> descriptors = Entries(process / "fd");
    return std::any_of(descriptors.begin(), descriptors.end(), [&](const fs::path& descriptor) {
      std::error_code error;
      return wanted.count(fs::read_symlink(descriptor, error).string()) > 0;
    });
  });
}

std::vector<Holder> HoldersOfUdpPort(const SystemRoots& roots, int port) {
  std::vector<std::string> sockets;
  AddSockets(roots.proc / "net/udp", port, &sockets);
  AddSockets(roots.proc / "net/udp6", port, &sockets);
  return sockets.empty() ? std::vector<Holder>{} : HoldersOf(roots, sockets);
}

std::vector<Holder> ProcessesNamed(const SystemRoots& roots,
                                   const std::vector<std::string>& names) {
  return Processes(roots, [&](const fs::path& process) {
    const std::string is = FirstLine(process / "comm");
    return std::any_of(names.begin(), names.end(),
                       [&](const std::string& name) { return is.rfind(name, 0) == 0; }) &&
           InOurNetwork(roots, process);
  });
}

std::optional<int> LinkSpeed(const SystemRoots& roots, const std::string& interface, int index) {
  const fs::path folder = roots.sys / "class/net" / interface;
  if (ReadNumber(folder / "ifindex").value_or(0) != index) return {};
  const auto speed = ReadNumber(folder / "speed");
  if (!speed || *speed <= 0) return {};
  return static_cast<int>(*speed);
}

std::vector<std::string> UsbSerials(const SystemRoots& roots) {
  std::vector<std::string> serials;
  for (const fs::path& device : Entries(roots.sys / "bus/usb/devices")) {
    const std::string serial = FirstLine(device / "serial");
    if (!serial.empty()) serials.push_back(serial);
  }
  return serials;
}

// The kernel takes the larger of the two.
int ReversePathFilter(const SystemRoots& roots, const std::string& interface) {
  const fs::path folder = roots.proc / "sys/net/ipv4/conf";
  const auto all = ReadNumber(folder / "all/rp_filter").value_or(0);
  const auto own = ReadNumber(folder / interface / "rp_filter").value_or(0);
  return static_cast<int>(std::max(all, own));
}

bool InContainer(const SystemRoots& roots) {
  std::error_code error;
  return fs::exists(roots.root / ".dockerenv", error) ||
         fs::exists(roots.root / "run/.containerenv", error) ||
         fs::exists(roots.root / "run/systemd/container", error);
}

}  // namespace rgbdt
