#include <array>

#include "calib/files/atomic_file.h"
#include "calib/files/own_folder.h"
#include "calib/files/schema/calibration_file.h"
#include "calib/files/session/session_dir.h"
#include "calib/model/errors.h"

namespace rgbdt {
namespace {

namespace fs = std::filesystem;

// The first of them is what counts: a set without it is what a failed run left.
constexpr std::array<const char*, 3> kResults = {"calibration.textproto", "report.json",
                                                 "report.html"};

// "calibration.previous.textproto"
fs::path PreviousOf(const std::string& name) {
  const fs::path path(name);
  return path.stem().string() + ".previous" + path.extension().string();
}

bool PreviousIsThere(const fs::path& dir) {
  std::error_code ignored;
  for (const char* name : kResults) {
    if (fs::exists(dir / PreviousOf(name), ignored)) return true;
  }
  return false;
}

bool IsThatCamera(const Calibration& earlier, const CameraSpec& spec) {
  const CameraSpec* camera = earlier.sensors ? earlier.sensors->FindCamera(spec.name) : nullptr;
  return camera != nullptr && camera->kind == spec.kind && camera->width == spec.width &&
         camera->height == spec.height;
}

void Remove(const fs::path& path) {
  std::error_code error;
  fs::remove(path, error);
  if (error) throw InputError("cannot remove " + path.string() + ": " + error.message());
}

}  // namespace

std::string SetResultsAside(const fs::path& dir) {
  std::error_code ignored;
  std::string kept;
  const bool keep = fs::exists(dir / kResults[0], ignored) || !PreviousIsThere(dir);
  for (const char* name : kResults) {
    const fs::path previous = PreviousOf(name);
    if (keep) Remove(dir / previous);
    if (!fs::exists(dir / name, ignored)) continue;
    if (keep) {
      Rename(dir / name, dir / previous);
      kept += (kept.empty() ? "" : ", ") + previous.string();
    } else {
      Remove(dir / name);
    }
  }
  return kept.empty() ? ""
                      : "results of an earlier run are kept in " + dir.string() + " as " + kept;
}

std::string KeepTimings(const fs::path& dir, const Rig& rig, Report* report) {
  const fs::path path = dir / PreviousOf(kResults[0]);
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return "";
  std::string kept;
  try {
    const Calibration earlier = ReadCalibration(path);
    for (CameraReport& of : report->cameras) {
      CameraCalibration& camera = of.calibration;
      const CameraCalibration* before = earlier.Find(camera.camera);
      if (camera.timing || before == nullptr || !before->timing) continue;
      if (!IsThatCamera(earlier, rig.Camera(camera.camera))) continue;
      camera.timing = before->timing;
      kept += (kept.empty() ? "" : ", ") + camera.camera;
    }
  } catch (const InputError&) {  // what cannot be read has nothing to keep
  }
  return kept.empty() ? ""
                      : "`timing` of " + kept + " is that of " + path.filename().string() +
                            ": if a clock was set or a trigger changed since, rgbdt sync again";
}

std::string SetViewAside(const fs::path& dir, const std::string& view) {
  const fs::path views = OwnFolder(dir, "views");
  std::string name = "." + view + ".unfinished";
  for (int i = 2; fs::exists(views / name); ++i) {
    name = "." + view + ".unfinished-" + std::to_string(i);
  }
  Rename(views / view, views / name);
  return name;
}

}  // namespace rgbdt
