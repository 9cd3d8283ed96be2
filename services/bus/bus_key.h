#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

namespace rgbdt {

/// What the processes of a rig share, and nobody else has: who has it may command the rig.
struct BusKey {
  std::array<std::uint8_t, 32> bytes{};
};

/// Draws a key and writes it, readable for its owner only: a line of 64 hexadecimal digits. Throws
/// InputError where there is a file of that name, or it cannot be written.
void WriteNewBusKey(const std::filesystem::path& file);

/// Throws InputError where the file is missing, is no key, or may be read by everybody.
BusKey ReadBusKey(const std::filesystem::path& file);

/// The file that a program was given, or else the environment's RGBDT_KEY; empty: no key.
std::filesystem::path BusKeyFile(const std::string& given);

}  // namespace rgbdt
