#include "calib/methods/detect_session.h"

#include <exception>
#include <mutex>

#include "calib/methods/detect_view.h"
#include "calib/model/parallel.h"

namespace rgbdt {
namespace {

std::vector<Observation> Rejected(const Rig& rig, const std::string& view, const std::string& why) {
  std::vector<Observation> observations;
  for (const CameraSpec& camera : rig.cameras) {
    Observation observation;
    observation.view = view;
    observation.camera = camera.name;
    observation.rejected = why;
    observations.push_back(std::move(observation));
  }
  return observations;
}

std::string Summary(const std::vector<Observation>& observations) {
  std::string text;
  for (const Observation& o : observations) {
    text += (text.empty() ? "" : "; ") + o.camera + ": " +
            (o.usable() ? (o.heldout ? "board found (held out)" : "board found")
                        : "rejected, " + o.rejected);
  }
  return text;
}

}  // namespace

SessionDetection DetectSession(const Session& session, const std::string& method,
                               const Progress& progress) {
  const std::size_t count = session.views.size();
  std::vector<std::vector<Observation>> by_view(count);
  std::vector<std::string> unreadable(count);
  std::size_t done = 0;
  std::mutex mutex;
  ForEach(static_cast<int>(count), 0, [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    const std::string& name = session.views[i];
    try {
      by_view[i] = DetectView(session.rig, ReadView(session, name), method);
    } catch (const std::exception& e) {
      unreadable[i] = e.what();
      by_view[i] = Rejected(session.rig, name, e.what());
    }
    const std::lock_guard<std::mutex> lock(mutex);
    progress("[" + std::to_string(++done) + "/" + std::to_string(count) + "] view " + name + ": " +
             Summary(by_view[i]));
  });

  SessionDetection detection;
  for (std::size_t i = 0; i < count; ++i) {
    for (Observation& o : by_view[i]) detection.observations.push_back(std::move(o));
    if (!unreadable[i].empty()) {
      detection.unreadable.push_back("view " + session.views[i] + ": " + unreadable[i]);
    }
  }
  return detection;
}

}  // namespace rgbdt
