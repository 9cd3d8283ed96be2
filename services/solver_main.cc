#include <CLI/CLI.hpp>

#include "calib/model/version.h"
#include "services/nodes/solver_node.h"
#include "services/runtime/process.h"

int main(int argc, char** argv) {
  CLI::App app{
      "DETECTION to CALIBRATION: where each camera sits relative to the LIDAR.\nExample: "
      "rgbdt-solver --lcm-url 'udpm://239.255.76.67:7667?ttl=0'",
      "rgbdt-solver"};
  std::string url;
  app.add_option("--lcm-url", url, "the bus; default: LCM_DEFAULT_URL");
  std::string method = rgbdt::kAutoMethod;
  app.add_option("--method", method, rgbdt::kMethodHelp)->capture_default_str();
  app.set_version_flag("--version", rgbdt::Version());
  CLI11_PARSE(app, argc, argv);
  rgbdt::CalibrateOptions options;
  options.method = method;
  rgbdt::SolverNode node(options);
  return rgbdt::RunOnLcm(node, url);
}
