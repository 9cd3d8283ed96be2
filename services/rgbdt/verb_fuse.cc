#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "calib/files/check_writable.h"
#include "calib/files/image_files.h"
#include "calib/files/points/cloud_files.h"
#include "calib/files/schema/calibration_file.h"
#include "calib/files/session/session_dir.h"
#include "calib/fuse/fuse.h"
#include "calib/fuse/range_correction.h"
#include "calib/model/errors.h"
#include "calib/present/pictures/cloud_picture.h"
#include "services/rgbdt/verbs.h"

namespace rgbdt {
namespace {

struct FuseFlags {
  std::string dir, calibration, out, view;
  bool png = false, correct_ranges = false, anyway = false;
};

// The view's cloud with its points where they truly are, as the calibration in `file` has it.
Cloud WithTrueRanges(Cloud cloud, const Rig& rig, const Calibration& calibration,
                     const std::filesystem::path& file) {
  std::vector<std::optional<RangeErrors>> of_cameras;
  for (const CameraSpec& camera : rig.cameras) {
    const CameraCalibration* found = calibration.Find(camera.name);
    if (found != nullptr) of_cameras.push_back(found->range_errors);
  }
  const RangeCorrection correction = RangeCorrectionFor(of_cameras);
  if (!correction.errors) {
    throw InputError(file.string() +
                     " has no range_errors for --correct-ranges to correct by; calibrate with this "
                     "version and --method auto, or leave --correct-ranges out");
  }
  if (correction.cameras_differ) {
    std::fprintf(stderr,
                 "%s: cameras differ in their range_errors, the cloud is corrected by the first "
                 "camera's; calibrate the cameras together\n",
                 file.c_str());
  }
  return Corrected(std::move(cloud), *correction.errors);
}

void DrawPictures(const RgbdtCloud& fused, const std::string& title,
                  const std::filesystem::path& out) {
  DrawOptions options;
  options.title = title;
  WritePng(out / "fused_rgb.png", DrawCloud(fused, CloudColour::kRgb, options));
  std::printf(", fused_rgb.png");
  const bool thermal = std::any_of(fused.thermal_counts.begin(), fused.thermal_counts.end(),
                                   [](float counts) { return std::isfinite(counts); });
  if (!thermal) return;
  WritePng(out / "fused_thermal.png", DrawCloud(fused, CloudColour::kThermal, options));
  options.width = 1200;
  WritePng(out / "fused.png", DrawSideBySide(fused, options));
  std::printf(", fused_thermal.png, fused.png");
}

int RunFuse(const FuseFlags& flags) {
  const Session session = OpenSession(flags.dir);
  const std::filesystem::path out = PathOr(flags.out, session.root);
  CheckWritable(out / "fused.ply");
  const CalibrationFiles files = FilesOf(session.root, flags.calibration, flags.anyway);
  const Calibration calibration = ReadCalibrationOf(files);
  PrintWarnings(RequireSound(calibration, session.rig, files.Names(), files.HowToUse()));
  PrintDoubts(calibration, session.rig, files.calibration);
  const std::string view = flags.view.empty() ? session.views.back() : flags.view;
  if (std::find(session.views.begin(), session.views.end(), view) == session.views.end()) {
    throw InputError("session " + session.root.string() + " has no view \"" + view + "\"; it has " +
                     session.views.front() + " to " + session.views.back());
  }
  View seen = ReadView(session, view);
  if (flags.correct_ranges) {
    seen.cloud = WithTrueRanges(std::move(seen.cloud), session.rig, calibration, files.calibration);
  }
  const RgbdtCloud fused = FuseView(session.rig, calibration, seen);
  if (fused.points.empty()) throw InputError("view " + view + " has no points that returned");
  const auto coloured = std::count_if(fused.valid.begin(), fused.valid.end(),
                                      [](std::uint32_t valid) { return valid != 0; });
  WritePly(out / "fused.ply", fused);
  WritePcd(out / "fused.pcd", fused);
  std::printf("view %s: %zu points%s, %.0f%% seen by a camera; wrote fused.ply, fused.pcd",
              view.c_str(), fused.size(), flags.correct_ranges ? ", ranges corrected" : "",
              100.0 * static_cast<double>(coloured) / static_cast<double>(fused.size()));
  if (flags.png) DrawPictures(fused, "view " + view, out);
  std::printf(" to %s\n", out.c_str());
  return EndsWith(true);
}

}  // namespace

void AddFuse(CommandLine* program) {
  auto flags = std::make_shared<FuseFlags>();
  CommandLine* verb = program->Verb(
      "fuse",
      "Colours a view's cloud with its images: x, y, z [m] in the LIDAR frame, "
      "colour, temperature\n"
      "[K], which cameras saw it. Writes fused.ply and fused.pcd. A calibration that\n"
      "is not to be used, or was made with another rig, is refused.\n"
      "Example: rgbdt fuse out/demo/session --view 0003 --png",
      [flags] { return RunFuse(*flags); });
  verb->Required("DIR", &flags->dir, "session directory");
  verb->Option("--view", &flags->view, "which view; default: the last");
  verb->Option("--calibration", &flags->calibration, "default: DIR/calibration.textproto");
  verb->Option("--out", &flags->out, "where to write; default: DIR");
  verb->Flag("--correct-ranges", &flags->correct_ranges,
             "puts points where they truly are, by what the calibration found the LIDAR's ranges\n"
             "and beams to be off by");
  AddAnyway(verb, &flags->anyway, "its verdict is `do not use`, or the rig is another");
  verb->Flag("--png", &flags->png,
             "also draw the cloud: fused_rgb.png, fused_thermal.png,\n"
             "and both in one, fused.png");
}

}  // namespace rgbdt
