#include "calib/present/frames/session_state.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "calib/camera/camera.h"
#include "calib/present/frames/internal/content_json.h"
#include "calib/present/layout/frame.h"
#include "calib/present/report/session_verdict.h"
#include "calib/solve/colouring.h"
#include "calib/solve/first_guess.h"

namespace rgbdt {
namespace {

using nlohmann::json;

const char* NameOf(CameraKind kind) { return kind == CameraKind::kThermal ? "thermal" : "color"; }

// Where the image's corners look, going round; empty where the lens does not tell.
json CornersOf(const CameraSpec& spec) {
  if (!spec.lens.known()) return json::array();
  const Camera camera(spec);
  json corners = json::array();
  const double right = spec.width - 0.5, below = spec.height - 0.5;
  for (const Eigen::Vector2d& pixel :
       {Eigen::Vector2d(-0.5, -0.5), {right, -0.5}, {right, below}, {-0.5, below}}) {
    const auto direction = camera.Unproject(pixel);
    if (!direction) return json::array();
    corners.push_back({direction->x(), direction->y(), direction->z()});
  }
  return corners;
}

const char* NameOf(EventKind kind) {
  switch (kind) {
    case EventKind::kProgress:
      return "progress";
    case EventKind::kDone:
      return "done";
    case EventKind::kFailed:
      break;
  }
  return "failed";
}

json Optional(const std::optional<double>& value) {
  return value ? FiniteOrNull(*value) : json(nullptr);
}

template <typename Vector>
json NumbersOf(const Vector& vector) {
  json out = json::array();
  for (const double number : vector) out.push_back(FiniteOrNull(number));
  return out;
}

// All that are known of: the rig's or, without one, those that are named anywhere.
std::vector<std::string> CameraNames(const SessionState& state, const Rig* rig) {
  std::vector<std::string> names;
  if (rig != nullptr) {
    for (const CameraSpec& camera : rig->cameras) names.push_back(camera.name);
    return names;
  }
  std::set<std::string> named;
  for (const CameraCalibration& camera : state.calibration.cameras) named.insert(camera.camera);
  for (const ViewState& view : state.views) {
    for (const auto& image : view.images) named.insert(image.first);
    if (!view.detection) continue;
    for (const ImageDetection& image : view.detection->images) named.insert(image.camera);
  }
  return {named.begin(), named.end()};
}

const CameraReport* ReportOf(const SessionState& state, const std::string& camera) {
  if (!state.report) return nullptr;
  const auto found =
      std::find_if(state.report->cameras.begin(), state.report->cameras.end(),
                   [&](const CameraReport& r) { return r.calibration.camera == camera; });
  return found == state.report->cameras.end() ? nullptr : &*found;
}

const ImageDetection* DetectionOf(const ViewState& view, const std::string& camera) {
  return view.detection ? view.detection->Find(camera) : nullptr;
}

Utime ImageOf(const ViewState& view, const std::string& camera) {
  const auto found = view.images.find(camera);
  if (found != view.images.end() && found->second != 0) return found->second;
  const ImageDetection* image = DetectionOf(view, camera);
  return image == nullptr ? 0 : image->utime;
}

// Why detection left the view out, or the solver; empty: neither did.
std::string WhyRejected(const CameraReport* report, const ViewDetection& detection,
                        const std::string& camera) {
  std::string why = CameraViewOf(camera, detection).rejected;
  if (!why.empty() || report == nullptr) return why;
  for (const RejectedView& rejected : report->rejected) {
    if (rejected.view == detection.view) return rejected.why;
  }
  return why;
}

const ViewQuality* QualityOf(const CameraReport* report, const std::string& view) {
  if (report == nullptr) return nullptr;
  const auto found = std::find_if(report->views.begin(), report->views.end(),
                                  [&](const ViewQuality& q) { return q.view == view; });
  return found == report->views.end() ? nullptr : &*found;
}

json CornersOf(const std::optional<ImageEdges>& image) {
  json corners = json::array();
  if (!image) return corners;
  for (const Eigen::Vector2d& corner : image->outline_corners) {
    corners.push_back(NumbersOf(corner));
  }
  return corners;
}

json ViewCameraOf(const ViewState& view, const std::string& camera, const CameraReport* report) {
  json out = {{"camera", camera},       {"image_utime", ImageOf(view, camera)},
              {"state", "waiting"},     {"why", ""},
              {"picked", false},        {"outline", json::array()},
              {"edge_rms_px", nullptr}, {"edge_rms_sigmas", nullptr},
              {"edge_rms_mm", nullptr}, {"plane_rms_mm", nullptr},
              {"image_why_not", ""}};
  const ImageDetection* image = DetectionOf(view, camera);
  if (image == nullptr) return out;
  const std::string why = WhyRejected(report, *view.detection, camera);
  out["state"] = why.empty() ? "accepted" : "rejected";
  out["why"] = why;
  out["image_why_not"] = image->why_not;
  out["picked"] = image->edges && image->edges->picked;
  out["outline"] = CornersOf(image->edges);
  if (const ViewQuality* quality = QualityOf(report, view.name)) {
    out["edge_rms_px"] = FiniteOrNull(quality->edge_rms_px);
    out["edge_rms_sigmas"] = Optional(quality->edge_rms_whitened);
    out["edge_rms_mm"] = Optional(quality->edge_rms_mm);
    out["plane_rms_mm"] = Optional(quality->plane_rms_mm);
  }
  return out;
}

json BoardOf(const ViewState& view, const Calibration& calibration) {
  if (!view.detection) return nullptr;
  const auto board = BoardInCloud(*view.detection, calibration);
  if (!board) return nullptr;
  return {{"centre_m", NumbersOf(board->centre)},
          {"normal", NumbersOf(board->normal)},
          {"distance_m", FiniteOrNull(board->centre.norm())}};
}

json ViewsOf(const SessionState& state, const std::vector<std::string>& cameras) {
  json views = json::array();
  for (const ViewState& view : state.views) {
    json of_cameras = json::array();
    for (const std::string& camera : cameras) {
      of_cameras.push_back(ViewCameraOf(view, camera, ReportOf(state, camera)));
    }
    views.push_back({{"name", view.name},
                     {"heldout", view.heldout},
                     {"left_out", state.left_out.views.count(view.name) > 0},
                     {"waits", view.waits},
                     {"board", BoardOf(view, state.calibration)},
                     {"cloud_why_not", view.detection ? view.detection->cloud.why_not : ""},
                     {"cameras", of_cameras}});
  }
  return views;
}

json LeftOutJson(const LeftOut& left_out) {
  json moved = json::array();
  for (const auto& [camera, change] : left_out.moved) {
    moved.push_back({{"camera", camera},
                     {"rotation_deg", FiniteOrNull(change.difference.rotation_deg)},
                     {"centre_mm", FiniteOrNull(change.difference.translation_mm)},
                     {"sigmas", Optional(change.sigmas)}});
  }
  return {{"views", left_out.views}, {"moved", moved}, {"why_not", left_out.why_not}};
}

// Whether a person's picks would help, and why; empty: not, or there is no image.
std::string WhyPicks(const ViewState& view, const std::string& camera) {
  if (ImageOf(view, camera) == 0) return "";
  const auto& asked = view.picks_wanted;
  if (std::find(asked.begin(), asked.end(), camera) != asked.end())
    return "the session asks for it";
  const ImageDetection* image = DetectionOf(view, camera);
  return image == nullptr || image->edges ? "" : image->why_not;
}

// Views that wait for picks or whose image was looked at in vain, the newest first: that is the
// board's likeliest place to be remembered.
json PickWantedOf(const SessionState& state, const std::vector<std::string>& cameras) {
  json wanted = json::array();
  for (auto view = state.views.rbegin(); view != state.views.rend(); ++view) {
    for (const std::string& camera : cameras) {
      const std::string why = WhyPicks(*view, camera);
      if (why.empty()) continue;
      wanted.push_back({{"view", view->name},
                        {"camera", camera},
                        {"image_utime", ImageOf(*view, camera)},
                        {"why", why}});
    }
  }
  return wanted;
}

json SigmasOf(const std::vector<SigmaStep>& steps) {
  json out = json::array();
  for (const SigmaStep& step : steps) {
    json cameras = json::array();
    for (const auto& [camera, sigma] : step.cameras) {
      cameras.push_back({{"camera", camera},
                         {"rotation_deg", FiniteOrNull(sigma.rotation_deg)},
                         {"centre_mm", FiniteOrNull(sigma.translation_mm)}});
    }
    out.push_back({{"views", step.views}, {"cameras", cameras}});
  }
  return out;
}

JudgedCamera JudgedOf(const SessionState& state, const std::string& camera) {
  JudgedCamera judged{camera, state.calibration.Find(camera) != nullptr, 0,
                      ReportOf(state, camera)};
  for (const ViewState& view : state.views) {
    if (DetectionOf(view, camera) == nullptr) continue;
    judged.views_found += WhyRejected(judged.report, *view.detection, camera).empty() ? 1 : 0;
  }
  return judged;
}

json ProjectionJson(const SessionState& state, const std::string& camera) {
  json out = json::array();
  const auto known = state.projection.find(camera);
  if (known == state.projection.end()) return out;
  for (const ColouringVariance& at : known->second) {
    out.push_back({at.lasting, at.per_m, at.per_m2});
  }
  return out;
}

json CameraOf(const SessionState& state, const JudgedCamera& judged) {
  const CameraCalibration* calibration = state.calibration.Find(judged.camera);
  const auto utime = state.calibration_utime.find(judged.camera);
  json out = {{"camera", judged.camera},
              {"calibrated", calibration != nullptr},
              {"status", calibration == nullptr ? "not calibrated yet" : calibration->StatusText()},
              {"utime", utime == state.calibration_utime.end() ? 0 : utime->second},
              {"camera_from_lidar", nullptr},
              {"poses", json::array()},
              {"rotation_sigma_deg", nullptr},
              {"centre_sigma_mm", nullptr},
              {"projection", json::array()},
              {"verdict", VerdictJson(VerdictOf(
                              judged, state.report ? state.report->next_view : std::nullopt))}};
  if (calibration != nullptr) {
    out["camera_from_lidar"] = MatrixOf(calibration->camera_from_lidar);
    out["poses"] = PosesJson(BothWays(*calibration));
    out["projection"] = ProjectionJson(state, judged.camera);
    if (const auto sigma = WorstAxisSigma(*calibration)) {
      out["rotation_sigma_deg"] = FiniteOrNull(sigma->rotation_deg);
      out["centre_sigma_mm"] = FiniteOrNull(sigma->translation_mm);
    }
  } else if (judged.report != nullptr && !judged.report->calibration.detail.empty()) {
    out["status"] = judged.report->calibration.StatusText();
  }
  return out;
}

json LogOf(const std::vector<SessionEvent>& events) {
  json log = json::array();
  for (const SessionEvent& event : events) {
    log.push_back({{"utime", event.utime},
                   {"source", event.source},
                   {"kind", NameOf(event.kind)},
                   {"text", event.text}});
  }
  return log;
}

json NextViewJson(const std::optional<Report>& report) {
  const NextView* found = report ? NextViewOf(*report) : nullptr;
  if (found == nullptr) return nullptr;
  const NextViewWords next = WordsOf(*found);
  return {{"words", next.words}, {"gain", next.gain}};
}

}  // namespace

bool IsUsable(const ViewState& view, const std::string& camera) {
  return view.detection && CameraViewOf(camera, *view.detection).usable();
}

std::optional<CloudEdges> BoardInCloud(const ViewDetection& detection,
                                       const Calibration& calibration) {
  std::optional<CloudEdges> likeliest;
  for (const ImageDetection& image : detection.images) {
    CameraView view = CameraViewOf(image.camera, detection);
    const CameraCalibration* camera = calibration.Find(image.camera);
    if (camera == nullptr || !view.usable()) {
      if (!likeliest) likeliest = view.cloud;
      continue;
    }
    const CameraView chosen =
        WithChosenCandidate(std::move(view), camera->camera_from_lidar, kJudgeGate);
    if (chosen.usable()) return chosen.cloud;
  }
  return likeliest;
}

std::vector<ColouringVariance> ProjectionOf(const Rig& rig, const CameraCalibration& calibration) {
  const CameraSpec& spec = rig.Camera(calibration.camera);
  if (!spec.lens.known() || !WorstAxisSigma(calibration)) return {};
  return WorstColouring(spec, calibration);
}

std::string RigFrame(const Rig& rig) {
  json cameras = json::array();
  for (const CameraSpec& camera : rig.cameras) {
    cameras.push_back({{"name", camera.name},
                       {"kind", NameOf(camera.kind)},
                       {"width", camera.width},
                       {"height", camera.height},
                       {"corners", CornersOf(camera)}});
  }
  return JsonFrame({{"type", "rig"},
                    {"hash", rig.hash},
                    {"cameras", cameras},
                    {"target",
                     {{"squares_x", rig.target.squares_x},
                      {"squares_y", rig.target.squares_y},
                      {"square_m", rig.target.square_m},
                      {"width_m", rig.target.width_m},
                      {"height_m", rig.target.height_m}}}});
}

std::string SessionFrame(const SessionState& state, const Rig* rig) {
  const std::vector<std::string> cameras = CameraNames(state, rig);
  std::vector<JudgedCamera> judged;
  json states = json::array();
  for (const std::string& camera : cameras) {
    states.push_back(CameraOf(state, judged.emplace_back(JudgedOf(state, camera))));
  }
  const auto next_view = state.report ? state.report->next_view : std::nullopt;
  return JsonFrame({{"type", "session"},
                    {"mode", state.mode},
                    {"can", state.can},
                    {"busy", state.busy},
                    {"fraction", FiniteOrNull(state.fraction)},
                    {"step", state.step},
                    {"steps", state.steps},
                    {"failure", state.failure},
                    {"log", LogOf(state.log)},
                    {"views", ViewsOf(state, cameras)},
                    {"pick_wanted", PickWantedOf(state, cameras)},
                    {"left_out", LeftOutJson(state.left_out)},
                    {"sigma", SigmasOf(state.sigma)},
                    {"cameras", states},
                    {"verdict", VerdictJson(VerdictOfAll(judged, next_view))},
                    {"heldout", TableJson(HeldoutTable(judged))},
                    {"next_view", NextViewJson(state.report)},
                    {"report", state.report ? ContentJson(ContentOf(*state.report)) : nullptr}});
}

}  // namespace rgbdt
