#include "calib/methods/session_corners.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>

#include "calib/camera/pixels.h"
#include "calib/detect/image/checkerboard.h"
#include "calib/detect/image/contrast.h"
#include "calib/model/errors.h"
#include "calib/model/view_detection.h"

namespace rgbdt {
namespace {

// One image: its corners, or none.
struct Found {
  std::string camera;
  IntrinsicsView view;
  double contrast = 0;
  bool partial = false;  ///< a part of the board is outside the image
};

Found FindInImage(const Rig& rig, const Image& image, const std::string& name) {
  CheckImage(rig.Camera(image.camera), image);
  const cv::Mat grey = ToGrey(image);
  Found found{image.camera, {name, {}}, 0};
  const auto board = FindCheckerboard(grey, rig.target, SaturatedFrom(image)).board;
  if (!board) return found;
  // A lens is found from whole boards.
  if (!std::all_of(board->corners.begin(), board->corners.end(), IsSeen)) {
    found.partial = true;
    return found;
  }
  found.view.corners = board->corners;
  found.contrast = SquareContrast(grey, rig.target, board->corners);
  return found;
}

std::vector<Found> FindInView(const Session& session, const std::string& view,
                              const std::vector<std::string>& cameras) {
  std::vector<Found> found;
  for (const Image& image : ReadImages(session, view).images) {
    if (std::find(cameras.begin(), cameras.end(), image.camera) == cameras.end()) continue;
    const auto before = std::count_if(found.begin(), found.end(), [&](const Found& other) {
      return other.camera == image.camera;
    });
    const std::string name = before == 0 ? view : view + "#" + std::to_string(before + 1);
    found.push_back(FindInImage(session.rig, image, name));
  }
  return found;
}

std::string Summary(const std::vector<Found>& found) {
  std::string text;
  for (const Found& f : found) {
    text += (text.empty() ? "" : "; ") + f.camera + ": " +
            (f.partial                ? "a part of the board is outside the image"
             : f.view.corners.empty() ? "no board found"
                                      : "board found");
  }
  return text.empty() ? "no image" : text;
}

// Noise makes no two images alike to the last bit.
bool IsCopy(const IntrinsicsView& view, const std::vector<IntrinsicsView>& others) {
  return std::any_of(others.begin(), others.end(),
                     [&](const IntrinsicsView& other) { return other.corners == view.corners; });
}

CameraCorners Collect(const std::string& camera, std::vector<std::vector<Found>>* by_view) {
  CameraCorners all;
  all.camera = camera;
  for (std::vector<Found>& view : *by_view) {
    for (Found& found : view) {
      if (found.camera != camera) continue;
      ++all.images;
      if (found.view.corners.empty()) {
        all.not_found.push_back(found.view.name);
      } else if (IsCopy(found.view, all.views)) {
        all.copies.push_back(found.view.name);
      } else {
        all.views.push_back(std::move(found.view));
        all.contrasts.push_back(found.contrast);
      }
    }
  }
  return all;
}

}  // namespace

SessionCorners FindSessionCorners(const Session& session, const std::vector<std::string>& cameras,
                                  const Progress& progress) {
  if (!session.rig.target.HasPattern()) {
    throw InputError("a lens is found from a checkerboard; the rig's target is plain");
  }
  const std::size_t count = session.views.size();
  std::vector<std::vector<Found>> by_view(count);
  std::vector<std::string> unreadable(count);
  std::atomic<std::size_t> next{0};
  std::size_t done = 0;
  std::mutex mutex;
  const auto work = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      const std::string& name = session.views[i];
      try {
        by_view[i] = FindInView(session, name, cameras);
      } catch (const std::exception& e) {
        unreadable[i] = e.what();
      }
      const std::lock_guard<std::mutex> lock(mutex);
      progress("[" + std::to_string(++done) + "/" + std::to_string(count) + "] view " + name +
               ": " + (unreadable[i].empty() ? Summary(by_view[i]) : "not read"));
    }
  };
  std::vector<std::thread> threads;
  for (unsigned i = 0; i < std::max(1U, std::thread::hardware_concurrency()); ++i) {
    threads.emplace_back(work);
  }
  for (std::thread& thread : threads) thread.join();

  SessionCorners corners;
  for (const std::string& camera : cameras) corners.cameras.push_back(Collect(camera, &by_view));
  for (std::size_t i = 0; i < count; ++i) {
    if (unreadable[i].empty()) continue;
    corners.unreadable.push_back("view " + session.views[i] + ": " + unreadable[i]);
  }
  return corners;
}

}  // namespace rgbdt
