#include "calib/files/schema/calibration_use.h"

#include <algorithm>
#include <utility>

#include "calib/files/schema/rig_file.h"
#include "calib/model/errors.h"
#include "calib/model/verdict.h"

namespace rgbdt {
namespace {

constexpr char kAnywayHelps[] = ", or give --anyway to use it all the same";

Rig LidarOf(const Rig& sensors) {
  Rig rig;
  rig.lidar = sensors.lidar;
  return rig;
}

// What its images come as does not move a camera.
Rig RigOf(const CameraSpec& camera) {
  Rig rig;
  rig.cameras = {camera};
  rig.cameras[0].format = {};
  return rig;
}

void Replace(const std::string& from, const std::string& to, std::string* text) {
  const std::size_t at = text->find(from);
  if (at != std::string::npos) text->replace(at, from.size(), to);
}

void AddDifferences(const Rig& was, const Rig& is, std::vector<std::string>* lines) {
  for (std::string line : DifferencesOf(was, is)) {
    Replace("modified: ", "", &line);
    if (!was.cameras.empty()) Replace("camera[0].", "camera " + was.cameras[0].name + ": ", &line);
    lines->push_back(std::move(line));
  }
}

std::vector<std::string> ThrowUnlessAnyway(std::vector<std::string> against, Use use) {
  if (!against.empty() && use == Use::kIfSound) throw InputError(against.front());
  return against;
}

// Which LIDAR is the reference matters where there are several, and those that were calibrated are
// to be there; one that was not, or came later, changes nothing.
void AddLidarDifferences(const Calibration& calibration, const Rig& is,
                         std::vector<std::string>* lines) {
  const Rig& was = *calibration.sensors;
  const bool several = !was.further_lidars.empty() || !is.further_lidars.empty();
  if (several && was.lidar.name != is.lidar.name) {
    lines->push_back("the first lidar, in whose frame all is: \"" + was.lidar.name + "\" -> \"" +
                     is.lidar.name + "\"");
  }
  for (const LidarCalibration& lidar : calibration.lidars) {
    const auto found =
        std::find_if(is.further_lidars.begin(), is.further_lidars.end(),
                     [&](const LidarSpec& spec) { return spec.name == lidar.lidar; });
    if (found == is.further_lidars.end()) {
      lines->push_back("lidar " + lidar.lidar + ": not among the rig's LIDARs after the first");
    }
  }
}

}  // namespace

std::vector<std::string> SensorDifferences(const Calibration& calibration, const Rig& rig) {
  const Rig& was = *calibration.sensors;
  const Rig is = SensorsOf(rig);
  std::vector<std::string> lines;
  AddDifferences(LidarOf(was), LidarOf(is), &lines);
  AddLidarDifferences(calibration, is, &lines);
  for (const CameraCalibration& camera : calibration.cameras) {
    const CameraSpec* before = was.FindCamera(camera.camera);
    const CameraSpec* now = is.FindCamera(camera.camera);
    if (now == nullptr) {
      lines.push_back("camera " + camera.camera + ": not in the rig");
    } else if (before != nullptr) {
      AddDifferences(RigOf(*before), RigOf(*now), &lines);
    }
  }
  return lines;
}

std::string WhyAnotherRig(const Calibration& calibration, const Rig& rig, const UseNames& names) {
  if (calibration.rig_hash == rig.hash) return "";
  std::string differs;
  if (calibration.sensors) {
    const std::vector<std::string> lines = SensorDifferences(calibration, rig);
    if (lines.empty()) return "";
    differs = "; what differs, calibration -> rig: " + InOneLine(lines);
  } else if (calibration.rig_hash.empty()) {
    return "";
  } else {
    differs = "; what differs is not known, as only the rigs' hashes are: " + calibration.rig_hash +
              " -> " + rig.hash;
  }
  return names.calibration + " was made with another rig than " + names.rig + differs +
         ". Calibrate with this rig, or put back the rig that it was made with" + kAnywayHelps;
}

std::string WhyNotToUse(const CameraCalibration& camera, const std::string& name) {
  if (camera.converged()) return "";
  const bool judged = camera.status == SolveStatus::kContradicted && !camera.detail.empty();
  std::string why = judged ? camera.detail : camera.StatusText();
  while (!why.empty() && why.back() == '.') why.pop_back();
  return (name.empty() ? "" : name + ": ") + "the calibration of camera " + camera.camera +
         " is not to be used: " + why + ". Fix that and calibrate again" + kAnywayHelps;
}

std::string WhyNotToUse(const LidarCalibration& lidar, const std::string& name) {
  if (lidar.converged()) return "";
  std::string why = lidar.StatusText();
  while (!why.empty() && why.back() == '.') why.pop_back();
  return (name.empty() ? "" : name + ": ") + "the pose of LIDAR " + lidar.lidar +
         " is not to be used: " + why + ". Fix that and calibrate again" + kAnywayHelps;
}

std::vector<std::string> DoubtsOf(const Calibration& calibration, const Rig& rig,
                                  const std::string& name) {
  std::vector<std::string> doubts;
  if (calibration.sensors && calibration.sensors->lidar.name != rig.lidar.name) {
    doubts.push_back(name + " was made with LIDAR " + calibration.sensors->lidar.name +
                     ", and the rig's is " + rig.lidar.name +
                     ": if that is not the same one in the same place, calibrate again");
  }
  for (const CameraCalibration& camera : calibration.cameras) {
    if (!camera.converged() || camera.detail.rfind(kDoubtfulDetail, 0) != 0) continue;
    doubts.push_back(name + ": camera " + camera.camera + ": " + camera.detail);
  }
  return doubts;
}

std::vector<std::string> RequireSameRig(const Calibration& calibration, const Rig& rig,
                                        const UseNames& names, Use use) {
  const std::string why = WhyAnotherRig(calibration, rig, names);
  return ThrowUnlessAnyway(why.empty() ? std::vector<std::string>() : std::vector{why}, use);
}

std::vector<std::string> RequireSound(const Calibration& calibration, const Rig& rig,
                                      const UseNames& names, Use use, Further further) {
  std::vector<std::string> against = RequireSameRig(calibration, rig, names, use);
  for (const CameraCalibration& camera : calibration.cameras) {
    const std::string why = WhyNotToUse(camera, names.calibration);
    if (!why.empty()) against.push_back(why);
  }
  for (const LidarCalibration& lidar : calibration.lidars) {
    const std::string why = WhyNotToUse(lidar, names.calibration);
    if (!why.empty() && further == Further::kUsed) against.push_back(why);
  }
  return ThrowUnlessAnyway(std::move(against), use);
}

Report WithoutPoses(Report report, const std::string& why) {
  for (CameraReport& camera : report.cameras) {
    camera.calibration.status = SolveStatus::kNotSolved;
    camera.calibration.detail = why;
  }
  return report;
}

}  // namespace rgbdt
