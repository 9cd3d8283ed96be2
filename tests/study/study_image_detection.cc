// How many boards are found in rendered images, how exactly and how fast.
//   study_image_detection COUNT SEED CSV [CLASS]
// renders COUNT scenes of each class (or of those whose name contains CLASS), prints a table and
// writes one line for each scene to CSV. Without arguments it names the classes.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>

#include "calib/camera/pixels.h"
#include "calib/detect/image/checkerboard.h"
#include "tests/study/image_scenes.h"
#include "tests/study/study_main.h"
#include "tests/unit/detect/image/corner_errors.h"

namespace rgbdt::study {
namespace {

constexpr double kWrongPx = 1.5;  // a board with a corner farther off than this is wrong

struct Outcome {
  bool found = false, wrong = false;
  double rms_px = 0, worst_px = 0;  ///< of the corners' errors
  double milliseconds = 0;
  std::string why;
};

Outcome Detect(const ImageScene& scene) {
  const cv::Mat grey = ToGrey(scene.image);
  const std::clock_t start = std::clock();  // CPU time: other programs do not count
  const CheckerboardResult result =
      FindCheckerboard(grey, scene.target, SaturatedFrom(scene.image));
  Outcome outcome;
  outcome.milliseconds = 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  outcome.found = result.board.has_value();
  outcome.why = result.why;
  if (result.board) {
    const Errors errors = Compare(result.board->corners, scene.corners);
    outcome.rms_px = errors.rms;
    outcome.worst_px = errors.worst;
    outcome.wrong = errors.worst > kWrongPx;
  }
  return outcome;
}

struct Summary {
  int scenes = 0, found = 0, wrong = 0;
  double sum_of_squares = 0, worst_px = 0, milliseconds = 0, slowest = 0;
  std::size_t corners = 0;

  void Add(const ImageScene& scene, const Outcome& o) {
    ++scenes;
    milliseconds += o.milliseconds;
    slowest = std::max(slowest, o.milliseconds);
    if (!o.found) return;
    ++found;
    wrong += o.wrong ? 1 : 0;
    if (o.wrong) return;
    sum_of_squares += o.rms_px * o.rms_px * static_cast<double>(scene.corners.size());
    worst_px = std::max(worst_px, o.worst_px);
    corners += scene.corners.size();
  }
  void Print(const std::string& name) const {
    std::printf("%-18s %6d %8.4f %8.4f %9.4f %9.3f %8.1f %8.1f\n", name.c_str(), scenes,
                double(found) / scenes, double(wrong) / scenes,
                std::sqrt(sum_of_squares / std::max(1.0, double(corners))), worst_px,
                milliseconds / scenes, slowest);
    std::fflush(stdout);
  }
};

void Run(int count, std::uint64_t seed, const std::string& csv_path, const std::string& only) {
  std::ofstream csv(csv_path);
  csv << "class,scene,range_m,contrast_k,found,wrong,rms_px,worst_px,ms,why\n";
  std::printf("%-18s %6s %8s %8s %9s %9s %8s %8s\n", "class", "scenes", "found", "wrong", "rms px",
              "worst px", "ms", "slowest");
  for (const SceneClass& scene_class : SceneClasses()) {
    if (scene_class.name.find(only) == std::string::npos) continue;
    Summary summary;
    RenderScenes(scene_class, count, seed, [&](int index, const ImageScene& scene) {
      const Outcome o = Detect(scene);
      summary.Add(scene, o);
      csv << scene_class.name << ',' << index << ',' << scene.range_m << ',' << scene.contrast_k
          << ',' << o.found << ',' << o.wrong << ',' << o.rms_px << ',' << o.worst_px << ','
          << o.milliseconds << ",\"" << o.why << "\"\n";
    });
    summary.Print(scene_class.name);
  }
  if (!csv.flush()) throw std::runtime_error("cannot write " + csv_path);
}

}  // namespace
}  // namespace rgbdt::study

int main(int argc, char** argv) {
  if (argc == 1) {
    for (const auto& scene_class : rgbdt::study::SceneClasses()) {
      std::cout << scene_class.name << "\n";
    }
    return 0;
  }
  const auto run = [](const std::vector<std::string>& arguments) {
    rgbdt::study::Run(std::stoi(arguments[0]), std::stoull(arguments[1]), arguments[2],
                      arguments.size() > 3 ? arguments[3] : "");
  };
  return rgbdt::study::StudyMain({"study_image_detection", "COUNT SEED CSV [CLASS]", 3, 4, run},
                                 argc, argv);
}
