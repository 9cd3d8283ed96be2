#include <cstdio>
#include <memory>

#include "calib/files/schema/calibration_file.h"
#include "calib/files/schema/exports.h"
#include "calib/files/schema/rig_file.h"
#include "services/rgbdt/verbs.h"

namespace rgbdt {
namespace {

struct ExportFlags {
  std::string dir, calibration, out;
};

int RunExport(const ExportFlags& flags) {
  const std::filesystem::path dir = flags.dir;
  const Rig rig = ReadRig(dir / "rig.textproto");
  const Calibration calibration =
      ReadCalibration(PathOr(flags.calibration, dir / "calibration.textproto"));
  const std::filesystem::path out = PathOr(flags.out, dir / "export");
  for (const auto& path : ExportAll(out, rig, calibration)) std::printf("wrote %s\n", path.c_str());
  return 0;
}

}  // namespace

void AddExport(CommandLine* program) {
  auto flags = std::make_shared<ExportFlags>();
  CommandLine* verb =
      program->Verb("export",
                    "Writes a calibration for other tools: OpenCV YAML, a ROS static\n"
                    "transform, Kalibr's camchain. Each file says which way it goes.\n"
                    "Example: rgbdt export out/demo/session",
                    [flags] { return RunExport(*flags); });
  verb->Required("DIR", &flags->dir, "session directory");
  verb->Option("--calibration", &flags->calibration, "default: DIR/calibration.textproto");
  verb->Option("--out", &flags->out, "where to write; default: DIR/export");
}

}  // namespace rgbdt
