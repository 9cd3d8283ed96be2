// Whether the fuser colours what a camera sees, and nothing else: scenes by scenes, against shadow
// rays. For scripts/study visibility.

#include <fstream>
#include <string>

#include "calib/model/errors.h"
#include "tests/simulated_variants.h"
#include "tests/study/study_main.h"
#include "tests/study/visibility.h"

namespace rgbdt::study {
namespace {

void Run(const std::string& sensor, int scenes, std::uint64_t seed, const std::string& path) {
  std::ofstream csv(path);
  csv << "sensor,seed,judged,hidden,hidden_coloured,visible,visible_coloured\n";
  for (int i = 0; i < scenes; ++i) {
    simulate::Options options;
    options.seed = seed * 1000 + static_cast<std::uint64_t>(i);
    options.scene = static_cast<simulate::Scene>(i % 3);
    if (sensor == "dense") options.scanner = simulate::DenseScanner();
    const bool turned = sensor == "dense" || sensor == "turned";
    simulate::UseLidar(turned ? 0 : std::stoi(sensor), &options);  // "64s": 64
    const bool staggered = !turned && sensor.back() == 's';
    const VisibilityScores scores =
        ScoreVisibility(options, staggered ? Columns::kStaggered : Columns::kAligned);
    const auto write = [&](const char* judged, const VisibilityScore& s) {
      csv << sensor << ',' << options.seed << ',' << judged << ',' << s.hidden << ','
          << s.hidden_coloured << ',' << s.visible << ',' << s.visible_coloured << '\n';
    };
    write("whole", scores.whole);
    write("live", scores.live);
  }
  if (!csv.flush()) throw InputError(path + ": cannot be written");
}

}  // namespace
}  // namespace rgbdt::study

int main(int argc, char** argv) {
  const auto run = [](const std::vector<std::string>& arguments) {
    rgbdt::study::Run(arguments[0], std::stoi(arguments[1]), std::stoull(arguments[2]),
                      arguments[3]);
  };
  return rgbdt::study::StudyMain(
      {"study_visibility", "turned|dense|128|64|64s|32|16 SCENES SEED CSV", 4, 4, run}, argc, argv);
}
