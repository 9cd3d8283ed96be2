#include "calib/methods/detect_session.h"

#include <exception>
#include <mutex>

#include "calib/methods/detect_view.h"
#include "calib/model/parallel.h"

namespace rgbdt {
namespace {

ViewDetection Unreadable(const Rig& rig, const std::string& view, const std::string& why) {
  ViewDetection detection;
  detection.view = view;
  for (const CameraSpec& camera : rig.cameras) {
    detection.images.push_back({camera.name, 0, std::nullopt, why, 0});
  }
  detection.cloud.why_not = why;
  return detection;
}

}  // namespace

SessionDetection DetectSession(const Session& session, const std::string& method,
                               const Progress& progress) {
  const std::size_t count = session.views.size();
  std::vector<ViewDetection> detections(count);
  std::vector<std::string> unreadable(count);
  std::size_t done = 0;
  std::mutex mutex;
  ForEach(static_cast<int>(count), 0, [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    const std::string& name = session.views[i];
    try {
      detections[i] = DetectView(session.rig, ReadView(session, name), method);
    } catch (const std::exception& e) {
      unreadable[i] = e.what();
      detections[i] = Unreadable(session.rig, name, e.what());
    }
    const std::lock_guard<std::mutex> lock(mutex);
    progress("[" + std::to_string(++done) + "/" + std::to_string(count) + "] view " + name + ": " +
             (unreadable[i].empty() ? BriefReport(detections[i]) : "not read") +
             (detections[i].heldout ? " (held out)" : ""));
  });

  SessionDetection detection{std::move(detections), {}};
  for (std::size_t i = 0; i < count; ++i) {
    if (!unreadable[i].empty()) {
      detection.unreadable.push_back("view " + session.views[i] + ": " + unreadable[i]);
    }
  }
  return detection;
}

}  // namespace rgbdt
