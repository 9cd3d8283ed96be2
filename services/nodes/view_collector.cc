#include "services/nodes/view_collector.h"

#include <algorithm>

#include "calib/model/said_again.h"
#include "services/messages/limits.h"

namespace rgbdt {
namespace {

using Seconds = std::map<Utime, Image>;

// Of a time that is past, whatever the clock says.
bool IsSaidAgain(const Image& image) { return image.seq == kSaidAgain; }

constexpr std::size_t kMostRawBytes = kMaxMessageBytes - 64 * 1024;  // the rest of its message

std::size_t BytesOf(const Image& image) { return image.pixels.total() * image.pixels.elemSize(); }

// Those from `from` to `to`, of one sweep, until they are few enough: the first two stay (it may
// have begun between them), and those of every second, fourth, ... second, so that the sweep's
// middle has one near.
void Thin(Seconds::iterator from, Seconds::iterator to, Seconds* seconds) {
  auto count = static_cast<std::size_t>(std::distance(from, to));
  if (count < ViewCollector::kLeastOfSweep) return;
  const std::size_t most =
      std::clamp(ViewCollector::kMostBytes / std::max<std::size_t>(1, BytesOf(from->second)),
                 ViewCollector::kLeastOfSweep, ViewCollector::kMostOfSweep);
  for (Utime stride = 2; count > most; stride *= 2) {
    for (auto at = std::next(from, 2); at != to;) {
      const bool stays = at->first % stride == 0 || IsSaidAgain(at->second);
      count -= stays ? 0 : 1;
      at = stays ? std::next(at) : seconds->erase(at);
    }
  }
}

}  // namespace

void ViewCollector::Add(const Image& image) {
  if (image.shutter_correcting) return;
  KeepForSweep(image);
  std::deque<Image>& kept = images_[image.camera];
  const bool reset = !kept.empty() && image.utime < kept.back().utime - kClockReset;
  if (reset && !IsSaidAgain(image)) kept.clear();
  const auto later = std::find_if(kept.begin(), kept.end(),
                                  [&](const Image& other) { return other.utime >= image.utime; });
  if (later != kept.end() && later->utime == image.utime) return;
  kept.insert(later, image);
  // While a view is being put together its own image must stay: it is the first at or after the
  // command, so newer ones go first. Otherwise the newest stay.
  if (kept.size() <= kKept) return;
  if (capture_ && kept[kept.size() - 2].utime >= capture_->utime) {
    kept.pop_back();
  } else {
    kept.pop_front();
  }
}

// The first image of each second, whatever order they came in.
void ViewCollector::KeepForSweep(const Image& image) {
  if (during_ == During::kForget) return;
  std::map<Utime, Image>& seconds = seconds_[image.camera];
  const Utime second = image.utime / kMicrosecondsPerSecond;
  const bool again = IsSaidAgain(image);
  if (!again && !seconds.empty() &&
      second < seconds.rbegin()->first - kClockReset / kMicrosecondsPerSecond &&
      second < seconds.begin()->first) {
    seconds.clear();
  }
  const auto found = seconds.find(second);
  if (found == seconds.end()) {
    seconds.emplace(second, image);
  } else if (again || (image.utime < found->second.utime && !IsSaidAgain(found->second))) {
    found->second = image;
  }
  ForgetSeconds(&seconds);
}

// A capture names the newest sweep that has ended; the next one may have begun.
void ViewCollector::ForgetSeconds(std::map<Utime, Image>* seconds) const {
  const Utime tail = seconds->rbegin()->first - kTail;
  std::vector<Utime> begins = sweeps_.Newest(kSweepsKept);
  if (capture_) begins.push_back(capture_->sweep_utime);
  for (Utime& begin : begins) begin /= kMicrosecondsPerSecond;
  begins.push_back(tail + 1);
  std::sort(begins.begin(), begins.end());
  seconds->erase(seconds->begin(), seconds->lower_bound(begins.front()));
  for (std::size_t i = 0; i + 1 < begins.size() && begins[i] <= tail; ++i) {
    const Utime end = std::min(begins[i + 1], tail + 1);
    Thin(seconds->lower_bound(begins[i]), seconds->lower_bound(end), seconds);
  }
}

std::size_t ViewCollector::ImageBytes() const {
  std::size_t bytes = 0;
  for (const auto& [camera, kept] : images_) {
    for (const Image& image : kept) bytes += BytesOf(image);
  }
  for (const auto& [camera, seconds] : seconds_) {
    for (const auto& [second, image] : seconds) bytes += BytesOf(image);
  }
  return bytes;
}

// At most two: the first since the sweep's start, and the nearest to its middle. Where they were
// said again, those: of who chose from all.
std::vector<Image> ViewCollector::DuringSweep(const Image& at_capture) const {
  const Utime start = capture_->sweep_utime;
  const auto kept = seconds_.find(at_capture.camera);
  if (kept == seconds_.end() || start <= 0) return {};
  const Utime middle = start + (capture_->utime - start) / 2;
  const Image* first = nullptr;
  const Image* nearest = nullptr;
  const auto during = [&](const Image& image) {
    return image.utime >= start && image.utime < capture_->utime;
  };
  const bool again = std::any_of(kept->second.begin(), kept->second.end(), [&](const auto& second) {
    return during(second.second) && IsSaidAgain(second.second);
  });
  for (const auto& [second, image] : kept->second) {
    if (!during(image) || (again && !IsSaidAgain(image))) continue;
    if (first == nullptr) first = &image;
    if (nearest == nullptr || std::abs(image.utime - middle) < std::abs(nearest->utime - middle)) {
      nearest = &image;
    }
  }
  if (first == nullptr) return {};
  if (nearest == first) return {*first};
  return {*first, *nearest};
}

void ViewCollector::Add(const CornerSelection& picks) { picks_[picks.camera] = picks; }

void ViewCollector::Begin(const SessionCommand& capture) { capture_ = capture; }

void ViewCollector::Reset() {
  capture_.reset();
  sweeps_.Clear();
  picks_.clear();
}

const Image* ViewCollector::ImageOf(const std::string& camera) const {
  const auto kept = images_.find(camera);
  if (kept == images_.end() || !capture_) return nullptr;
  for (const Image& image : kept->second) {
    if (image.utime < capture_->utime) continue;
    return image.utime - capture_->utime <= kImageWait ? &image : nullptr;
  }
  return nullptr;
}

const Image* ViewCollector::Newest(const std::string& camera) const {
  const auto kept = images_.find(camera);
  return kept == images_.end() || kept->second.empty() ? nullptr : &kept->second.back();
}

const CornerSelection* ViewCollector::PicksOf(const std::string& camera, Utime image_utime) const {
  const auto found = picks_.find(camera);
  if (found == picks_.end() || found->second.image_utime != image_utime) return nullptr;
  return &found->second;
}

bool ViewCollector::PersonPicks(const std::string& camera) const {
  const auto& names = capture_->picked_cameras;
  return std::find(names.begin(), names.end(), camera) != names.end();
}

std::string ViewCollector::Missing(const Rig& rig) const {
  if (!capture_) return "";
  std::string missing;
  const auto add = [&](const std::string& what) {
    missing += (missing.empty() ? "" : ", ") + what;
  };
  if (!sweeps_.Ended(capture_->sweep_utime)) {
    add("the end of sweep " + std::to_string(capture_->sweep_utime));
  }
  for (const CameraSpec& camera : rig.cameras) {
    const Image* image = ImageOf(camera.name);
    if (image == nullptr) {
      add("an image of camera " + camera.name);
    } else if (PersonPicks(camera.name) && PicksOf(camera.name, image->utime) == nullptr) {
      add("picked corners for camera " + camera.name);
    }
  }
  return missing;
}

Messages ViewCollector::Again(const View& view) const {
  Messages again;
  std::vector<CloudChunk> chunks = sweeps_.ChunksOf(view.cloud.sweep_utime);
  if (chunks.empty()) return again;
  std::stable_partition(chunks.begin(), chunks.end(),
                        [](const CloudChunk& chunk) { return !chunk.sweep_end; });
  for (Image image : view.images) {
    if (BytesOf(image) > kMostRawBytes) image.format = PixelFormat::kPng;
    again.emplace_back(std::move(image));
  }
  for (const CornerSelection& picks : view.picks) again.emplace_back(picks);
  for (const CloudChunk& chunk : chunks) again.emplace_back(chunk);
  for (Message& message : again) SetSeq(kSaidAgain, &message);
  return again;
}

std::optional<View> ViewCollector::Take(const Rig& rig) {
  if (!capture_) return std::nullopt;
  // The cheap questions first: this is asked after every message.
  for (const CameraSpec& camera : rig.cameras) {
    const Image* image = ImageOf(camera.name);
    if (image == nullptr) return std::nullopt;
    if (PersonPicks(camera.name) && PicksOf(camera.name, image->utime) == nullptr) {
      return std::nullopt;
    }
  }
  std::optional<Cloud> cloud = sweeps_.Complete(capture_->sweep_utime);
  if (!cloud) return std::nullopt;
  View view;
  view.name = capture_->view;
  view.heldout = capture_->heldout;
  view.cloud = std::move(*cloud);
  for (const CameraSpec& camera : rig.cameras) {
    const Image* image = ImageOf(camera.name);
    view.images.push_back(*image);
    if (PersonPicks(camera.name)) view.picks.push_back(*PicksOf(camera.name, image->utime));
  }
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
    for (Image& image : DuringSweep(view.images[i])) view.images.push_back(std::move(image));
  }
  capture_.reset();
  return view;
}

}  // namespace rgbdt
