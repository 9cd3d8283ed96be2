#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calib/files/schema/calibration_file.h"
#include "calib/files/schema/calibration_use.h"
#include "calib/files/schema/rig_file.h"
#include "calib/model/errors.h"
#include "calib/solve/compare.h"
#include "services/rgbdt/print_report.h"
#include "services/rgbdt/verbs.h"

namespace rgbdt {
namespace {

namespace fs = std::filesystem;

struct CompareFlags {
  std::vector<std::string> calibrations;
  std::string rig;
};

struct Named {
  std::string name;
  Calibration calibration;
};

Named ReadNamed(const std::string& name) {
  fs::path path = name;
  if (fs::is_directory(path)) path /= "calibration.textproto";
  if (!fs::exists(path)) {
    throw InputError(path.string() +
                     " is missing; name calibration files, or session directories " +
                     "that rgbdt calibrate has been run on");
  }
  return {name, ReadCalibration(path)};
}

// The one that the user named, or else what lies beside one of the calibrations.
std::optional<Rig> RigOf(const CompareFlags& flags) {
  if (!flags.rig.empty()) return ReadRig(flags.rig);
  for (const std::string& name : flags.calibrations) {
    const fs::path folder = fs::is_directory(name) ? fs::path(name) : fs::path(name).parent_path();
    if (fs::exists(folder / "rig.textproto")) return ReadRig(folder / "rig.textproto");
  }
  return std::nullopt;
}

std::string KindOf(const CameraSpec& camera) {
  return std::string(camera.kind == CameraKind::kThermal ? "thermal" : "colour") + ", " +
         std::to_string(camera.width) + "x" + std::to_string(camera.height);
}

// Of a LIDAR: whether it is turned, and of what make, where that is known.
bool IsAnotherLidar(const LidarSpec& a, const LidarSpec& b) {
  if (a.turned_scanner.has_value() != b.turned_scanner.has_value()) return true;
  return a.device.index() != 0 && b.device.index() != 0 && a.device.index() != b.device.index();
}

// Poses of other sensors are not to be compared: nothing moved.
void RequireSameSensors(const Named& a, const Named& b) {
  const Rig& was = *a.calibration.sensors;
  const Rig& is = *b.calibration.sensors;
  std::string other = IsAnotherLidar(was.lidar, is.lidar) ? "another LIDAR" : "";
  for (const CameraSpec& camera : was.cameras) {
    for (const CameraSpec& now : is.cameras) {
      if (!other.empty() || now.name != camera.name || KindOf(now) == KindOf(camera)) continue;
      if (a.calibration.Find(now.name) == nullptr || b.calibration.Find(now.name) == nullptr)
        continue;
      other = "another camera \"" + camera.name + "\": " + KindOf(camera) + " -> " + KindOf(now);
    }
  }
  if (other.empty()) return;
  throw InputError(a.name + " and " + b.name + " are calibrations of different rigs (" + other +
                   "); expected two of one rig");
}

// Which cameras are in one of them alone; empty: none.
std::string OnlyInOne(const Named& a, const Named& b) {
  std::string text;
  const auto add = [&](const Named& has, const Named& lacks) {
    for (const CameraCalibration& camera : has.calibration.cameras) {
      if (lacks.calibration.Find(camera.camera) != nullptr) continue;
      text +=
          (text.empty() ? "not compared: " : ", ") + camera.camera + " (only in " + has.name + ")";
    }
  };
  add(a, b);
  add(b, a);
  return text;
}

CalibrationComparison CompareAll(const Named& a, const Named& b, const std::optional<Rig>& rig) {
  CalibrationComparison out;
  out.a = a.name;
  out.b = b.name;
  out.utime_a = a.calibration.utime;
  out.utime_b = b.calibration.utime;
  out.same_rig = a.calibration.rig_hash == b.calibration.rig_hash;
  if (!out.same_rig && a.calibration.sensors && b.calibration.sensors) {
    RequireSameSensors(a, b);
    std::vector<std::string> differ = SensorDifferences(a.calibration, *b.calibration.sensors);
    // Those are told by themselves.
    differ.erase(std::remove_if(differ.begin(), differ.end(),
                                [&](const std::string& line) {
                                  return line.find(": not in the rig") != std::string::npos;
                                }),
                 differ.end());
    out.rigs_differ = InOneLine(differ);
  }
  out.not_compared = OnlyInOne(a, b);
  for (const CameraCalibration& camera : a.calibration.cameras) {
    const CameraCalibration* other = b.calibration.Find(camera.camera);
    if (other == nullptr) continue;
    out.cameras.push_back(Compare(camera, *other, rig ? &rig->Camera(camera.camera) : nullptr));
  }
  for (const Named* named : {&a, &b}) {
    if (named->calibration.lidars.empty()) continue;
    std::printf("%s: LIDARs beside the reference are not compared\n", named->name.c_str());
  }
  if (out.cameras.empty()) {
    throw InputError(a.name + " and " + b.name + " have no camera in common");
  }
  return out;
}

int RunCompare(const CompareFlags& flags) {
  if (flags.calibrations.size() < 2) throw UsageError("name two calibrations, or more");
  const std::optional<Rig> rig = RigOf(flags);
  const Named first = ReadNamed(flags.calibrations[0]);
  std::vector<CalibrationComparison> comparisons;
  for (std::size_t i = 1; i < flags.calibrations.size(); ++i) {
    comparisons.push_back(CompareAll(first, ReadNamed(flags.calibrations[i]), rig));
  }
  const bool same = PrintComparisons(comparisons);
  if (!rig) std::printf("in pixels: name the rig with --rig FILE\n");
  return EndsWith(same);
}

}  // namespace

void AddCompare(CommandLine* program) {
  auto flags = std::make_shared<CompareFlags>();
  CommandLine* verb = program->Verb(
      "compare",
      "Compares calibrations of one rig with the first one named: in degrees, millimetres and\n"
      "pixels, against what both state as their uncertainty.\n"
      "Example: rgbdt compare out/monday out/friday",
      [flags] { return RunCompare(*flags); });
  verb->Ends(ExitCode::kFailed,
             "failed, or a camera or its colours moved by more than chance does once in a hundred");
  verb->Required("CALIBRATION", &flags->calibrations,
                 "two or more: session directories, or calibration.textproto files");
  verb->Option("--rig", &flags->rig,
               "rig.textproto with the lenses; default: what lies beside one of them");
}

}  // namespace rgbdt
