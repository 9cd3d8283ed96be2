#include <cstdio>
#include <memory>

#include "calib/files/schema/calibration_file.h"
#include "calib/files/schema/exports.h"
#include "calib/files/schema/rig_file.h"
#include "services/rgbdt/verbs.h"

namespace rgbdt {
namespace {

struct Flags {
  std::string dir, calibration, out;
};

int Run(const Flags& flags) {
  const std::filesystem::path dir = flags.dir;
  const Rig rig = ReadRig(dir / "rig.textproto");
  const Calibration calibration =
      ReadCalibration(PathOr(flags.calibration, dir / "calibration.textproto"));
  const std::filesystem::path out = PathOr(flags.out, dir / "export");
  for (const auto& path : ExportAll(out, rig, calibration)) std::printf("wrote %s\n", path.c_str());
  return 0;
}

}  // namespace

void AddExport(CLI::App* app, int* exit_code) {
  CLI::App* verb =
      app->add_subcommand("export",
                          "Writes a calibration for other tools: OpenCV YAML, a ROS static\n"
                          "transform, Kalibr's camchain. Each file says which way it goes.\n"
                          "Example: rgbdt export out/demo/session");
  auto flags = std::make_shared<Flags>();
  verb->add_option("DIR", flags->dir, "session directory")->required();
  verb->add_option("--calibration", flags->calibration, "default: DIR/calibration.textproto");
  verb->add_option("--out", flags->out, "where to write; default: DIR/export");
  verb->callback([flags, exit_code] { *exit_code = Run(*flags); });
}

}  // namespace rgbdt
