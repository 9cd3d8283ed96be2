#include <CLI/CLI.hpp>

#include "calib/model/version.h"
#include "services/nodes/detector_node.h"
#include "services/runtime/process.h"

int main(int argc, char** argv) {
  CLI::App app{
      "On a capture command: the target's edges in images and cloud (DETECTION).\nExample: "
      "rgbdt-detector --lcm-url 'udpm://239.255.76.67:7667?ttl=0'",
      "rgbdt-detector"};
  std::string url;
  app.add_option("--lcm-url", url, "the bus; default: LCM_DEFAULT_URL");
  std::string method = rgbdt::kAutoMethod;
  app.add_option("--method", method, rgbdt::kMethodHelp)->capture_default_str();
  app.set_version_flag("--version", rgbdt::Version());
  CLI11_PARSE(app, argc, argv);
  rgbdt::DetectorNode node(method);
  return rgbdt::RunOnLcm(node, url);
}
