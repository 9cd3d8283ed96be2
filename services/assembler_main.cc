#include <CLI/CLI.hpp>

#include "calib/model/version.h"
#include "services/nodes/assembler_node.h"
#include "services/runtime/process.h"

int main(int argc, char** argv) {
  CLI::App app{
      "LINE_SCAN and ENCODER to CLOUD: a turned 2D scanner's lines become 3D.\nExample: "
      "rgbdt-assembler --lcm-url 'udpm://239.255.76.67:7667?ttl=0'",
      "rgbdt-assembler"};
  std::string url;
  app.add_option("--lcm-url", url, "the bus; default: LCM_DEFAULT_URL");
  app.set_version_flag("--version", rgbdt::Version());
  CLI11_PARSE(app, argc, argv);
  rgbdt::AssemblerNode node;
  return rgbdt::RunOnLcm(node, url);
}
