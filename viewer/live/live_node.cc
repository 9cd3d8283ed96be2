#include "viewer/live/live_node.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/camera/pixels.h"
#include "calib/files/schema/report_file.h"
#include "calib/files/schema/rig_file.h"
#include "calib/model/errors.h"
#include "calib/model/pose_sigma.h"
#include "calib/present/frames/image_frame.h"
#include "calib/present/layout/frame.h"
#include "services/nodes/rig_check.h"
#include "viewer/live/kept_view.h"

namespace rgbdt::viewer {
namespace {

constexpr double kBetweenStates = 0.1;  // s
constexpr std::size_t kMaxViews = 200;
constexpr char kNoSolver[] = "No rgbdt-solver is running; start one to leave views out.";

// Without what the page does not show and is large.
ViewDetection Slim(ViewDetection detection) {
  for (ImageDetection& image : detection.images) {
    if (image.edges) image.edges->edge_pixels.clear();
  }
  return detection;
}

SessionRequestKind RequestOf(const std::string& name) {
  if (name == "next_pose") return SessionRequestKind::kNextPose;
  if (name == "pose_is_set") return SessionRequestKind::kPoseIsSet;
  if (name == "capture") return SessionRequestKind::kCapture;
  if (name == "finish") return SessionRequestKind::kFinish;
  throw InputError("request is \"" + name + "\"; expected next_pose, pose_is_set, capture, finish");
}

}  // namespace

std::vector<std::string> LiveNode::Subscriptions() const {
  return {"RIG",           "CLOUD",  ".*_IMAGE",      "CORNER_SELECTION", "DETECTION",
          "CALIBRATION",   "REPORT", "RGBDT_CLOUD",   "RGBDT_SWEEP",      "SESSION_COMMAND",
          "TARGET_STATUS", "STATUS", "SESSION_EVENT", "LEFT_OUT_VIEWS",   "MOUNT_CHECK",
          "WAVE_PROGRESS", "POSE"};
}

Messages LiveNode::Handle(const Message& message) {
  const std::lock_guard<std::mutex> lock(mutex_);
  Take(message);
  // What others say of the time is not checked.
  if (!std::holds_alternative<Status>(message) && !std::holds_alternative<WaveProgress>(message)) {
    newest_utime_ = std::max(newest_utime_, UtimeOf(message));
  }
  try {
    CompleteView();
  } catch (const std::exception& e) {
    Warn(std::string("a view cannot be shown: ") + e.what());
  }
  try {
    if (other_) other_(message);
  } catch (const std::exception& e) {
    Warn(std::string("not for Foxglove: ") + e.what());
  }
  return {};
}

void LiveNode::Take(const Message& message) {
  if (const auto* rig = std::get_if<RigText>(&message)) {
    OnRig(*rig);
  } else if (const auto* image = std::get_if<Image>(&message)) {
    OnImage(*image);
  } else if (const auto* chunk = std::get_if<CloudChunk>(&message)) {
    OnChunk(*chunk);
  } else if (const auto* picks = std::get_if<CornerSelection>(&message)) {
    if (!rig_) return;
    RequireCamera(picks->camera);
    collector_.Add(*picks);
  } else if (const auto* detection = std::get_if<ViewDetection>(&message)) {
    OnDetection(*detection);
  } else if (const auto* calibration = std::get_if<CalibrationMessage>(&message)) {
    OnCalibration(*calibration);
  } else if (const auto* report = std::get_if<ReportText>(&message)) {
    state_.report = ReportFromJson(report->json, "REPORT message");
    changed_ = true;
  } else if (const auto* cloud = std::get_if<RgbdtCloud>(&message)) {
    OnFused(*cloud);
  } else if (const auto* command = std::get_if<SessionCommand>(&message)) {
    OnCommand(*command);
  } else if (const auto* event = std::get_if<SessionEvent>(&message)) {
    watch_.Add(*event, &state_);
    changed_ = true;
  } else if (const auto* target = std::get_if<TargetStatus>(&message)) {
    OnTargetStatus(*target);
  } else if (const auto* mount = std::get_if<MountCheck>(&message)) {
    OnMountCheck(*mount);
  } else if (const auto* wave = std::get_if<WaveProgress>(&message)) {
    OnWave(*wave);
  } else if (const auto* left_out = std::get_if<LeftOutViews>(&message)) {
    OnLeftOut({left_out->views.begin(), left_out->views.end()});
  } else if (const auto* status = std::get_if<Status>(&message)) {
    watch_.Add(*status, now_s_);
  }
}

void LiveNode::OnRig(const RigText& text) {
  if (rig_ && rig_->hash == text.hash) return;
  rig_before_ =
      std::exchange(rig_, std::make_shared<const Rig>(ParseRig(text.text, "RIG message")));
  if (use_ == Use::kIfSound && state_.calibration.rig_hash != text.hash) {
    state_.calibration = {};  // who made it says it again
    state_.calibration_utime.clear();
  }
  overlays_.Clear();  // of cameras that this rig may not have
  mounts_.Clear();
  wave_ = {};
  outbox_->Send({"rig", "", true, false, 0, [rig = rig_] { return RigFrame(*rig); }});
  changed_ = true;
}

void LiveNode::OnCommand(const SessionCommand& command) {
  if (command.verb == SessionVerb::kCapture) {
    collector_.Begin(command);
    ViewState* view = StateOf(command.view);
    if (view == nullptr) return;
    view->heldout = command.heldout;
    view->picks_wanted = command.picked_cameras;
    changed_ = true;
  }
  const bool begins = command.verb == SessionVerb::kReset;
  if (!begins && command.verb != SessionVerb::kGoOn) return;
  if (begins) collector_.Reset();
  views_.clear();
  outbox_->Forget("thumb/");
  const SessionState before = std::move(state_);
  state_ = {};
  state_.mode = before.mode;
  state_.can = before.can;
  with_all_views_ = {};
  changed_ = true;
}

// Before a rig has come any will do.
void LiveNode::RequireCamera(const std::string& camera) const {
  if (rig_) rig_->Camera(camera);
}

// Null where there are too many: a stranger's names do not fill the memory.
ViewState* LiveNode::StateOf(const std::string& view) {
  for (ViewState& state : state_.views) {
    if (state.name == view) return &state;
  }
  if (state_.views.size() >= kMaxViews) return nullptr;
  state_.views.emplace_back();
  state_.views.back().name = view;
  return &state_.views.back();
}

// The view that is being captured: what it waits for, and the images that a person is to pick in.
void LiveNode::ShowCapture() {
  if (!rig_ || !collector_.active()) return;
  ViewState* state = StateOf(collector_.capture().view);
  if (state == nullptr) return;
  const std::string missing = collector_.Missing(*rig_);
  if (missing == state->waits) return;
  state->waits = missing;
  changed_ = true;
  if (state->picks_wanted.empty()) return;
  View so_far;
  so_far.name = state->name;
  for (const CameraSpec& camera : rig_->cameras) {
    if (const Image* image = collector_.ImageOf(camera.name)) so_far.images.push_back(*image);
  }
  auto kept = std::make_shared<KeptView>(KeepView(so_far));
  state->images = kept->images;
  views_[state->name] = kept;
  for (Post& post : ThumbPosts(*kept)) outbox_->Send(std::move(post));
}

void LiveNode::CompleteView() {
  if (!rig_ || !collector_.active()) return;
  const std::optional<View> view = collector_.Take(*rig_);
  if (!view) {
    ShowCapture();
    return;
  }
  ViewState* state = StateOf(view->name);
  if (state == nullptr) return;
  auto kept = std::make_shared<KeptView>(KeepView(*view));
  state->waits.clear();
  state->picks_wanted.clear();
  state->images = kept->images;
  changed_ = true;
  for (Post& post : ThumbPosts(*kept)) outbox_->Send(std::move(post));
  views_[view->name] = std::move(kept);
}

// Only what the page shows of a view: without directions and times a point takes 16 bytes, not 38.
void LiveNode::OnChunk(const CloudChunk& chunk) {
  CloudChunk shown;
  shown.cloud.sweep_utime = chunk.cloud.sweep_utime;
  shown.cloud.first_line = chunk.cloud.first_line;
  shown.cloud.lines = chunk.cloud.lines;
  shown.cloud.beams = chunk.cloud.beams;
  shown.cloud.organised = chunk.cloud.organised;
  shown.cloud.points = chunk.cloud.points;
  shown.cloud.intensity = chunk.cloud.intensity;
  shown.sweep_end = chunk.sweep_end;
  collector_.Add(std::move(shown));
}

// Before the rig nobody can look at it, and names that strangers make up would fill the memory.
void LiveNode::OnImage(const Image& image) {
  if (!rig_) return;
  CheckImage(rig_->Camera(image.camera), image);
  collector_.Add(image);
  auto shared = std::make_shared<const Image>(image);
  Post post;
  post.topic = "image/" + image.camera;
  post.watch = "camera/" + image.camera;
  post.heavy = true;
  post.make = [shared] { return ImageFrame(*shared, "", true); };
  post.timed = true;
  outbox_->Send(std::move(post));
}

void LiveNode::OnDetection(const ViewDetection& detection) {
  ViewState* view = StateOf(detection.view);
  if (view == nullptr) return;
  view->heldout = detection.heldout;
  view->detection = Slim(detection);
  with_all_views_ = {};  // of other views than those that there are now
  state_.left_out.moved.clear();
  ForgetRejected(detection.view);
  changed_ = true;
  const auto kept = views_.find(detection.view);
  if (kept == views_.end()) return;
  if (auto post = BoardPost(*kept->second, BoardInCloud(detection, state_.calibration))) {
    outbox_->Send(std::move(*post));
  }
}

// A report of before knows nothing of a view that was looked at again.
void LiveNode::ForgetRejected(const std::string& view) {
  if (!state_.report) return;
  for (CameraReport& camera : state_.report->cameras) {
    auto& rejected = camera.rejected;
    rejected.erase(std::remove_if(rejected.begin(), rejected.end(),
                                  [&](const RejectedView& r) { return r.view == view; }),
                   rejected.end());
  }
}

void LiveNode::OnCalibration(const CalibrationMessage& message) {
  const CameraCalibration& camera = message.calibration;
  RequireCamera(camera.camera);
  if (rig_) RequireRigOf(message, *rig_, rig_before_.get(), use_);
  auto& all = state_.calibration.cameras;
  const auto same = std::find_if(all.begin(), all.end(), [&](const CameraCalibration& c) {
    return c.camera == camera.camera;
  });
  const bool repeated = same != all.end() &&
                        RotationDistance(same->camera_from_lidar, camera.camera_from_lidar) == 0 &&
                        CentreDistance(same->camera_from_lidar, camera.camera_from_lidar) == 0 &&
                        same->lens.has_value() == camera.lens.has_value() &&
                        (!camera.lens || same->lens->lens == camera.lens->lens);
  if (repeated && state_.calibration_utime[camera.camera] == message.utime) return;
  state_.calibration.method = message.method;
  state_.calibration.rig_hash = message.rig_hash;
  state_.calibration_utime[camera.camera] = message.utime;
  TellMoved(camera);
  if (same != all.end()) {
    *same = camera;
  } else if (all.size() < 32) {
    all.push_back(camera);
  }
  if (rig_) state_.projection[camera.camera] = ProjectionOf(*rig_, camera);
  CountSigma(camera);
  changed_ = true;
  PostLiveOverlay(camera.camera);
}

// What a person left out; the calibration without it follows.
void LiveNode::OnLeftOut(const std::set<std::string>& views) {
  LeftOut& left_out = state_.left_out;
  if (views == left_out.views) return;
  if (left_out.views.empty()) with_all_views_ = state_.calibration;
  left_out.views = views;
  left_out.moved.clear();
  changed_ = true;
}

void LiveNode::TellMoved(const CameraCalibration& camera) {
  const CameraCalibration* before = with_all_views_.Find(camera.camera);
  if (state_.left_out.views.empty() || before == nullptr) return;
  state_.left_out.moved[camera.camera] = ChangeOf(*before, camera);
}

void LiveNode::CountSigma(const CameraCalibration& calibration) {
  const auto sigma = WorstAxisSigma(calibration);
  if (!sigma) return;
  if (!state_.left_out.views.empty()) return;  // the chart is of views as they came
  const auto used = std::count_if(
      state_.views.begin(), state_.views.end(),
      [&](const ViewState& view) { return !view.heldout && IsUsable(view, calibration.camera); });
  if (used == 0) return;  // this viewer came after the views
  auto& steps = state_.sigma;
  if (steps.empty() || steps.back().views < used) steps.push_back({static_cast<int>(used), {}});
  steps.back().cameras[calibration.camera] = *sigma;
}

void LiveNode::OnFused(const RgbdtCloud& cloud) {
  const bool whole = fused_.Add(cloud, outbox_);
  if (!whole || !rig_) return;
  for (const CameraSpec& camera : rig_->cameras) PostLiveOverlay(camera.name);
}

void LiveNode::PostLiveOverlay(const std::string& camera) {
  if (!rig_) return;
  outbox_->Send(
      overlays_.OverlayPost(rig_->Camera(camera), state_.calibration, fused_.whole_sweep()));
}

void LiveNode::OnTargetStatus(const TargetStatus& status) {
  if (!status.camera.empty()) RequireCamera(status.camera);
  overlays_.Add(status, now_s_);
  outbox_->Send(overlays_.TargetStatusPost(rig_.get(), now_s_));
  if (rig_ && !status.camera.empty()) PostLiveOverlay(status.camera);
}

void LiveNode::OnMountCheck(const MountCheck& check) {
  RequireCamera(check.camera);
  mounts_.Add(check);
  mounts_changed_ = true;
}

Messages LiveNode::Advance(Utime now) {
  nlohmann::json bus;  // asked for without the lock: the server has locks of its own
  if (describe_bus_ && bus_.IsDue(now)) bus = describe_bus_(ToSeconds(now));
  const std::lock_guard<std::mutex> lock(mutex_);
  now_s_ = ToSeconds(now);
  PostState();
  wave_changed_ |= wave_.Update(now_s_);
  if (wave_changed_ && wave_due_.IsDue(now)) {
    wave_changed_ = false;
    outbox_->Send(
        {"wave", "", true, false, 0, [frame = wave_.Frame()] { return JsonFrame(frame); }});
  }
  if (mounts_changed_ && mounts_due_.IsDue(now)) {
    mounts_changed_ = false;
    outbox_->Send(
        {"mounts", "", true, false, 0, [frame = mounts_.Frame()] { return JsonFrame(frame); }});
  }
  if (!bus.is_null()) {
    bus["processes"] = watch_.Processes(now_s_);
    outbox_->Send({"bus", "", true, false, 0, [bus] { return JsonFrame(bus); }});
  }
  return std::exchange(messages_, {});
}

void LiveNode::OnWave(const WaveProgress& progress) {
  for (const WavedClock& clock : progress.clocks) RequireCamera(clock.camera);
  WaveProgress taken = progress;
  if (!rig_) taken.clocks.clear();  // of cameras that nobody knows
  wave_.Add(taken, now_s_);
  wave_changed_ = true;
}

void LiveNode::PostState() {
  if (watch_.Update(now_s_, &state_)) changed_ = true;
  const char* why_not = watch_.Running("solver", now_s_) ? "" : kNoSolver;
  changed_ |= std::exchange(state_.left_out.why_not, why_not) != why_not;
  if (!changed_ || now_s_ - posted_s_ < kBetweenStates) return;
  changed_ = false;
  posted_s_ = now_s_;
  outbox_->Send({"session", "", true, false, 0,
                 [bytes = SessionFrame(state_, rig_.get())] { return bytes; }});
}

std::vector<Post> LiveNode::OnBrowser(const nlohmann::json& message) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const std::string type = message.at("type");
  if (type == "request") {
    SessionRequest request;
    request.utime = newest_utime_;
    request.request = RequestOf(message.at("request"));
    request.heldout = message.value("heldout", false);
    if (!watch_.Running("session", now_s_)) {
      throw InputError(
          "no rgbdt-session is running; start one: rgbdt-session --rig FILE --out DIR");
    }
    messages_.push_back(request);
  } else if (type == "pick") {
    CornerSelection picks;
    picks.camera = message.at("camera");
    picks.image_utime = message.at("image_utime");
    picks.utime = newest_utime_;
    for (std::size_t i = 0; i < picks.corners.size(); ++i) {
      const nlohmann::json& corner = message.at("corners").at(i);
      picks.corners[i] = Eigen::Vector2d(corner.at(0).get<double>(), corner.at(1).get<double>());
    }
    if (rig_) rig_->Camera(picks.camera);
    messages_.push_back(picks);
  } else if (type == "leave_out") {
    AskToLeaveOut(message.at("views").get<std::set<std::string>>());
  } else if (type == "view") {
    const auto view = views_.find(message.at("view"));
    if (view == views_.end())
      throw InputError("there is no view " + std::string(message.at("view")));
    return PostsOf(*view->second);
  }
  return {};
}

void LiveNode::AskToLeaveOut(const std::set<std::string>& views) {
  if (!watch_.Running("solver", now_s_)) throw InputError(kNoSolver);
  std::size_t found = 0;
  for (const ViewState& view : state_.views) found += views.count(view.name);
  if (found < views.size()) throw InputError("a view that is to be left out is not in the session");
  if (!state_.views.empty() && found == state_.views.size()) {
    throw InputError("all views would be left out; use one or more");
  }
  messages_.push_back(LeftOutViews{0, newest_utime_, {views.begin(), views.end()}});
  OnLeftOut(views);
}

std::vector<Post> LiveNode::PostsOf(const KeptView& view) const {
  std::vector<Post> posts;
  if (!rig_) return posts;
  const auto state = std::find_if(state_.views.begin(), state_.views.end(),
                                  [&](const ViewState& v) { return v.name == view.name; });
  const auto detection = state == state_.views.end() ? std::nullopt : state->detection;
  for (const CameraSpec& camera : rig_->cameras) {
    const CameraCalibration* calibration = state_.calibration.Find(camera.name);
    std::optional<Rigid3> camera_from_lidar;
    if (calibration != nullptr) camera_from_lidar = calibration->camera_from_lidar;
    const CameraSpec with_lens = state_.calibration.WithSolvedLens(camera);
    for (Post& post : PicturePosts(view, with_lens, detection, camera_from_lidar)) {
      posts.push_back(std::move(post));
    }
  }
  return posts;
}

Status LiveNode::GetStatus() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  Status status;
  status.ready = true;
  status.text =
      rig_ ? "shows " + std::to_string(state_.views.size()) + " views" : "waits for the rig (RIG)";
  return status;
}

}  // namespace rgbdt::viewer
