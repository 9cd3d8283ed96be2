#include "services/nodes/unwritten_views.h"

#include <algorithm>
#include <exception>
#include <utility>

#include "calib/files/check_writable.h"
#include "calib/files/session/session_dir.h"
#include "services/nodes/earlier_views.h"

namespace rgbdt {
namespace {

constexpr std::uintmax_t kMegabyte = 1'000'000;
constexpr std::uintmax_t kPointBytes = 40;  // of cloud.pcd, at most
constexpr char kWayOut[] = "; make room there, or the folder writable";

// More than its files take, which are compressed.
std::uintmax_t BytesOf(const View& view) {
  std::uintmax_t bytes = kMegabyte + kPointBytes * view.cloud.points.size();
  for (const LidarCloud& further : view.further_clouds) {
    bytes += kPointBytes * further.cloud.points.size();
  }
  for (const Image& image : view.images) bytes += image.pixels.total() * image.pixels.elemSize();
  return bytes;
}

}  // namespace

// Before the first view: an image of each camera.
UnwrittenViews::UnwrittenViews(std::filesystem::path directory, const Rig& rig)
    : directory_(std::move(directory)), view_bytes_(kMegabyte) {
  for (const CameraSpec& camera : rig.cameras) {
    view_bytes_ += static_cast<std::uintmax_t>(camera.width) * camera.height;
  }
}

void UnwrittenViews::Add(View view) {
  view_bytes_ = std::max(view_bytes_, BytesOf(view));
  views_[view.name] = std::move(view);
}

void UnwrittenViews::Drop(const std::string& view) {
  views_.erase(view);
  detections_.erase(view);
  if (empty()) why_.clear();
}

const View* UnwrittenViews::Find(const std::string& view) const {
  const auto found = views_.find(view);
  return found == views_.end() ? nullptr : &found->second;
}

void UnwrittenViews::Write(Utime now) {
  tried_ = now;
  why_.clear();
  try {
    for (auto view = views_.begin(); view != views_.end(); view = views_.erase(view)) {
      WriteView(directory_, view->second);
    }
    for (auto it = detections_.begin(); it != detections_.end(); it = detections_.erase(it)) {
      WriteDetection(directory_, it->second);
    }
    if (left_out_) WriteLeftOut(directory_, *left_out_);
    left_out_.reset();
  } catch (const std::exception& e) {
    why_ = e.what();
  }
}

std::string UnwrittenViews::What() const {
  std::string names;
  for (const auto& [name, view] : views_) names += (names.empty() ? "view " : ", ") + name;
  if (!names.empty()) return names;
  if (!detections_.empty()) return "the detection of view " + detections_.begin()->first;
  return "which views are left out";
}

std::string UnwrittenViews::Trouble() const {
  if (empty()) return {};
  return What() + " is kept in memory: " + why_ + kWayOut + "; it is tried again every " +
         std::to_string(kRetry / kMicrosecondsPerSecond) + " s";
}

std::string UnwrittenViews::Lost() const {
  return empty() ? "" : What() + " is lost, as it could not be written: " + why_;
}

std::string UnwrittenViews::WhyNoRoom(const std::string& view) const {
  if (!empty()) return Trouble();
  try {
    CheckWritable(directory_ / "views" / view);
    const std::uintmax_t free_bytes = std::filesystem::space(directory_).available;
    if (free_bytes >= view_bytes_) return {};
    return "only " + std::to_string(free_bytes / kMegabyte) + " MB are free in " +
           directory_.string() + ", a view may take " +
           std::to_string(view_bytes_ / kMegabyte + 1) + " MB; make room there";
  } catch (const std::exception& e) {
    return e.what() + std::string(kWayOut);
  }
}

}  // namespace rgbdt
