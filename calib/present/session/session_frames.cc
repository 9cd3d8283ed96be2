#include "calib/present/session/session_frames.h"

#include <algorithm>
#include <exception>
#include <iterator>
#include <map>

#include "calib/fuse/fuse.h"
#include "calib/model/parallel.h"
#include "calib/model/pose_sigma.h"
#include "calib/model/version.h"
#include "calib/present/frames/cloud_frame.h"
#include "calib/present/frames/image_frame.h"
#include "calib/present/frames/overlay_frame.h"
#include "calib/present/layout/frame.h"
#include "calib/present/pictures/colouring_picture.h"
#include "calib/present/pictures/lidar_picture.h"

namespace rgbdt {
namespace {

std::string HelloFrame(const std::string& title) {
  return JsonFrame({{"type", "hello"},
                    {"source", "session"},
                    {"title", title},
                    {"version", Version()},
                    {"may_command", false},
                    {"why_not", "a finished session"}});
}

std::vector<ViewState> ViewsOf(const Session& session,
                               const std::vector<ViewDetection>& detections) {
  std::map<std::string, const ViewDetection*> detection_of;
  for (const ViewDetection& detection : detections) detection_of[detection.view] = &detection;
  std::vector<ViewState> views;
  for (const std::string& name : session.views) {
    ViewState& view = views.emplace_back();
    view.name = name;
    const auto found = detection_of.find(name);
    if (found == detection_of.end()) continue;
    const ViewDetection& detection = *found->second;
    view.heldout = detection.heldout;
    for (const ImageDetection& image : detection.images) view.images[image.camera] = image.utime;
    view.detection = detection;
  }
  return views;
}

SigmaStep SigmaStepOf(const Report& report) {
  SigmaStep step;
  for (const CameraReport& camera : report.cameras) {
    const auto sigma = WorstAxisSigma(camera.calibration);
    if (!sigma || !camera.calibration.solved()) continue;
    step.cameras[camera.calibration.camera] = *sigma;
    step.views = std::max(step.views, static_cast<int>(camera.used.size()));
  }
  return step;
}

std::vector<SigmaStep> SigmaSteps(const std::vector<Report>& reports) {
  std::vector<SigmaStep> steps;
  for (const Report& report : reports) {
    SigmaStep step = SigmaStepOf(report);
    if (!step.cameras.empty()) steps.push_back(std::move(step));
  }
  return steps;
}

SessionState StateOf(const FinishedSession& finished) {
  const Report& report = finished.report();
  SessionState state;
  state.mode = "finished";
  state.report = report;
  state.calibration = report.ToCalibration();
  for (const CameraCalibration& camera : state.calibration.cameras) {
    state.calibration_utime[camera.camera] = report.utime;
    state.projection[camera.camera] = ProjectionOf(finished.session.rig, camera);
  }
  state.views = ViewsOf(finished.session, finished.detections);
  state.sigma = SigmaSteps(finished.reports);
  state.left_out = finished.left_out;
  return state;
}

// What one view gives; the pixels and points themselves are not kept.
struct ViewFrames {
  std::vector<NamedFrame> thumbs, images;
  std::string cloud;    // the fused one
  std::string failure;  // why the view could not be read
};

class FrameMaker {
 public:
  FrameMaker(const Session& session, const Calibration& calibration,
             const SessionFramesOptions& options)
      : session_(session), calibration_(calibration), options_(options) {}

  /// With so many points of its cloud.
  ViewFrames Make(const ViewState& state, std::size_t points) const {
    ViewFrames out;
    try {
      const View view = ReadView(session_, state.name);
      for (const CameraSpec& camera : session_.rig.cameras) AddCamera(camera, state, view, &out);
      const auto board =
          state.detection ? BoardInCloud(*state.detection, calibration_) : std::nullopt;
      if (board) {
        out.thumbs.push_back(
            {"thumb/" + view.name + "/", BoardThumbFrame(view.name, *board, view.cloud)});
      }
      if (points > 0) out.cloud = ViewCloudFrame(session_, calibration_, view, points);
    } catch (const std::exception& e) {
      out.failure = e.what();
    }
    return out;
  }

 private:
  void AddCamera(const CameraSpec& camera, const ViewState& state, const View& view,
                 ViewFrames* out) const {
    const auto image = std::find_if(view.images.begin(), view.images.end(),
                                    [&](const Image& i) { return i.camera == camera.name; });
    if (image == view.images.end()) return;
    const std::string of = view.name + "/" + camera.name;
    out->thumbs.push_back({"thumb/" + of, ThumbFrame(*image, view.name)});
    ImageFrameOptions options;
    options.max_width = options_.image_width;
    out->images.push_back({"image/" + of, ImageFrame(*image, view.name, false, options)});
    if (!state.detection) return;
    const CameraCalibration* found = calibration_.Find(camera.name);
    Overlay overlay =
        ViewOverlay(calibration_.WithSolvedLens(camera), *state.detection, &view.cloud,
                    found == nullptr ? std::nullopt : std::make_optional(found->camera_from_lidar));
    overlay.utime = image->utime;
    if (overlay.cloud.size() > options_.overlay_points) {
      overlay.cloud.resize(options_.overlay_points);
    }
    out->images.push_back({"overlay/" + of, OverlayFrame(overlay, false)});
  }

  const Session& session_;
  const Calibration& calibration_;
  const SessionFramesOptions& options_;
};

// Each view is read once, one a thread at a time: a dense session would not fit into memory.
std::vector<ViewFrames> MakeAll(const FrameMaker& maker, const std::vector<ViewState>& views,
                                const SessionFramesOptions& options) {
  std::vector<ViewFrames> made(views.size());
  const std::size_t each =
      std::min(options.points, options.other_points / std::max<std::size_t>(1, views.size()));
  ForEach(static_cast<int>(views.size()), 0, [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    made[i] = maker.Make(views[i], i + 1 == views.size() ? options.points : each);
  });
  return made;
}

// Cameras of which nothing is known in a view that could not be read.
void TellFailure(const Rig& rig, const std::string& failure, ViewState* view) {
  if (view->detection) return;
  ViewDetection& detection = view->detection.emplace();
  detection.view = view->name;
  for (const CameraSpec& camera : rig.cameras) {
    detection.images.push_back({camera.name, 0, std::nullopt, failure, 0});
  }
  detection.cloud.why_not = failure;
}

// The pictures of the projection uncertainty and of the LIDAR's own errors, as the images of
// views "sigma" and "lidar".
std::vector<NamedFrame> PictureFrames(const Rig& rig, const Report& report) {
  std::vector<NamedFrame> frames;
  const auto add = [&](const std::string& view, const std::string& camera, cv::Mat picture) {
    if (picture.empty()) return;
    Image image;
    image.camera = camera;
    image.format = PixelFormat::kBgr8;
    image.pixels = std::move(picture);
    std::string name = "image/";
    name += view;
    name += '/';
    name += camera;
    frames.push_back({std::move(name), ImageFrame(image, view, false, {1280, 90})});
  };
  for (const CameraReport& camera : report.cameras) {
    if (!camera.calibration.solved()) continue;
    const std::string& name = camera.calibration.camera;
    add("sigma", name, ColouringPicture(rig.Camera(name), camera.calibration));
    add("lidar", name, LidarPicture(camera));
  }
  return frames;
}

void Append(std::vector<NamedFrame> from, std::vector<NamedFrame>* to) {
  std::move(from.begin(), from.end(), std::back_inserter(*to));
}

}  // namespace

std::vector<NamedFrame> SessionFrames(const FinishedSession& finished,
                                      const SessionFramesOptions& options) {
  const Rig& rig = finished.session.rig;
  SessionState state = StateOf(finished);
  const FrameMaker maker(finished.session, state.calibration, options);
  std::vector<ViewFrames> made = MakeAll(maker, state.views, options);
  for (std::size_t i = 0; i < made.size(); ++i) {
    if (!made[i].failure.empty()) TellFailure(rig, made[i].failure, &state.views[i]);
  }
  std::vector<NamedFrame> frames = {{"hello", HelloFrame(options.title)},
                                    {"rig", RigFrame(rig)},
                                    {"session", SessionFrame(state, &rig)}};
  for (ViewFrames& view : made) Append(std::move(view.thumbs), &frames);
  for (ViewFrames& view : made) Append(std::move(view.images), &frames);
  Append(PictureFrames(rig, finished.report()), &frames);
  for (std::size_t i = 0; i < made.size(); ++i) {
    if (made[i].cloud.empty()) continue;
    frames.push_back({"cloud/" + state.views[i].name, std::move(made[i].cloud)});
  }
  return frames;
}

std::vector<NamedFrame> ResultFrames(const FinishedSession& finished) {
  const Rig& rig = finished.session.rig;
  std::vector<NamedFrame> frames = {{"session", SessionFrame(StateOf(finished), &rig)}};
  Append(PictureFrames(rig, finished.report()), &frames);
  return frames;
}

std::string ViewCloudFrame(const Session& session, const Calibration& calibration, const View& view,
                           std::size_t points) {
  RgbdtCloud fused = FuseView(session.rig, calibration, view);
  if (fused.size() == 0) return {};
  fused.whole_sweep = true;
  // Where nobody knows the times they are 0, which would stand for "not calibrated".
  for (std::size_t i = 0; i < fused.cameras.size(); ++i) {
    if (calibration.Find(fused.cameras[i]) == nullptr) continue;
    fused.calibration_utime[i] = std::max<Utime>(1, fused.calibration_utime[i]);
  }
  std::string frame = CloudFrame(fused, 0, view.name);
  if (fused.size() > points) {  // a frame may end early, at a whole record
    frame.resize(frame.size() - (fused.size() - points) * kPointBytes);
  }
  return frame;
}

}  // namespace rgbdt
