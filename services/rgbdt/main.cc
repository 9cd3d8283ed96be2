#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <string>

#include "calib/model/version.h"
#include "services/rgbdt/verbs.h"

int main(int argc, char** argv) {
  CLI::App app{
      "rgbdt: where a colour and a thermal camera sit relative to a LIDAR, and their fused cloud.\n"
      "Example: rgbdt simulate out/synthetic && rgbdt calibrate out/synthetic",
      "rgbdt"};
  app.set_version_flag("--version", rgbdt::Version());
  app.require_subcommand(1);
  int exit_code = 0;
  const std::string verb = argc > 1 ? argv[1] : "";
  rgbdt::AddCalibrate(&app, &exit_code);
  rgbdt::AddEvaluate(&app, &exit_code);
  rgbdt::AddFuse(&app, &exit_code);
#ifdef RGBDT_HAS_SIMULATOR
  rgbdt::AddSimulate(&app, &exit_code);
#endif
  rgbdt::AddReplay(&app, &exit_code);
  rgbdt::AddIntrinsics(&app, &exit_code);
  rgbdt::AddScanner(&app, &exit_code);
  rgbdt::AddMap(&app, &exit_code);
  rgbdt::AddTerrain(&app, &exit_code);
  rgbdt::AddExport(&app, &exit_code);
#ifdef RGBDT_HAS_DRIVERS
  rgbdt::AddDoctor(&app, &exit_code);
#endif
  const auto is_it = [&](const CLI::App* candidate) { return candidate->get_name() == verb; };
  if (!verb.empty() && verb[0] != '-' && app.get_subcommands(is_it).empty()) {
    std::fprintf(stderr, "rgbdt: there is no verb \"%s\"; see rgbdt --help\n", verb.c_str());
    return 1;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "rgbdt: %s\n", e.what());
    return 1;
  }
  return exit_code;
}
