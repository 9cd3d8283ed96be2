// Writes the inputs that the fuzz targets begin with, DIR/TARGET/NAME, by the project's own
// writers.
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "tests/fuzz/seeds/seeds.h"

namespace rgbdt::fuzz {

std::string Piece(const std::string& bytes) {
  const auto size = static_cast<unsigned>(bytes.size());
  return std::string{static_cast<char>(size >> 8), static_cast<char>(size)} + bytes;
}

}  // namespace rgbdt::fuzz

// Replay.cc's and libFuzzer's main call it; this program has its own.
int main(int argc, char** argv) {
  using namespace rgbdt::fuzz;
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s DIR\n", argv[0]);
    return 2;
  }
  Seeds seeds;
  AddBusSeeds(&seeds);
  AddNodeSeeds(&seeds);
  AddFileSeeds(&seeds);
  AddBagSeeds(&seeds);
  AddFoxgloveSeeds(&seeds);
  AddDeviceSeeds(&seeds);
  AddPacketSeeds(&seeds);
  AddViewerSeeds(&seeds);
  std::size_t files = 0, bytes = 0;
  for (const auto& [target, inputs] : seeds) {
    const std::filesystem::path folder = std::filesystem::path(argv[1]) / target;
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    for (const auto& [name, input] : inputs) {
      std::ofstream file(folder / name, std::ios::binary);
      if (!(file << input).flush()) {
        std::fprintf(stderr, "cannot write %s\n", (folder / name).c_str());
        return 1;
      }
      ++files;
      bytes += input.size();
    }
  }
  std::printf("%zu inputs of %zu targets, %zu bytes\n", files, seeds.size(), bytes);
  return 0;
}
