#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "calib/files/image_files.h"
#include "calib/files/points/cloud_files.h"
#include "calib/files/schema/calibration_file.h"
#include "calib/files/session/session_dir.h"
#include "calib/fuse/fuse.h"
#include "calib/model/errors.h"
#include "calib/present/pictures/cloud_picture.h"
#include "services/rgbdt/verbs.h"

namespace rgbdt {
namespace {

struct FuseFlags {
  std::string dir, calibration, out, view;
  bool png = false;
};

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
  const Calibration calibration =
      ReadCalibration(PathOr(flags.calibration, session.root / "calibration.textproto"));
  const std::string view = flags.view.empty() ? session.views.back() : flags.view;
  if (std::find(session.views.begin(), session.views.end(), view) == session.views.end()) {
    throw InputError("session " + session.root.string() + " has no view \"" + view + "\"; it has " +
                     session.views.front() + " to " + session.views.back());
  }
  const RgbdtCloud fused = FuseView(session.rig, calibration, ReadView(session, view));
  if (fused.points.empty()) throw InputError("view " + view + " has no points that returned");
  const auto coloured = std::count_if(fused.valid.begin(), fused.valid.end(),
                                      [](std::uint32_t valid) { return valid != 0; });
  WritePly(out / "fused.ply", fused);
  WritePcd(out / "fused.pcd", fused);
  std::printf("view %s: %zu points, %.0f%% seen by a camera; wrote fused.ply, fused.pcd",
              view.c_str(), fused.size(),
              100.0 * static_cast<double>(coloured) / static_cast<double>(fused.size()));
  if (flags.png) DrawPictures(fused, "view " + view, out);
  std::printf(" to %s\n", out.c_str());
  return 0;
}

}  // namespace

void AddFuse(CommandLine* program) {
  auto flags = std::make_shared<FuseFlags>();
  CommandLine* verb =
      program->Verb("fuse",
                    "Colours a view's cloud with its images: x, y, z [m] in the LIDAR frame, "
                    "colour, temperature\n"
                    "[K], which cameras saw it. Writes fused.ply and fused.pcd.\n"
                    "Example: rgbdt fuse out/demo/session --view 0003 --png",
                    [flags] { return RunFuse(*flags); });
  verb->Required("DIR", &flags->dir, "session directory");
  verb->Option("--view", &flags->view, "which view; default: the last");
  verb->Option("--calibration", &flags->calibration, "default: DIR/calibration.textproto");
  verb->Option("--out", &flags->out, "where to write; default: DIR");
  verb->Flag("--png", &flags->png,
             "also draw the cloud: fused_rgb.png, fused_thermal.png,\n"
             "and both in one, fused.png");
}

}  // namespace rgbdt
