// How long the board takes to find in clouds of 720,000 points, on one core, without a guess; and
// the paper's pipeline on the same clouds, given corners and the true camera pose.
//   study_cloud_times COUNT SEED CSV
// A line of CSV for each cloud. Times are of this machine: compare those of one run only.
#include <chrono>
#include <cstdio>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string>

#include "calib/detect/cloud/board_in_cloud.h"
#include "calib/methods/paper/cloud_edges.h"
#include "calib/simulate/internal/cloud_world.h"
#include "calib/simulate/internal/rig_defaults.h"
#include "calib/simulate/internal/spinning.h"
#include "tests/simulated_variants.h"
#include "tests/study/cloud_scenes.h"
#include "tests/study/sampled_images.h"
#include "tests/study/study_main.h"

namespace rgbdt::study {
namespace {

constexpr Utime kUtime = 1'433'160'000'000'000;

struct Timed {
  double milliseconds = 0;
  bool found = false;
};

template <typename Work>
double Milliseconds(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return 1e3 * std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

Timed TimeFindBoards(const Cloud& cloud, const simulate::CloudWorld& world, double range_sigma_m) {
  BoardInCloudOptions options;
  options.range_sigma_m = range_sigma_m;
  BoardsInCloud boards;
  Timed timed;
  timed.milliseconds = Milliseconds([&] { boards = FindBoards(cloud, world.target(), options); });
  timed.found = FindAmong(boards.candidates, world.lidar_from_target()) >= 0;
  return timed;
}

// The camera that sees the whole board from the LIDAR's place, for the paper's corners.
Timed TimePaper(const Cloud& cloud, const simulate::CloudWorld& world, std::uint64_t seed) {
  const simulate::CameraOptions camera = simulate::DefaultColorCamera();
  const Rigid3 camera_from_lidar = simulate::DrawCameraFromLidar(camera, seed);
  const CameraSpec spec = SpecOf(camera);
  const auto corners =
      TrueCorners(spec, world.target(), camera_from_lidar * world.lidar_from_target());
  if (!corners) return {};
  CloudEdgesResult result;
  Timed timed;
  timed.milliseconds = Milliseconds([&] {
    result = DetectCloudEdges(cloud, Camera(spec), camera_from_lidar, *corners, world.target());
  });
  timed.found = result.edges.has_value();
  return timed;
}

void Write(const Timed& timed, std::ofstream* csv) {
  *csv << ',' << timed.milliseconds << ',' << timed.found;
}

void Run(int count, std::uint64_t seed, const std::string& path) {
  std::ofstream csv(path);
  csv << "cloud,points,hits,organised_ms,organised_found,unorganised_ms,unorganised_found,"
         "paper_ms,paper_found\n";
  for (int i = 0; i < count; ++i) {
    simulate::Options options;
    options.seed = 1000 * seed + static_cast<std::uint64_t>(i);
    options.scene = static_cast<simulate::Scene>(i % 3);
    options.scanner = simulate::DenseScanner();
    const simulate::CloudWorld world(options, i);
    const Cloud cloud = world.Sweep(kUtime);
    const Cloud bare = simulate::Unorganised(cloud, false);
    csv << i << ',' << cloud.size() << ',' << bare.size();
    Write(TimeFindBoards(cloud, world, options.scanner.range_sigma_m), &csv);
    Write(TimeFindBoards(bare, world, options.scanner.range_sigma_m), &csv);
    Write(TimePaper(cloud, world, options.seed), &csv);
    csv << '\n';
  }
  if (!csv.flush()) throw std::runtime_error("cannot write " + path);
  std::printf("times: %d clouds of 720,000 points\n", count);
}

}  // namespace
}  // namespace rgbdt::study

int main(int argc, char** argv) {
  const auto run = [](const std::vector<std::string>& arguments) {
    rgbdt::study::Run(std::stoi(arguments[0]), std::stoull(arguments[1]), arguments[2]);
  };
  return rgbdt::study::StudyMain({"study_cloud_times", "COUNT SEED CSV", 3, 3, run}, argc, argv);
}
