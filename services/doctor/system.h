#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace rgbdt {

/// Where the kernel tells about itself; tests have trees of their own.
struct SystemRoots {
  std::filesystem::path proc = "/proc", sys = "/sys", root = "/";
};

/// A process that has something open.
struct Holder {
  int pid = 0;
  std::string name;  ///< as `ps` shows it, at most 15 characters
};

/// "rgbdt-motor (pid 12), screen (pid 40)"
std::string HoldersText(const std::vector<Holder>& holders);

/// The number that a file holds.
std::optional<std::int64_t> ReadNumber(const std::filesystem::path& file);

/// Whose descriptors are links to `target` ("/dev/ttyUSB0", "socket:[1234]"), by pid. This process
/// is left out, and so are those that one may not look into.
std::vector<Holder> HoldersOf(const SystemRoots& roots, const std::vector<std::string>& targets);

/// Who has a UDP port open, of this network namespace.
std::vector<Holder> HoldersOfUdpPort(const SystemRoots& roots, int port);

/// The processes of this network namespace whose name is, or begins with, one of these.
std::vector<Holder> ProcessesNamed(const SystemRoots& roots, const std::vector<std::string>& names);

/// [Mbit/s]; absent where the driver does not tell, or where /sys is another namespace's and has
/// not this interface.
std::optional<int> LinkSpeed(const SystemRoots& roots, const std::string& interface, int index);

/// Serial numbers of what is plugged in by USB.
std::vector<std::string> UsbSerials(const SystemRoots& roots);

/// The kernel's reverse-path filter of an interface: 0 none, 1 strict, 2 loose.
int ReversePathFilter(const SystemRoots& roots, const std::string& interface);

/// Whether the kernel's settings are another system's to make.
bool InContainer(const SystemRoots& roots);

}  // namespace rgbdt
