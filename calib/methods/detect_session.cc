#include "calib/methods/detect_session.h"

#include <algorithm>
#include <exception>
#include <mutex>
#include <numeric>
#include <optional>
#include <utility>

#include "calib/detect/cloud/range_grid.h"
#include "calib/methods/board_check.h"
#include "calib/methods/detect_view.h"
#include "calib/model/errors.h"
#include "calib/model/parallel.h"

namespace rgbdt {
namespace {

constexpr std::size_t kListed = 100;

ViewDetection Unreadable(const Rig& rig, const std::string& view, const std::string& why) {
  ViewDetection detection;
  detection.view = view;
  for (const CameraSpec& camera : rig.cameras) {
    detection.images.push_back({camera.name, 0, std::nullopt, why, 0});
  }
  detection.cloud.why_not = why;
  for (const LidarSpec& lidar : rig.further_lidars) {
    detection.further_clouds.push_back({lidar.name, {{}, why, 0}});
  }
  return detection;
}

// Some of a camera's images, from the first view to the last; of those that can be read.
std::vector<Image> SomeImages(const Session& session, const std::string& camera) {
  constexpr std::size_t kImages = 3;
  std::vector<Image> images;
  const std::size_t count = std::min(kImages, session.views.size());
  for (std::size_t i = 0; i < count; ++i) {
    const std::string& name = session.views[(2 * i + 1) * session.views.size() / (2 * count)];
    try {
      for (Image& image : ReadImages(session, name).images) {
        if (image.camera == camera) images.push_back(std::move(image));
      }
    } catch (const InputError&) {
    }
  }
  return images;
}

bool BoardIsSeen(const std::vector<ViewDetection>& detections, const std::string& camera) {
  return std::any_of(detections.begin(), detections.end(), [&](const ViewDetection& view) {
    const ImageDetection* image = view.Find(camera);
    return image != nullptr && image->edges;
  });
}

// Of a camera that sees no board in any view, another one may be seen: then that is why.
void SayWhatIsSeenInstead(const Session& session, const CameraSpec& camera,
                          std::vector<ViewDetection>* detections) {
  const Target& target = session.rig.target;
  if (!target.HasPattern() || BoardIsSeen(*detections, camera.name)) return;
  const BoardCheck check = CheckBoard(camera, target, SomeImages(session, camera.name));
  if (!check.instead) return;
  for (ViewDetection& view : *detections) {
    for (ImageDetection& image : view.images) {
      const bool read = image.why_not != view.cloud.why_not;
      if (image.camera == camera.name && read) image.why_not = OtherBoard(target, check);
    }
  }
}

bool IsMisnumbered(const Cloud& cloud) {
  return !cloud.ring.empty() && RangeGrid(cloud).misnumbered();
}

int MisnumberedClouds(const View& view) {
  int count = IsMisnumbered(view.cloud) ? 1 : 0;
  for (const LidarCloud& further : view.further_clouds)
    count += IsMisnumbered(further.cloud) ? 1 : 0;
  return count;
}

// In the session's order; of those that could not be read not all: each takes memory, and a line in
// all that is written.
SessionDetection Collected(const Session& session, std::vector<std::optional<ViewDetection>> found,
                           const std::vector<std::string>& unreadable) {
  const auto read = std::count_if(found.begin(), found.end(),
                                  [](const auto& detection) { return detection.has_value(); });
  const std::size_t most = std::max(kListed, static_cast<std::size_t>(read));
  SessionDetection detection;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const std::string& name = session.views[i];
    if (found[i]) {
      detection.views.push_back(std::move(*found[i]));
      continue;
    }
    if (detection.unreadable.size() < most) {
      detection.views.push_back(Unreadable(session.rig, name, unreadable[i]));
    }
    detection.unreadable.push_back("view " + name + ": " + unreadable[i]);
  }
  return detection;
}

}  // namespace

SessionDetection DetectSession(const Session& session, const std::string& method,
                               const Progress& progress) {
  const std::size_t count = session.views.size();
  std::vector<std::optional<ViewDetection>> found(count);
  std::vector<std::string> unreadable(count);
  std::size_t done = 0;
  std::vector<int> misnumbered(count, 0);
  std::mutex mutex;
  ForEach(static_cast<int>(count), 0, [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    const std::string& name = session.views[i];
    try {
      const View view = ReadView(session, name);
      found[i] = DetectView(session.rig, view, method);
      misnumbered[i] = MisnumberedClouds(view);
    } catch (const std::exception& e) {
      unreadable[i] = e.what();
    }
    const std::lock_guard<std::mutex> lock(mutex);
    progress("[" + std::to_string(++done) + "/" + std::to_string(count) + "] view " + name + ": " +
             (found[i] ? BriefReport(*found[i]) : "not read") +
             (found[i] && found[i]->heldout ? " (held out)" : ""));
  });

  const int clouds = std::accumulate(misnumbered.begin(), misnumbered.end(), 0);
  if (clouds > 0) {
    progress(
        "warning: the ring numbers of " + std::to_string(clouds) +
        " clouds are not those of the LIDAR's rings: they are left out, rings go by elevation");
  }
  SessionDetection detection = Collected(session, std::move(found), unreadable);
  for (const CameraSpec& camera : session.rig.cameras) {
    SayWhatIsSeenInstead(session, camera, &detection.views);
  }
  return detection;
}

Session ListedOnly(Session session, const std::vector<ViewDetection>& views) {
  session.views.clear();
  for (const ViewDetection& view : views) session.views.push_back(view.view);
  return session;
}

Report WithUnlisted(Report report, const Session& session,
                    const std::vector<ViewDetection>& views) {
  if (views.size() >= session.views.size()) return report;
  const std::string warning = std::to_string(session.views.size() - views.size()) +
                              " more views could not be read; they are neither listed nor counted";
  for (CameraReport& camera : report.cameras) {
    auto& all = camera.warnings;  // evaluate takes over those of calibrate
    if (std::find(all.begin(), all.end(), warning) == all.end()) all.push_back(warning);
  }
  return report;
}

}  // namespace rgbdt
