#include "services/rgbdt/import_to_log.h"

#include <algorithm>
#include <cstdio>

#include "calib/files/schema/calibration_file.h"
#include "calib/files/schema/rig_file.h"
#include "calib/model/errors.h"
#include "calib/model/text.h"
#include "services/rgbdt/verbs.h"

namespace rgbdt {
namespace {

// Which of the rig's cameras the bag has.
void TellCameras(const Rig& rig, const TopicChoice& choice) {
  bool any = false;
  std::string in_bag;
  for (const TopicChoice::Camera& camera : choice.cameras) {
    in_bag += (in_bag.empty() ? "" : ", ") + camera.name;
  }
  for (const CameraSpec& spec : rig.cameras) {
    const auto found =
        std::find_if(choice.cameras.begin(), choice.cameras.end(),
                     [&](const TopicChoice::Camera& camera) { return camera.name == spec.name; });
    if (found == choice.cameras.end()) {
      std::printf("camera %s of the rig: no images in the bag; --image %s=TOPIC says which are\n",
                  spec.name.c_str(), spec.name.c_str());
      continue;
    }
    any = true;
    std::printf("camera %s: %s\n", spec.name.c_str(), found->images->topic.name.c_str());
  }
  if (any) return;
  throw InputError("none of the rig's cameras is in the bag, whose cameras are " + in_bag +
                   "; say which is which by --image NAME=TOPIC");
}

}  // namespace

std::optional<LogRig> LogRigOf(const std::string& session) {
  if (session.empty()) return std::nullopt;
  const std::filesystem::path folder = session;
  LogRig rig{ReadRig(folder / "rig.textproto"), std::nullopt};
  const std::filesystem::path file = folder / "calibration.textproto";
  if (!std::filesystem::exists(file)) {
    std::printf("%s is not calibrated: the log has no calibration\n", folder.c_str());
    return rig;
  }
  rig.calibration = ReadCalibration(file);
  const UseNames names{file.string(), (folder / "rig.textproto").string()};
  RequireSameRig(*rig.calibration, rig.rig, names, Use::kIfSound);
  for (const std::string& why : RequireSound(*rig.calibration, rig.rig, names, Use::kAnyway)) {
    std::fprintf(stderr, "rgbdt: %s\n", why.c_str());  // who uses the log is to decide
  }
  PrintDoubts(*rig.calibration, rig.rig, file);
  return rig;
}

int ImportLog(const std::string& path, const std::optional<LogRig>& rig, const TopicChoice& choice,
              const CloudReader& read_cloud, BagReader* bag) {
  if (rig) TellCameras(rig->rig, choice);
  std::printf("lidar: %s, %s\n", choice.lidar.clouds->topic.name.c_str(),
              choice.lidar.clouds->what.c_str());
  const WrittenLog written =
      WriteLog(bag, choice, rig, read_cloud, path, Tenths("writing the log"));
  if (written.unreadable > 0) {
    std::printf("left over: %lld messages that cannot be read; the last: %s\n",
                static_cast<long long>(written.unreadable), written.last_problem.c_str());
  }
  if (written.untimed > 0) {
    std::printf(
        "%lld clouds: their points have no times, or none that are a sweep's in ns, us, ms or s; "
        "rgbdt sync, and the way of a rig that moves, need them\n",
        static_cast<long long>(written.untimed));
  }
  if (written.other_clock > 0) {
    std::printf(
        "%lld clouds: their points' times are of another clock than their headers'; the first "
        "point "
        "of each is taken for its header's time\n",
        static_cast<long long>(written.other_clock));
  }
  std::printf("wrote %s: %lld clouds, %lld images\n", path.c_str(),
              static_cast<long long>(written.clouds), static_cast<long long>(written.images));
  const std::string log = ForShell(path);
  if (!rig) {
    std::printf(
        "next: rgbdt map %s; with --session DIR the log has images and a calibration, too\n",
        log.c_str());
  } else {
    std::printf(
        "next: rgbdt map %s (of a drive), rgbdt refine %s (does the calibration hold?) or "
        "rgbdt sync %s (of a board that is waved)\n",
        log.c_str(), log.c_str(), log.c_str());
  }
  return EndsWith(true);
}

}  // namespace rgbdt
