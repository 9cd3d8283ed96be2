#include <CLI/CLI.hpp>

#include "calib/model/version.h"
#include "services/nodes/fuser_node.h"
#include "services/runtime/process.h"

int main(int argc, char** argv) {
  CLI::App app{
      "CLOUD and images through the calibration to RGBDT_CLOUD.\nExample: rgbdt-fuser --lcm-url "
      "'udpm://239.255.76.67:7667?ttl=0'",
      "rgbdt-fuser"};
  std::string url;
  app.add_option("--lcm-url", url, "the bus; default: LCM_DEFAULT_URL");
  app.set_version_flag("--version", rgbdt::Version());
  CLI11_PARSE(app, argc, argv);
  rgbdt::FuserNode node;
  return rgbdt::RunOnLcm(node, url);
}
