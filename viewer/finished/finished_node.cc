#include "viewer/finished/finished_node.h"

#include <algorithm>
#include <utility>

#include "calib/methods/calibrate_by_views.h"
#include "calib/methods/calibrate_without.h"
#include "calib/model/errors.h"
#include "calib/model/method.h"
#include "calib/present/frames/overlay_frame.h"
#include "calib/present/session/session_frames.h"

namespace rgbdt::viewer {
namespace {

constexpr std::size_t kCloudPoints = 300'000;
constexpr std::size_t kKeptPoints = 100'000;  // of each view, to be laid on its images
constexpr std::size_t kOverlayPoints = 20'000;

Post Kept(const NamedFrame& frame) {
  Post post;
  post.topic = frame.topic;
  post.make = [bytes = frame.bytes] { return bytes; };
  return post;
}

// By camera, of those that both solved.
std::map<std::string, PoseChange> Moved(const Report& from, const Report& to) {
  std::map<std::string, PoseChange> moved;
  const Calibration before = from.ToCalibration();
  for (const CameraCalibration& camera : to.ToCalibration().cameras) {
    const CameraCalibration* same = before.Find(camera.camera);
    if (same != nullptr) moved[camera.camera] = ChangeOf(*same, camera);
  }
  return moved;
}

}  // namespace

// Some points of a view's cloud, read when they are first needed.
class FinishedNode::Points {
 public:
  const Cloud& Of(const Session& session, const std::string& view) {
    std::call_once(read_, [&] { cloud_ = SomePoints(ReadCloud(session, view), kKeptPoints); });
    return cloud_;
  }

 private:
  std::once_flag read_;
  Cloud cloud_;
};

FinishedNode::FinishedNode(Session session, std::vector<ViewDetection> detections,
                           const Report& report, const std::string& another_rig)
    : session_(std::move(session)),
      detections_(std::move(detections)),
      all_views_(another_rig.empty() ? CalibrateByViews(session_.rig, detections_, report)
                                     : std::vector{report}),
      reports_(all_views_) {
  for (const std::string& view : session_.views) points_[view] = std::make_shared<Points>();
  left_out_.why_not = another_rig;
  if (report.method != kAutoMethod) {
    left_out_.why_not = "Views can be left out of a calibration by --method auto; this one is by " +
                        report.method + ".";
  }
}

void FinishedNode::PostTo(Outbox* outbox, const std::string& title) {
  const std::lock_guard<std::mutex> lock(mutex_);
  outbox_ = outbox;
  SessionFramesOptions options;
  options.title = title;
  options.points = options.other_points = 0;  // as browsers ask for them
  options.overlay_points = kOverlayPoints;
  for (const NamedFrame& frame :
       SessionFrames({session_, detections_, reports_, left_out_}, options)) {
    if (frame.topic != "hello") outbox_->Send(Kept(frame));  // the server sends its own
  }
}

std::vector<Post> FinishedNode::OnBrowser(const nlohmann::json& message) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const std::string type = message.at("type");
  if (type == "leave_out") LeaveOut(message.at("views").get<std::set<std::string>>());
  if (type != "view") return {};
  RequireView(message.at("view"));
  return {CloudPost(message.at("view"))};
}

void FinishedNode::RequireView(const std::string& view) const {
  if (points_.count(view) == 0) throw InputError("there is no view " + view);
}

void FinishedNode::LeaveOut(const std::set<std::string>& views) {
  if (views == left_out_.views) return;
  if (!left_out_.why_not.empty()) throw InputError(left_out_.why_not);
  for (const std::string& view : views) RequireView(view);
  if (views.empty()) {
    reports_ = all_views_;
    left_out_.moved.clear();
  } else {
    const Report report = CalibrateWithout(session_.rig, detections_, views, {});
    reports_ = CalibrateByViews(session_.rig, detections_, report);
    left_out_.moved = Moved(all_views_.back(), report);
  }
  left_out_.views = views;
  PostResult();
}

void FinishedNode::PostResult() {
  if (outbox_ == nullptr) return;
  for (const NamedFrame& frame : ResultFrames({session_, detections_, reports_, left_out_})) {
    outbox_->Send(Kept(frame));
  }
  for (const ViewDetection& detection : detections_) {
    for (Post& post : OverlayPosts(detection)) outbox_->Send(std::move(post));
  }
}

// Made when the browser is about to get it: a dense sweep takes some tenths of a second.
Post FinishedNode::CloudPost(const std::string& view) const {
  Post post;
  post.topic = "cloud/" + view;
  post.kept = false;
  post.make = [this, view, calibration = Result()] {
    return ViewCloudFrame(session_, calibration, ReadView(session_, view), kCloudPoints);
  };
  return post;
}

std::vector<Post> FinishedNode::OverlayPosts(const ViewDetection& detection) const {
  std::vector<Post> posts;
  const Calibration calibration = Result();
  const auto points = points_.find(detection.view);
  if (points == points_.end()) return posts;
  for (const ImageDetection& image : detection.images) {
    const CameraCalibration* found = calibration.Find(image.camera);
    std::optional<Rigid3> camera_from_lidar;
    if (found != nullptr) camera_from_lidar = found->camera_from_lidar;
    Post post;
    post.topic = "overlay/" + detection.view + "/" + image.camera;
    post.make = [this, detection, camera_from_lidar, points = points->second,
                 camera = calibration.WithSolvedLens(session_.rig.Camera(image.camera))] {
      const Cloud& cloud = points->Of(session_, detection.view);
      return OverlayFrame(ViewOverlay(camera, detection, &cloud, camera_from_lidar), false);
    };
    posts.push_back(std::move(post));
  }
  return posts;
}

}  // namespace rgbdt::viewer
