#include "services/import/import_log.h"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "calib/camera/packed.h"
#include "calib/files/atomic_file.h"
#include "calib/files/image_files.h"
#include "calib/model/errors.h"
#include "calib/model/livox.h"
#include "calib/scan_assembly/sweep_chunks.h"
#include "services/import/timed_log.h"
#include "services/messages/limits.h"

namespace rgbdt {
namespace {

// A message of the bag that goes into the log.
struct Source {
  Utime until = 0;  // nothing that comes later in the bag is heard before this
  Stamped stamped;
  const TopicChoice::Camera* camera = nullptr;  // none: a cloud
  const CameraSpec* spec = nullptr;             // of the camera
};

// Of a Livox each second's middle: what is measured within half a second of it is one cloud.
std::vector<Source> CloudsOf(const BagSurvey::Topic& topic) {
  std::vector<Source> clouds;
  if (!topic.livox) {
    for (const Stamped& stamped : topic.stamped) clouds.push_back({stamped.utime, stamped});
    return clouds;
  }
  constexpr Utime kHalf = kLivoxCloudUs / 2;
  Utime middle = topic.stamped.empty() ? 0 : topic.stamped.front().utime + kHalf;
  for (const Stamped& stamped : topic.stamped) {
    const Utime later = stamped.utime - middle + kHalf;
    if (later >= kLivoxCloudUs) middle += later / kLivoxCloudUs * kLivoxCloudUs;
    if (!clouds.empty() && clouds.back().stamped.utime == middle) continue;
    clouds.push_back({middle + kHalf, {middle, stamped.place}});
  }
  return clouds;
}

const CameraSpec* CameraOf(const std::optional<LogRig>& rig, const std::string& name) {
  return rig ? rig->rig.FindCamera(name) : nullptr;
}

// By their times.
std::vector<Source> SourcesOf(const TopicChoice& choice, const std::optional<LogRig>& rig) {
  std::vector<Source> sources = CloudsOf(*choice.lidar.clouds);
  for (const TopicChoice::Camera& camera : choice.cameras) {
    const CameraSpec* spec = CameraOf(rig, camera.name);
    if (spec == nullptr) continue;
    for (const Stamped& image : camera.images->stamped) {
      sources.push_back({image.utime, image, &camera, spec});
    }
  }
  std::stable_sort(sources.begin(), sources.end(),
                   [](const Source& a, const Source& b) { return a.until < b.until; });
  return sources;
}

void AddCloud(const Cloud& cloud, Utime least, TimedLog* log) {
  // A time that is none of a sweep's is no reason to hold a cloud back.
  constexpr Utime kLongestSweep = 10 * kMicrosecondsPerSecond;
  Utime heard = std::max(least, cloud.sweep_utime);
  for (const Utime utime : cloud.utime) {
    if (utime < cloud.sweep_utime + kLongestSweep) heard = std::max(heard, utime);
  }
  for (CloudChunk& chunk : SplitSweep(cloud)) log->Add(std::move(chunk), heard);
}

// Colours may come raw in one bag and compressed in another; counts are temperatures by the rig.
void RequireOfCamera(const Image& image, const CameraSpec& spec, const std::string& topic) {
  const auto size = [](int width, int height) {
    return std::to_string(width) + "x" + std::to_string(height);
  };
  const bool alike = image.pixels.cols == spec.width && image.pixels.rows == spec.height;
  const bool thermal = spec.kind == CameraKind::kThermal;
  if (alike && (!thermal || image.format == spec.format)) return;
  throw InputError(topic + ": is " + size(image.pixels.cols, image.pixels.rows) + " " +
                   NameOf(image.format) + ", and camera " + spec.name + " of the session " +
                   size(spec.width, spec.height) + " " + NameOf(spec.format) +
                   "; is it another camera's?");
}

// As it fits the bus: raw where it may be, and compressed where the bag has it so.
Image Packed(Image image, bool compressed) {
  const std::size_t bytes = image.pixels.total() * image.pixels.elemSize();
  constexpr std::size_t kHead = 1000;  // of the message
  if (!compressed && bytes + kHead < kMaxMessageBytes) return image;
  return Packed(std::move(image));
}

}  // namespace

WrittenLog WriteLog(BagReader* bag, const TopicChoice& choice, const std::optional<LogRig>& rig,
                    const CloudReader& read_cloud, const std::filesystem::path& path,
                    const std::function<void(double)>& progress) {
  const std::vector<Source> sources = SourcesOf(choice, rig);
  TimedLog log(path);
  WrittenLog written;
  std::map<std::string, std::int64_t> images_of;
  Utime rig_due = 0;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const Source& source = sources[i];
    log.WriteUntil(source.until);
    if (rig && source.until >= rig_due) {
      log.AddRig(rig->rig, rig->calibration, source.until);
      rig_due = source.until + kMicrosecondsPerSecond;
    }
    try {
      if (source.camera == nullptr) {
        Cloud cloud = read_cloud(source.stamped);
        written.untimed += cloud.utime.empty() ? 1 : 0;
        written.other_clock += ByHeadersClock(&cloud) ? 1 : 0;
        AddCloud(cloud, source.until, &log);
        ++written.clouds;
      } else {
        Image image = ReadImageAsItIs(bag, *source.camera, source.spec->kind, source.stamped);
        const BagSurvey::Topic& topic = *source.camera->images;
        RequireOfCamera(image, *source.spec, topic.topic.name);
        image.radiometry = source.spec->radiometry;
        image = Packed(std::move(image), topic.data == BagData::kCompressedImage);
        const Utime taken = image.utime;
        log.Add(std::move(image), taken);
        ++images_of[source.spec->name];
        ++written.images;
      }
    } catch (const InputError& error) {
      ++written.unreadable;
      written.last_problem = error.what();
    }
    if (progress) progress(static_cast<double>(i + 1) / static_cast<double>(sources.size()));
  }
  if (written.clouds == 0) {
    throw InputError("no cloud of the bag can be used" +
                     (written.last_problem.empty() ? "" : ": " + written.last_problem));
  }
  for (const TopicChoice::Camera& camera : choice.cameras) {
    if (CameraOf(rig, camera.name) == nullptr || images_of[camera.name] > 0) continue;
    throw InputError("no image of camera " + camera.name + " can be used: " + written.last_problem);
  }
  log.Close();
  return written;
}

}  // namespace rgbdt
