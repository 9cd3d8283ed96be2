#include "calib/files/schema/report_file.h"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <google/protobuf/util/json_util.h>
#include <google/protobuf/util/type_resolver_util.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "calib/files/atomic_file.h"
#include "calib/files/schema/internal/lens_convert.h"
#include "calib/files/schema/internal/lidar_convert.h"
#include "calib/files/schema/internal/report_parts.h"
#include "calib/files/schema/proto_convert.h"
#include "calib/files/schema/report.pb.h"
#include "calib/files/schema/text_proto.h"
#include "calib/model/errors.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

using text::FromPoseError;
using text::Place;
using text::SetFinite;
using text::ToPoseError;

void FromViews(const CameraReport& camera, proto::CameraReport* out) {
  for (const std::string& view : camera.used) out->mutable_views()->add_used(ValidUtf8(view));
  for (const std::string& view : camera.heldout) {
    out->mutable_views()->add_heldout(ValidUtf8(view));
  }
  out->mutable_views();  // present even where all lists are empty
  for (const RejectedView& view : camera.rejected) {
    proto::RejectedView* rejected = out->mutable_views()->add_rejected();
    rejected->set_view(ValidUtf8(view.view));
    rejected->set_why(ValidUtf8(view.why));
    if (view.copy) rejected->set_copy(true);
  }
  for (const std::string& warning : camera.warnings) {
    out->mutable_views()->add_warnings(ValidUtf8(warning));
  }
  for (const ViewQuality& view : camera.views) {
    proto::ViewQuality* quality = out->add_view_quality();
    quality->set_view(ValidUtf8(view.view));
    quality->set_heldout(view.heldout);
    quality->set_distance_transform_px(view.distance_transform_px);
    quality->set_edge_rms_px(view.edge_rms_px);
    SetFinite(view.edge_rms_whitened, &proto::ViewQuality::set_edge_rms_whitened, quality);
    SetFinite(view.edge_rms_mm, &proto::ViewQuality::set_edge_rms_mm, quality);
    SetFinite(view.plane_rms_mm, &proto::ViewQuality::set_plane_rms_mm, quality);
  }
}

void ToViews(const proto::CameraReport& message, CameraReport* camera) {
  const proto::Views& views = message.views();
  camera->used.assign(views.used().begin(), views.used().end());
  camera->heldout.assign(views.heldout().begin(), views.heldout().end());
  camera->warnings.assign(views.warnings().begin(), views.warnings().end());
  for (const proto::RejectedView& view : views.rejected()) {
    camera->rejected.push_back({view.view(), view.why(), view.copy()});
  }
  for (const proto::ViewQuality& view : message.view_quality()) {
    ViewQuality& quality = camera->views.emplace_back(ViewQuality{
        view.view(), view.heldout(), view.distance_transform_px(), view.edge_rms_px(), {}});
    if (view.has_edge_rms_whitened()) quality.edge_rms_whitened = view.edge_rms_whitened();
    if (view.has_edge_rms_mm()) quality.edge_rms_mm = view.edge_rms_mm();
    if (view.has_plane_rms_mm()) quality.plane_rms_mm = view.plane_rms_mm();
  }
}

void FromDetection(const DetectedView& detection, proto::DetectedView* out) {
  out->set_view(ValidUtf8(detection.view));
  out->set_heldout(detection.heldout);
  for (const DetectedView::InImage& image : detection.images) {
    proto::DetectedView::InImage* in_image = out->add_images();
    in_image->set_camera(ValidUtf8(image.camera));
    in_image->set_why_not(ValidUtf8(image.why_not));
  }
  out->set_cloud_candidates(detection.cloud_candidates);
  out->set_cloud_why_not(ValidUtf8(detection.cloud_why_not));
}

DetectedView ToDetection(const proto::DetectedView& message) {
  DetectedView detection{
      message.view(), message.heldout(), {}, message.cloud_candidates(), message.cloud_why_not()};
  for (const proto::DetectedView::InImage& image : message.images()) {
    detection.images.push_back({image.camera(), image.why_not()});
  }
  return detection;
}

void FromCause(const Cause& cause, proto::Cause* out) {
  out->set_name(ValidUtf8(cause.name));
  out->set_words(ValidUtf8(cause.words));
  out->set_chi2(cause.chi2);
  out->set_freedom(cause.freedom);
  if (cause.moves_sigma) out->set_moves_sigma(*cause.moves_sigma);
}

Cause ToCause(const proto::Cause& message) {
  Cause cause{message.name(), message.words(), message.chi2(), message.freedom(), std::nullopt};
  if (message.has_moves_sigma()) cause.moves_sigma = message.moves_sigma();
  return cause;
}

void FromVerdict(const Verdict& verdict, proto::Verdict* out) {
  out->set_grade(NameOf(verdict.grade));
  out->set_headline(ValidUtf8(verdict.headline));
  for (const std::string& reason : verdict.reasons) out->add_reasons(ValidUtf8(reason));
}

Verdict ToVerdict(const proto::Verdict& message) {
  return {GradeNamed(message.grade()),
          message.headline(),
          {message.reasons().begin(), message.reasons().end()}};
}

void FromStart(const StartResult& start, proto::StartResult* out) {
  out->set_start(ValidUtf8(start.start));
  text::FromRigid3(start.calibration.camera_from_lidar, out->mutable_camera_from_lidar());
  out->set_status(text::FromStatus(start.calibration.status));
  out->set_detail(ValidUtf8(start.calibration.detail));
  if (start.distance_transform_px && std::isfinite(*start.distance_transform_px)) {
    out->set_distance_transform_px(*start.distance_transform_px);
  }
  FromPoseError(start.from_result, out->mutable_from_result());
  if (start.truth_error) FromPoseError(*start.truth_error, out->mutable_truth_error());
}

StartResult ToStart(const proto::StartResult& message, const std::string& camera,
                    const Place& place) {
  StartResult start;
  start.start = message.start();
  start.calibration.camera = camera;
  start.calibration.camera_from_lidar =
      text::ToRigid3(message.camera_from_lidar(), place.In("camera_from_lidar"));
  start.calibration.status = text::ToStatus(message.status(), place);
  start.calibration.detail = message.detail();
  if (message.has_distance_transform_px()) {
    start.distance_transform_px = message.distance_transform_px();
  }
  start.from_result = ToPoseError(message.from_result());
  if (message.has_truth_error()) start.truth_error = ToPoseError(message.truth_error());
  return start;
}

void FromCamera(const CameraReport& camera, proto::CameraReport* out) {
  const CameraCalibration& calibration = camera.calibration;
  text::FromRigid3(calibration.camera_from_lidar, out->mutable_camera_from_lidar());
  out->set_status(text::FromStatus(calibration.status));
  out->set_detail(ValidUtf8(calibration.detail));
  if (calibration.covariance && calibration.covariance->allFinite()) {
    text::FromMatrix(*calibration.covariance, out->mutable_covariance());
  }
  if (calibration.lens) text::FromSolvedLens(*calibration.lens, out->mutable_lens());
  if (camera.first_guess) text::FromRigid3(*camera.first_guess, out->mutable_first_guess());
  FromViews(camera, out);
  text::FromTrainHeldout(camera.distance_transform_px, out->mutable_distance_transform_px());
  text::FromTrainHeldout(camera.edge_rms_px, out->mutable_edge_rms_px());
  for (const StartResult& start : camera.other_starts) FromStart(start, out->add_other_starts());
  if (camera.first_guess_error) {
    FromPoseError(*camera.first_guess_error, out->mutable_first_guess_error());
  }
  if (camera.truth_error) FromPoseError(*camera.truth_error, out->mutable_truth_error());
  if (calibration.range_errors) {
    text::FromRangeErrors(*calibration.range_errors, out->mutable_range_errors());
  }
  if (calibration.timing) text::FromTiming(*calibration.timing, out->mutable_timing());
  out->set_contradiction(ValidUtf8(camera.contradiction));
  out->set_cannot_tell(ValidUtf8(camera.cannot_tell));
  for (const Cause& cause : camera.causes) FromCause(cause, out->add_causes());
  if (camera.verdict) FromVerdict(*camera.verdict, out->mutable_verdict());
  if (camera.view_scatter) {
    out->mutable_view_scatter()->set_factor(camera.view_scatter->factor);
    out->mutable_view_scatter()->set_freedom(camera.view_scatter->freedom);
  }
  if (camera.variance_factor != 1) out->set_variance_factor(camera.variance_factor);
  text::FromUncertainty(camera, out);
  out->mutable_seconds()->set_detect_image(camera.detect_image_s);
  out->mutable_seconds()->set_detect_cloud(camera.detect_cloud_s);
  out->mutable_seconds()->set_solve(camera.solve_s);
}

CameraReport ToCamera(const std::string& name, const proto::CameraReport& message,
                      const Place& place) {
  CameraReport camera;
  camera.calibration.camera = name;
  camera.calibration.camera_from_lidar =
      text::ToRigid3(message.camera_from_lidar(), place.In("camera_from_lidar"));
  camera.calibration.status = text::ToStatus(message.status(), place);
  camera.calibration.detail = message.detail();
  if (message.has_covariance()) {
    camera.calibration.covariance = text::ToMatrix(message.covariance(), place.In("covariance"));
  }
  if (message.has_lens()) {
    camera.calibration.lens = text::ToSolvedLens(message.lens(), place.In("lens"));
  }
  if (message.has_first_guess()) {
    camera.first_guess = text::ToRigid3(message.first_guess(), place.In("first_guess"));
  }
  ToViews(message, &camera);
  camera.distance_transform_px = text::ToTrainHeldout(message.distance_transform_px());
  camera.edge_rms_px = text::ToTrainHeldout(message.edge_rms_px());
  for (int i = 0; i < message.other_starts_size(); ++i) {
    camera.other_starts.push_back(
        ToStart(message.other_starts(i), name, place.In("other_starts", i)));
  }
  if (message.has_range_errors()) {
    camera.calibration.range_errors =
        text::ToRangeErrors(message.range_errors(), place.In("range_errors"));
  }
  if (message.has_timing()) {
    camera.calibration.timing = text::ToTiming(message.timing(), place.In("timing"));
  }
  if (message.has_view_scatter()) {
    camera.view_scatter =
        ViewScatter{message.view_scatter().factor(), message.view_scatter().freedom()};
  }
  camera.contradiction = message.contradiction();
  camera.cannot_tell = message.cannot_tell();
  for (const proto::Cause& cause : message.causes()) camera.causes.push_back(ToCause(cause));
  if (message.has_verdict()) camera.verdict = ToVerdict(message.verdict());
  if (message.has_variance_factor()) camera.variance_factor = message.variance_factor();
  if (message.has_first_guess_error()) {
    camera.first_guess_error = ToPoseError(message.first_guess_error());
  }
  if (message.has_truth_error()) camera.truth_error = ToPoseError(message.truth_error());
  text::ToUncertainty(message, place, &camera);
  camera.detect_image_s = message.seconds().detect_image();
  camera.detect_cloud_s = message.seconds().detect_cloud();
  camera.solve_s = message.seconds().solve();
  return camera;
}

// Protobuf puts the reason, the place and a mark below it on three lines.
std::string OneLine(const std::string& message) {
  std::string line;
  for (const char c : message) {
    const bool space = static_cast<unsigned char>(c) <= ' ';
    if (!space || (!line.empty() && line.back() != ' ')) line += space ? ' ' : c;
  }
  while (!line.empty() && (line.back() == ' ' || line.back() == '^')) line.pop_back();
  return line;
}

// A map has no order of its own; this gives it one, run after run.
std::string SerializeInOrder(const google::protobuf::Message& message) {
  std::string bytes;
  google::protobuf::io::StringOutputStream stream(&bytes);
  google::protobuf::io::CodedOutputStream coded(&stream);
  coded.SetSerializationDeterministic(true);
  message.SerializeToCodedStream(&coded);
  coded.Trim();
  return bytes;
}

std::string ToJson(const google::protobuf::Message& message) {
  namespace util = google::protobuf::util;
  const google::protobuf::Descriptor* type = message.GetDescriptor();
  const std::unique_ptr<util::TypeResolver> resolver(util::NewTypeResolverForDescriptorPool(
      "type.googleapis.com", google::protobuf::DescriptorPool::generated_pool()));
  util::JsonPrintOptions options;
  options.add_whitespace = true;
  options.always_print_primitive_fields = true;
  options.preserve_proto_field_names = true;
  std::string json;
  const util::Status status =
      util::BinaryToJsonString(resolver.get(), "type.googleapis.com/" + type->full_name(),
                               SerializeInOrder(message), &json, options);
  if (!status.ok()) throw InputError("the report cannot be printed: " + status.ToString());
  return json;
}

}  // namespace

std::string ReportToJson(const Report& report) {
  proto::Report message;
  message.set_method(ValidUtf8(report.method));
  message.set_rig_hash(ValidUtf8(report.rig_hash));
  message.set_utime(report.utime);
  for (const DetectedView& detection : report.detections) {
    FromDetection(detection, message.add_detections());
  }
  for (const CameraReport& camera : report.cameras) {
    FromCamera(camera, &(*message.mutable_cameras())[ValidUtf8(camera.calibration.camera)]);
  }
  for (const LidarReport& lidar : report.lidars) {
    text::FromLidarReport(lidar, message.add_lidars());
  }
  text::FromRigWide(report, &message);
  return ToJson(message);
}

Report ReportFromJson(const std::string& json, const std::string& where) {
  proto::Report message;
  if (ValidUtf8(json) != json) throw InputError(where + ": is not UTF-8 text; expected JSON");
  const auto status = google::protobuf::util::JsonStringToMessage(json, &message);
  if (!status.ok()) {
    throw InputError(where + ": is not a report: " + OneLine(std::string(status.message())));
  }
  Report report;
  report.method = message.method();
  report.rig_hash = message.rig_hash();
  report.utime = message.utime();
  for (const proto::DetectedView& detection : message.detections()) {
    report.detections.push_back(ToDetection(detection));
  }
  for (const auto& [name, camera] : message.cameras()) {
    std::string at = where;
    at.append(": camera \"").append(name).append("\"");
    const Place place(at, camera.GetDescriptor(), nullptr);
    report.cameras.push_back(ToCamera(name, camera, place));
  }
  const Place place(where, message.GetDescriptor(), nullptr);
  for (int i = 0; i < message.lidars_size(); ++i) {
    report.lidars.push_back(text::ToLidarReport(message.lidars(i), place.In("lidars", i)));
  }
  text::ToRigWide(message, where, &report);
  std::sort(report.cameras.begin(), report.cameras.end(),
            [](const CameraReport& a, const CameraReport& b) {
              return a.calibration.camera < b.calibration.camera;
            });
  return report;
}

void WriteReport(const std::filesystem::path& path, const Report& report) {
  WriteFileAtomically(path, ReportToJson(report));
}

Report ReadReport(const std::filesystem::path& path) {
  return ReportFromJson(ReadWholeFile(path), path.string());
}

}  // namespace rgbdt
