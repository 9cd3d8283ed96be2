// Whether the fuser colours what a camera sees, and nothing else: scenes by scenes, against shadow
// rays. For scripts/study visibility.

#include <cstdio>
#include <cstdlib>
#include <string>

#include "calib/model/errors.h"
#include "tests/study/visibility.h"

namespace rgbdt::study {
namespace {

void Run(const std::string& sensor, int scenes, std::uint64_t seed, std::FILE* csv) {
  std::fprintf(csv, "sensor,seed,judged,hidden,hidden_coloured,visible,visible_coloured\n");
  for (int i = 0; i < scenes; ++i) {
    simulate::Options options;
    options.seed = seed * 1000 + static_cast<std::uint64_t>(i);
    options.scene = static_cast<simulate::Scene>(i % 3);
    if (sensor == "dense") options.scanner = simulate::DenseScanner();
    const bool turned = sensor == "dense" || sensor == "turned";
    simulate::UseLidar(turned ? 0 : std::stoi(sensor), &options);
    const VisibilityScores scores = ScoreVisibility(options);
    const auto write = [&](const char* judged, const VisibilityScore& s) {
      std::fprintf(csv, "%s,%llu,%s,%ld,%ld,%ld,%ld\n", sensor.c_str(),
                   static_cast<unsigned long long>(options.seed), judged, s.hidden,
                   s.hidden_coloured, s.visible, s.visible_coloured);
    };
    write("whole", scores.whole);
    write("live", scores.live);
  }
}

int Main(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: study_visibility turned|dense|128|64|32|16 SCENES SEED OUT.csv\n");
    return 2;
  }
  std::FILE* csv = std::fopen(argv[4], "w");
  if (csv == nullptr) throw InputError(std::string(argv[4]) + ": cannot be written");
  Run(argv[1], std::atoi(argv[2]), std::strtoull(argv[3], nullptr, 10), csv);
  return std::fclose(csv) == 0 ? 0 : 1;
}

}  // namespace
}  // namespace rgbdt::study

int main(int argc, char** argv) {
  try {
    return rgbdt::study::Main(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "study_visibility: %s\n", e.what());
    return 1;
  }
}
