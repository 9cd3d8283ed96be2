#include "services/import/import_log.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <utility>
#include <vector>

#include "calib/model/errors.h"
#include "calib/model/livox.h"
#include "calib/scan_assembly/sweep_chunks.h"
#include "services/bus/log_writer.h"
#include "services/messages/codec.h"

namespace rgbdt {
namespace {

// A message of the bag that goes into the log.
struct Source {
  const Stamped* stamped = nullptr;
  const TopicChoice::Camera* camera = nullptr;  // none: a cloud
  CameraSpec spec{};                            // of the camera, with the format that the bag has
};

// Each second's middle: what is measured within half a second of it is one cloud.
std::vector<const Stamped*> CloudsOf(const BagSurvey::Topic& topic) {
  std::vector<const Stamped*> clouds;
  Utime next = topic.stamped.empty() ? 0 : topic.stamped.front().utime + kLivoxCloud_us / 2;
  for (const Stamped& stamped : topic.stamped) {
    if (topic.livox && stamped.utime < next) continue;
    next = std::max(next, stamped.utime) + kLivoxCloud_us;
    clouds.push_back(&stamped);
  }
  return clouds;
}

const CameraSpec* CameraOf(const std::optional<LogRig>& rig, const std::string& name) {
  if (!rig) return nullptr;
  for (const CameraSpec& camera : rig->rig.cameras) {
    if (camera.name == name) return &camera;
  }
  return nullptr;
}

// By their times.
std::vector<Source> SourcesOf(BagReader* bag, const TopicChoice& choice,
                              const std::optional<LogRig>& rig) {
  std::vector<Source> sources;
  for (const Stamped* cloud : CloudsOf(*choice.cloud)) sources.push_back({cloud, nullptr});
  for (const TopicChoice::Camera& camera : choice.cameras) {
    const CameraSpec* of_rig = CameraOf(rig, camera.name);
    if (of_rig == nullptr) continue;
    CameraSpec spec = *of_rig;
    spec.format = FormatOf(bag, camera);  // compressed in one bag, raw in another
    for (const Stamped& image : camera.images->stamped) sources.push_back({&image, &camera, spec});
  }
  std::stable_sort(sources.begin(), sources.end(), [](const Source& a, const Source& b) {
    return a.stamped->utime < b.stamped->utime;
  });
  return sources;
}

// What is heard at some time, in that order, whenever it was read.
class TimedLog {
 public:
  explicit TimedLog(const std::string& path) : log_(path) {}

  void Add(Message message, Utime heard) {
    const std::string channel = ChannelOf(message);
    SetSeq(seq_[channel]++, &message);
    waiting_.emplace(heard, std::pair(channel, Encode(message)));
  }
  // Nothing comes any more that was heard before this.
  void WriteUntil(Utime utime) {
    while (!waiting_.empty() && waiting_.begin()->first <= utime) WriteFirst();
  }
  void Close() {
    while (!waiting_.empty()) WriteFirst();
    log_.Close();
  }

 private:
  void WriteFirst() {
    const auto first = waiting_.begin();
    log_.Write(first->second.first, first->second.second, first->first);
    waiting_.erase(first);
  }

  LogWriter log_;
  std::map<std::string, std::int64_t> seq_;
  std::multimap<Utime, std::pair<std::string, Bytes>> waiting_;
};

void AddRig(const LogRig& rig, Utime utime, TimedLog* log) {
  log->Add(RigText{0, rig.rig.hash, rig.rig.text}, utime);
  if (!rig.calibration) return;
  const Calibration& calibration = *rig.calibration;
  for (const CameraCalibration& camera : calibration.cameras) {
    log->Add(
        CalibrationMessage{0, calibration.utime, calibration.rig_hash, calibration.method, camera},
        utime);
  }
}

// Whether the points' times are of another clock than their header's, as of a LIDAR that counts
// since it was switched on; the first point is then taken for the header's time.
bool SetRight(Cloud* cloud) {
  constexpr Utime kOneClock = 10 * kMicrosecondsPerSecond;  // longer than any sweep
  if (cloud->utime.empty()) return false;
  const Utime first = *std::min_element(cloud->utime.begin(), cloud->utime.end());
  const Utime later = cloud->sweep_utime - first;
  if (std::abs(later) < kOneClock) return false;
  for (Utime& utime : cloud->utime) utime += later;
  return true;
}

void AddCloud(const Cloud& cloud, TimedLog* log) {
  Utime heard = cloud.sweep_utime;
  for (const Utime utime : cloud.utime) heard = std::max(heard, utime);
  for (CloudChunk& chunk : SplitSweep(cloud)) log->Add(std::move(chunk), heard);
}

void AddImage(Image image, const CameraSpec& spec, bool compressed, TimedLog* log) {
  image.radiometry = spec.radiometry;
  if (compressed && image.format == PixelFormat::kBgr8) image.format = PixelFormat::kJpeg;
  if (compressed && image.format == PixelFormat::kMono16) image.format = PixelFormat::kPng;
  const Utime heard = image.utime;
  log->Add(std::move(image), heard);
}

// It has its name once it is whole.
class PartFile {
 public:
  explicit PartFile(const std::filesystem::path& path)
      : path_(path), part_(path.string() + ".part") {
    if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path());
  }
  ~PartFile() {
    std::error_code ignored;
    std::filesystem::remove(part_, ignored);
  }
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  const std::string& name() const { return part_; }
  void Keep() const { std::filesystem::rename(part_, path_); }

 private:
  std::filesystem::path path_;
  std::string part_;
};

}  // namespace

WrittenLog WriteLog(BagReader* bag, const TopicChoice& choice, const std::optional<LogRig>& rig,
                    const CloudReader& read_cloud, const std::filesystem::path& path,
                    const std::function<void(double)>& progress) {
  const std::vector<Source> sources = SourcesOf(bag, choice, rig);
  const PartFile file(path);
  TimedLog log(file.name());
  WrittenLog written;
  Utime rig_due = 0;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const Source& source = sources[i];
    const Utime utime = source.stamped->utime;
    log.WriteUntil(utime);
    if (rig && utime >= rig_due) {
      AddRig(*rig, utime, &log);
      rig_due = utime + kMicrosecondsPerSecond;
    }
    try {
      if (source.camera == nullptr) {
        Cloud cloud = read_cloud(*source.stamped);
        written.other_clock += SetRight(&cloud) ? 1 : 0;
        AddCloud(cloud, &log);
        ++written.clouds;
      } else {
        AddImage(ReadImage(bag, *source.camera, source.spec, *source.stamped), source.spec,
                 source.camera->images->data == BagData::kCompressedImage, &log);
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
  log.Close();
  file.Keep();
  return written;
}

}  // namespace rgbdt
