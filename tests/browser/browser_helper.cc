// What the browser tests' scripts need of the simulator and of the bus. See Usage().

#include <cstdio>
#include <exception>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "calib/model/errors.h"
#include "services/bus/log.h"
#include "tests/browser/cover_relay.h"
#include "tests/browser/stream.h"
#include "tests/browser/true_scene.h"

namespace rgbdt::browser {
namespace {

using Arguments = std::vector<std::string>;

int Usage() {
  std::fputs(
      "usage: browser_helper VERB ...\n"
      "  squares SEED TRUTH VIEW          JSON: middles of nine squares of the board [m], LIDAR\n"
      "  outline SEED TRUTH VIEW CAMERA   JSON: the board's four corners in the image [px]\n"
      "  truth SEED TRUTH VIEW            of each \"x y z\" [m] on stdin what is there, as JSON\n"
      "  cover URL TRUTH CAMERA           between the bus and a simulator on the bus URL: paints "
      "a\n"
      "                                   bar over the board in this camera's images\n"
      "  stream HZ POINTS CHUNKS IMAGE_HZ [SECONDS]  a calibrated rig: so many sweeps a second of\n"
      "                                   so many points in so many CLOUD messages, and images\n"
      "  count LOG CHANNEL                how many messages a log has of it\n"
      "SEED: the simulator's. TRUTH: the file of its --truth.\n",
      stderr);
  return 2;
}

nlohmann::json Numbers(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

TrueScene SceneOf(const Arguments& arguments) {
  simulate::Options options;
  options.seed = std::stoull(arguments.at(0));
  return TrueScene(options, arguments.at(1), arguments.at(2));
}

int PrintSquares(const Arguments& arguments) {
  const TrueScene scene = SceneOf(arguments);
  nlohmann::json all = {{"centre", Numbers(scene.BoardCentre())}, {"squares", {}}};
  for (const Eigen::Vector3d& square : scene.Squares()) all["squares"].push_back(Numbers(square));
  std::cout << all << '\n';
  return 0;
}

int PrintOutline(const Arguments& arguments) {
  nlohmann::json all;
  for (const Eigen::Vector2d& p : SceneOf(arguments).OutlineIn(arguments.at(3))) {
    all.push_back({p.x(), p.y()});
  }
  std::cout << all << '\n';
  return 0;
}

int PrintTruth(const Arguments& arguments) {
  const TrueScene scene = SceneOf(arguments);
  nlohmann::json all = nlohmann::json::array();
  Eigen::Vector3d point;
  while (std::cin >> point.x() >> point.y() >> point.z()) {
    const TruePoint there = scene.At(point);
    all.push_back({{"what", there.what}, {"distance_m", there.distance_m}});
    if (!there.kelvin) continue;
    all.back()["low_k"] = there.kelvin->low;
    all.back()["high_k"] = there.kelvin->high;
  }
  std::cout << all << '\n';
  return 0;
}

int PrintCount(const Arguments& arguments) {
  LogReader log(arguments.at(0));
  int count = 0;
  while (const auto event = log.Next()) count += event->channel == arguments.at(1) ? 1 : 0;
  std::cout << count << '\n';
  return 0;
}

int RunStream(const Arguments& arguments) {
  StreamOptions options;
  options.sweeps_hz = std::stod(arguments.at(0));
  options.points = std::stoll(arguments.at(1));
  options.chunks = std::stoi(arguments.at(2));
  options.images_hz = std::stod(arguments.at(3));
  if (arguments.size() > 4) options.seconds = std::stod(arguments.at(4));
  Stream(options);
  return 0;
}

int Run(const std::string& verb, const Arguments& arguments) {
  if (verb == "squares") return PrintSquares(arguments);
  if (verb == "outline") return PrintOutline(arguments);
  if (verb == "truth") return PrintTruth(arguments);
  if (verb == "count") return PrintCount(arguments);
  if (verb == "stream") return RunStream(arguments);
  if (verb == "cover") {
    CoverRelay(arguments.at(0), arguments.at(1), arguments.at(2));
    return 0;
  }
  return Usage();
}

}  // namespace
}  // namespace rgbdt::browser

int main(int argc, char** argv) {
  if (argc < 3) return rgbdt::browser::Usage();
  try {
    return rgbdt::browser::Run(argv[1], rgbdt::browser::Arguments(argv + 2, argv + argc));
  } catch (const std::exception& e) {
    std::fprintf(stderr, "browser_helper: %s\n", e.what());
    return 1;
  }
}
