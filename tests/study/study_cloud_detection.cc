// How many boards are found in rendered clouds, and how exactly.
//   study_cloud_detection COUNT SEED CSV CLASS...
// renders COUNT scenes of each class (of some a share of that), writes one line for each scene to
// CSV and says how far it is. Without arguments it names the classes.
#include <cstdio>
#include <ctime>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>

#include "calib/detect/cloud/board_in_cloud.h"
#include "tests/study/cloud_scenes.h"
#include "tests/study/study_main.h"

namespace rgbdt::study {
namespace {

void WriteLine(const CloudClass& cloud_class, int index, const CloudScene& scene,
               std::ofstream* csv) {
  BoardInCloudOptions options;
  options.range_sigma_m = scene.range_sigma_m;
  const std::clock_t start = std::clock();  // CPU time: other programs do not count
  const BoardsInCloud boards = FindBoards(scene.cloud, scene.target, options);
  const double ms = 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  const int found = FindAmong(boards.candidates, scene.lidar_from_target);
  PoseError error;
  if (found >= 0) {
    error =
        ErrorOf(*boards.candidates[static_cast<std::size_t>(found)].pose, scene.lidar_from_target);
  }
  *csv << cloud_class.name << ',' << index << ',' << scene.scene << ',' << scene.form << ','
       << scene.lidar_from_target.translation.norm() << ',' << (found >= 0) << ',' << (found == 0)
       << ',' << boards.candidates.size() << ',' << error.rotation_deg << ',' << error.centre_mm
       << ',' << error.chi2 << ',' << ms << ",\"" << boards.why << "\"\n";
}

void RunClass(const CloudClass& cloud_class, int count, std::uint64_t seed, std::ofstream* csv) {
  const int scenes = std::max(1, count * cloud_class.share_percent / 100);
  RenderClouds(cloud_class, scenes, seed, [&](int index, const CloudScene& scene) {
    WriteLine(cloud_class, index, scene, csv);
  });
  std::printf("clouds %s: %d scenes\n", cloud_class.name.c_str(), scenes);
  std::fflush(stdout);
}

void Run(const std::vector<std::string>& arguments) {
  const std::string& path = arguments[2];
  std::ofstream csv(path);
  csv << "class,scene,scenery,form,range_m,found,first,candidates,rotation_deg,centre_mm,chi2,ms,"
         "why\n";
  for (std::size_t i = 3; i < arguments.size(); ++i) {
    bool known = false;
    for (const CloudClass& cloud_class : CloudClasses()) {
      if (cloud_class.name != arguments[i]) continue;
      known = true;
      RunClass(cloud_class, std::stoi(arguments[0]), std::stoull(arguments[1]), &csv);
    }
    if (!known) throw std::runtime_error("no class " + arguments[i]);
  }
  if (!csv.flush()) throw std::runtime_error("cannot write " + path);
}

}  // namespace
}  // namespace rgbdt::study

int main(int argc, char** argv) {
  if (argc == 1) {
    for (const auto& cloud_class : rgbdt::study::CloudClasses()) {
      std::cout << cloud_class.name << "\n";
    }
    return 0;
  }
  return rgbdt::study::StudyMain(
      {"study_cloud_detection", "COUNT SEED CSV CLASS...", 4, 1000, rgbdt::study::Run}, argc, argv);
}
