// How many boards with markers are found in rendered colour images of which two fifths of the board
// are hidden, and how exactly.
//   study_markers COUNT SEED CSV charuco|aprilgrid
// writes one line for each scene to CSV and prints a summary.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>

#include "calib/detect/image/image_edges.h"
#include "calib/model/errors.h"
#include "tests/study/study_main.h"
#include "tests/unit/detect/image/corner_errors.h"
#include "tests/unit/detect/image/marked_scene.h"

namespace rgbdt::study {
namespace {

constexpr double kWrongPx = 1.5;  // as study_image_detection: a corner farther off is wrong

void Run(int count, std::uint64_t seed, const std::string& csv_path, const std::string& kind) {
  if (kind != "charuco" && kind != "aprilgrid") {
    throw InputError("the board is \"" + kind + "\"; expected charuco or aprilgrid");
  }
  const simulate::BoardOptions board = kind == "charuco" ? CharucoBoard() : AprilGridBoard();
  std::ofstream csv(csv_path);
  csv << "board,scene,range_m,corners,found,wrong,rms_px,worst_px,why\n";
  int found = 0;
  int wrong = 0;
  for (int i = 0; i < count; ++i) {
    const std::uint64_t own = seed * 1000 + static_cast<std::uint64_t>(i);
    MarkedScene scene = RenderMarked(board, own);
    HideTwoFifths(own, &scene);
    const ImageEdgesResult result =
        DetectImageEdges(scene.image, Camera(scene.spec), scene.target, nullptr, scene.spec.kind);
    Errors errors;
    std::ptrdiff_t seen = 0;
    if (result.edges) {
      errors = Compare(result.edges->corners, scene.corners);
      seen = std::count_if(result.edges->corners.begin(), result.edges->corners.end(), IsSeen);
    }
    const bool is_wrong = result.edges && (errors.turned || errors.worst > kWrongPx);
    found += result.edges ? 1 : 0;
    wrong += is_wrong ? 1 : 0;
    csv << kind << ',' << i << ',' << scene.camera_from_target.translation.norm() << ',' << seen
        << ',' << result.edges.has_value() << ',' << is_wrong << ',' << errors.rms << ','
        << errors.worst << ",\"" << result.why << "\"\n";
  }
  std::printf("%s: %d of %d found, %d wrong\n", kind.c_str(), found, count, wrong);
  if (!csv.flush()) throw std::runtime_error("cannot write " + csv_path);
}

}  // namespace
}  // namespace rgbdt::study

int main(int argc, char** argv) {
  const auto run = [](const std::vector<std::string>& arguments) {
    rgbdt::study::Run(std::stoi(arguments[0]), std::stoull(arguments[1]), arguments[2],
                      arguments[3]);
  };
  return rgbdt::study::StudyMain({"study_markers", "COUNT SEED CSV charuco|aprilgrid", 4, 4, run},
                                 argc, argv);
}
