// How many boards are found in a Livox's clouds of one second, and how exactly.
//   study_livox COUNT SEED CSV MODEL...
// renders COUNT scenes of each model (mid360, avia), writes one line for each to CSV.
#include <cstdio>
#include <ctime>
#include <fstream>
#include <stdexcept>
#include <string>

#include "calib/detect/cloud/board_in_cloud.h"
#include "tests/study/livox_scenes.h"
#include "tests/study/study_main.h"

namespace rgbdt::study {
namespace {

// Degrees between the normals; the sign does not count.
double NormalError(const CloudEdges& found, const Rigid3& truth) {
  const Eigen::Vector3d normal = truth.rotation * Eigen::Vector3d::UnitZ();
  return std::asin(std::min(1.0, found.normal.normalized().cross(normal).norm())) /
         simulate::kDegree;
}

void WriteLine(const std::string& model, int index, const CloudScene& scene, std::ofstream* csv) {
  BoardInCloudOptions options;
  options.range_sigma_m = scene.range_sigma_m;
  const std::clock_t start = std::clock();  // CPU time: other programs do not count
  const BoardsInCloud boards = FindBoards(scene.cloud, scene.target, options);
  const double ms = 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  // The likeliest is what counts: it is named the board.
  double centre_mm = 0, normal_deg = 0;
  PoseError error;
  if (!boards.candidates.empty()) {
    const CloudEdges& first = boards.candidates.front();
    error = ErrorOf(*first.pose, scene.lidar_from_target);
    centre_mm = 1e3 * (first.centre - scene.lidar_from_target.translation).norm();
    normal_deg = NormalError(first, scene.lidar_from_target);
  }
  *csv << model << ',' << index << ',' << scene.scene << ',' << scene.form << ','
       << scene.lidar_from_target.translation.norm() << ',' << !boards.candidates.empty() << ','
       << boards.candidates.size() << ',' << normal_deg << ',' << centre_mm << ','
       << error.rotation_deg << ',' << error.chi2 << ',' << scene.cloud.size() << ',' << ms << ",\""
       << boards.why << "\"\n";
}

void Run(const std::vector<std::string>& arguments) {
  const std::string& path = arguments[2];
  std::ofstream csv(path);
  csv << "model,scene,scenery,form,range_m,named,candidates,normal_deg,centre_mm,rotation_deg,chi2,"
         "points,ms,why\n";
  for (std::size_t i = 3; i < arguments.size(); ++i) {
    const std::string& model = arguments[i];
    if (model != "mid360" && model != "avia") throw std::runtime_error("no model " + model);
    const auto which =
        model == "avia" ? simulate::LivoxModel::kAvia : simulate::LivoxModel::kMid360;
    RenderLivoxClouds(
        which, std::stoi(arguments[0]), std::stoull(arguments[1]),
        [&](int index, const CloudScene& scene) { WriteLine(model, index, scene, &csv); });
    std::printf("livox %s: %s scenes\n", model.c_str(), arguments[0].c_str());
    std::fflush(stdout);
  }
  if (!csv.flush()) throw std::runtime_error("cannot write " + path);
}

}  // namespace
}  // namespace rgbdt::study

int main(int argc, char** argv) {
  return rgbdt::study::StudyMain(
      {"study_livox", "COUNT SEED CSV MODEL...", 4, 1000, rgbdt::study::Run}, argc, argv);
}
