#include <cstdio>
#include <memory>

#include "calib/files/atomic_file.h"
#include "calib/files/check_writable.h"
#include "calib/files/own_folder.h"
#include "calib/files/points/cloud_files.h"
#include "calib/files/points/las_files.h"
#include "calib/files/points/map_files.h"
#include "calib/files/schema/calibration_file.h"
#include "calib/files/schema/exports.h"
#include "calib/files/schema/rig_file.h"
#include "services/bags/printable.h"
#include "services/export/export_log.h"
#include "services/rgbdt/verbs.h"

namespace rgbdt {
namespace {

struct ExportFlags {
  std::string dir, calibration, out, lidar_frame;
  std::vector<std::string> camera_frames;
  bool anyway = false, mcap = false, las = false;
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

// What was written, what was left out, and what went wrong on the way.
void PrintExported(const ExportFlags& flags, const std::string& out, const ExportedLog& exported) {
  for (const auto& [name, topic] : exported.topics) {
    std::printf("%s  %s  %lld messages\n", Printable(name).c_str(), topic.schema.c_str(),
                static_cast<long long>(topic.messages));
  }
  for (const auto& [channel, count] : exported.left_out) {
    std::printf("left out: %s, %lld messages\n", Printable(channel).c_str(),
                static_cast<long long>(count));
  }
  if (exported.torn_sweeps > 0) {
    std::fprintf(stderr, "%s: %lld sweeps are not whole: lines of them, or the end, never came\n",
                 flags.dir.c_str(), static_cast<long long>(exported.torn_sweeps));
  }
  if (exported.dropped > 0) {
    std::fprintf(stderr, "%s: %lld messages dropped; last problem: %s\n", flags.dir.c_str(),
                 static_cast<long long>(exported.dropped), exported.last_problem.c_str());
  }
  if (exported.unreadable_bytes > 0) {
    std::fprintf(stderr, "%s: %lld bytes belong to no whole message; was the logger killed?\n",
                 flags.dir.c_str(), static_cast<long long>(exported.unreadable_bytes));
  }
  std::printf("wrote %s\n", out.c_str());
}

// lcm-logger names its logs lcmlog-2025-11-25.00, .01, ...: what is behind the dot tells them
// apart.
std::filesystem::path McapOf(std::filesystem::path log) {
  const std::string extension = log.extension().string();
  if (extension == ".lcmlog" || extension == ".log") return log.replace_extension(".mcap");
  return log += ".mcap";
}

int RunMcap(const ExportFlags& flags) {
  if (!flags.calibration.empty() || flags.anyway) {
    throw UsageError("--calibration and --anyway are of a session; a log has its own calibrations");
  }
  const FrameNames frames = FramesOf(flags);
  const std::filesystem::path out = PathOr(flags.out, McapOf(flags.dir));
  std::error_code error;
  if (std::filesystem::equivalent(flags.dir, out, error)) {
    throw InputError(out.string() + ": is the log itself; say another --out");
  }
  CheckWritable(out);
  PrintExported(flags, out,
                ExportLog(flags.dir, out, {frames.lidar, frames.cameras}, Tenths("exporting")));
  return EndsWith(true);
}

void RequireLas(const std::filesystem::path& out) {
  if (LasKindOf(out)) return;
  throw UsageError("--out is \"" + out.filename().string() +
                   "\"; --las writes FILE.las, FILE.laz or FILE.copc.laz");
}

int RunLas(const ExportFlags& flags) {
  if (!flags.calibration.empty() || flags.anyway || !flags.lidar_frame.empty() ||
      !flags.camera_frames.empty()) {
    throw UsageError(
        "--calibration, --anyway and names of frames are of a session, not of a cloud");
  }
  const std::filesystem::path in = flags.dir;
  const std::filesystem::path out =
      PathOr(flags.out, std::filesystem::path(in).replace_extension(".las"));
  RequireLas(out);
  CheckWritable(out);
  const std::string bytes = ReadWholeFile(in, kMostPointsBytes);
  std::size_t points = 0;
  if (IsMapPly(bytes)) {
    const MapCloud map = ParseMapPly(bytes, in.string());
    WriteLas(out, map);
    points = map.size();
  } else {
    const RgbdtCloud cloud = ParseFused(bytes, in.string());
    WriteLas(out, cloud);
    points = cloud.size();
  }
  std::printf("%zu points, in metres, no coordinate system; wrote %s\n", points, out.c_str());
  return EndsWith(true);
}

// A calibration alone does not tell the cameras' kinds, sizes and lenses.
void RequireSession(const std::filesystem::path& dir) {
  if (!std::filesystem::is_directory(dir) || std::filesystem::exists(dir / "rig.textproto")) return;
  throw InputError(dir.string() +
                   ": holds no rig.textproto; expected the session directory that was calibrated, "
                   "with --calibration FILE where the result lies elsewhere; for a log say --mcap, "
                   "for a cloud --las");
}

int RunExport(const ExportFlags& flags) {
  if (flags.mcap && flags.las) throw UsageError("--mcap is of a log, --las of a cloud: give one");
  if (flags.mcap) return RunMcap(flags);
  if (flags.las) return RunLas(flags);
  const std::filesystem::path dir = flags.dir;
  RequireSession(dir);
  const std::filesystem::path out =
      flags.out.empty() ? OwnFolder(dir, "export") : std::filesystem::path(flags.out);
  if (std::filesystem::exists(dir)) CheckWritable(out / "calibration");
  const CalibrationFiles files = FilesOf(dir, flags.calibration, flags.anyway);
  const Rig rig = ReadRig(files.rig);
  const Calibration calibration = ReadCalibrationOf(files);
  PrintWarnings(RequireSound(calibration, rig, files.Names(), files.HowToUse(), Further::kUsed));
  PrintDoubts(calibration, rig, files.calibration);
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
      "file and URDF, Autoware's sensor_kit_calibration.yaml, OpenCV YAML, Kalibr's camchain, a\n"
      "function of MATLAB. Each file states its direction. A calibration that is not to be used,\n"
      "or was made with another rig, is refused.\n"
      "With --mcap, a log of lcm-logger as an MCAP that Foxglove, Rerun and PlotJuggler open: "
      "sweeps,\n"
      "fused clouds, images, lenses, transforms, poses and what the processes said.\n"
      "With --las, a fused cloud or a map (PLY, PCD) as LAS 1.4 for CloudCompare, QGIS and PDAL: "
      "metres\n"
      "in steps of 0.1 mm, no coordinate system, colour, temperature [K] as an extra dimension.\n"
      "The ending of --out decides: FILE.las, FILE.laz (compressed without loss) or FILE.copc.laz\n"
      "(COPC: a LAZ for viewers that load what they show).\n"
      "Examples: rgbdt export out/demo/session --lidar-frame velodyne \\\n"
      "            --camera-frame rgb=camera_optical_frame\n"
      "          rgbdt export --mcap out/demo/session.lcmlog\n"
      "          rgbdt export --las out/demo/fused.ply --out out/demo/fused.laz",
      [flags] { return RunExport(*flags); });
  verb->Required("DIR", &flags->dir,
                 "session directory; with --mcap: the log; with --las: the cloud");
  verb->Flag("--mcap", &flags->mcap, "a log as an MCAP of Foxglove's messages");
  verb->Flag("--las", &flags->las, "a fused cloud or a map as LAS 1.4, LAZ or COPC");
  verb->Option("--calibration", &flags->calibration, "default: DIR/calibration.textproto");
  verb->Option("--out", &flags->out,
               "where to write; default: DIR/export, with --mcap the\nlog's name with .mcap, with "
               "--las the cloud's with .las");
  verb->Option("--lidar-frame", &flags->lidar_frame,
               "what ROS calls the LIDAR's frame; default: its name in the rig file");
  verb->Option("--camera-frame", &flags->camera_frames,
               "CAMERA=FRAME: what ROS calls a camera's optical frame (x right, y down, z "
               "forward);\nmay be given again; default: CAMERA_optical_frame");
  AddAnyway(verb, &flags->anyway, "its verdict is `do not use`, or the rig is another");
}

}  // namespace rgbdt
