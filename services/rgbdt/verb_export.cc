#include <cstdio>
#include <memory>

#include "calib/files/schema/calibration_file.h"
#include "calib/files/schema/exports.h"
#include "calib/files/schema/rig_file.h"
#include "services/rgbdt/verbs.h"

namespace rgbdt {
namespace {

struct ExportFlags {
  std::string dir, calibration, out, lidar_frame;
  std::vector<std::string> camera_frames;
  bool anyway = false;
};

FrameNames FramesOf(const ExportFlags& flags) {
  FrameNames frames{flags.lidar_frame, {}};
  for (const std::string& text : flags.camera_frames) {
    const std::size_t at = text.find('=');
    if (at == std::string::npos) {
      throw UsageError("--camera-frame is \"" + text +
                       "\"; expected CAMERA=FRAME, as in rgb=camera_optical_frame");
    }
    frames.cameras[text.substr(0, at)] = text.substr(at + 1);
  }
  return frames;
}

int RunExport(const ExportFlags& flags) {
  const std::filesystem::path dir = flags.dir;
  const CalibrationFiles files = FilesOf(dir, flags.calibration, flags.anyway);
  const Rig rig = ReadRig(files.rig);
  const Calibration calibration = ReadCalibration(files.calibration);
  PrintWarnings(RequireSound(calibration, rig, files.Names(), files.HowToUse()));
  const std::filesystem::path out = PathOr(flags.out, dir / "export");
  for (const ExportedFile& file : ExportAll(out, rig, calibration, FramesOf(flags))) {
    std::printf("wrote %s: %s\n", file.path.c_str(), file.purpose.c_str());
  }
  return EndsWith(true);
}

}  // namespace

void AddExport(CommandLine* program) {
  auto flags = std::make_shared<ExportFlags>();
  CommandLine* verb = program->Verb(
      "export",
      "Writes a calibration for other tools: static transforms of ROS as command lines, launch\n"
      "file and URDF, OpenCV YAML, Kalibr's camchain. Each file says which way it goes. A\n"
      "calibration that is not to be used, or was made with another rig, is refused.\n"
      "Example: rgbdt export out/demo/session --lidar-frame velodyne \\\n"
      "           --camera-frame rgb=camera_optical_frame",
      [flags] { return RunExport(*flags); });
  verb->Required("DIR", &flags->dir, "session directory");
  verb->Option("--calibration", &flags->calibration, "default: DIR/calibration.textproto");
  verb->Option("--out", &flags->out, "where to write; default: DIR/export");
  verb->Option("--lidar-frame", &flags->lidar_frame,
               "what ROS calls the LIDAR's frame; default: its name in the rig file");
  verb->Option("--camera-frame", &flags->camera_frames,
               "CAMERA=FRAME: what ROS calls a camera's optical frame (x right, y down, z "
               "forward);\nmay be given again; default: CAMERA_optical_frame");
  AddAnyway(verb, &flags->anyway, "its verdict is `do not use`, or the rig is another");
}

}  // namespace rgbdt
