#include "calib/files/schema/internal/lidar_convert.h"

#include <algorithm>

#include "calib/files/schema/internal/report_parts.h"
#include "calib/files/schema/proto_convert.h"
#include "calib/model/text.h"

namespace rgbdt::text {
namespace {

void FromViewsOfLidar(const LidarReport& lidar, proto::Views* out) {
  for (const std::string& view : lidar.used) out->add_used(ValidUtf8(view));
  for (const RejectedView& view : lidar.rejected) {
    proto::RejectedView* rejected = out->add_rejected();
    rejected->set_view(ValidUtf8(view.view));
    rejected->set_why(ValidUtf8(view.why));
  }
  for (const std::string& warning : lidar.warnings) out->add_warnings(ValidUtf8(warning));
}

void ToViewsOfLidar(const proto::Views& views, LidarReport* lidar) {
  lidar->used.assign(views.used().begin(), views.used().end());
  lidar->warnings.assign(views.warnings().begin(), views.warnings().end());
  for (const proto::RejectedView& view : views.rejected()) {
    lidar->rejected.push_back({view.view(), view.why()});
  }
}

std::array<double, 3> ToThree(const Numbers& numbers, const Place& place,
                              const std::string& field) {
  RequireNumbers(numbers, 3, place, field);
  return {numbers[0], numbers[1], numbers[2]};
}

}  // namespace

void FromLidarCalibration(const LidarCalibration& lidar, proto::LidarCalibration* out) {
  out->set_lidar(ValidUtf8(lidar.lidar));
  FromRigid3(lidar.reference_from_lidar, out->mutable_reference_from_lidar());
  out->set_status(FromStatus(lidar.status));
  out->set_detail(ValidUtf8(lidar.detail));
  if (lidar.covariance && lidar.covariance->allFinite()) {
    FromMatrix(*lidar.covariance, out->mutable_covariance());
  }
}

LidarCalibration ToLidarCalibration(const proto::LidarCalibration& lidar, const Place& place) {
  if (lidar.lidar().empty()) place.Fail("lidar", "is missing; expected the LIDAR's name");
  LidarCalibration out;
  out.lidar = lidar.lidar();
  out.reference_from_lidar =
      ToRigid3(lidar.reference_from_lidar(), place.In("reference_from_lidar"));
  if (lidar.has_covariance()) {
    out.covariance = ToMatrix(lidar.covariance(), place.In("covariance"));
  }
  out.status = ToStatus(lidar.status(), place);
  out.detail = lidar.detail();
  return out;
}

void FromLidarReport(const LidarReport& lidar, proto::LidarReport* out) {
  FromLidarCalibration(lidar.calibration, out->mutable_calibration());
  if (lidar.first_guess) FromRigid3(*lidar.first_guess, out->mutable_first_guess());
  FromViewsOfLidar(lidar, out->mutable_views());
  if (lidar.sigma) {
    for (const double sigma : lidar.sigma->rotation_deg) {
      out->mutable_sigma()->add_rotation_deg(sigma);
    }
    for (const double sigma : lidar.sigma->translation_mm) {
      out->mutable_sigma()->add_translation_mm(sigma);
    }
  }
  for (const Nuisance& nuisance : lidar.nuisance) {
    proto::Nuisance* line = out->add_nuisance();
    line->set_name(ValidUtf8(nuisance.name));
    line->set_unit(ValidUtf8(nuisance.unit));
    FromEstimate(nuisance.estimate, line->mutable_estimate());
  }
  if (lidar.truth_error) FromPoseError(*lidar.truth_error, out->mutable_truth_error());
}

LidarReport ToLidarReport(const proto::LidarReport& lidar, const Place& place) {
  LidarReport out;
  out.calibration = ToLidarCalibration(lidar.calibration(), place.In("calibration"));
  if (lidar.has_first_guess()) {
    out.first_guess = ToRigid3(lidar.first_guess(), place.In("first_guess"));
  }
  ToViewsOfLidar(lidar.views(), &out);
  if (lidar.has_sigma()) {
    const Place at = place.In("sigma");
    out.sigma = LidarSigma{ToThree(lidar.sigma().rotation_deg(), at, "rotation_deg"),
                           ToThree(lidar.sigma().translation_mm(), at, "translation_mm")};
  }
  for (const proto::Nuisance& nuisance : lidar.nuisance()) {
    out.nuisance.push_back({nuisance.name(), nuisance.unit(), ToEstimate(nuisance.estimate())});
  }
  if (lidar.has_truth_error()) out.truth_error = ToPoseError(lidar.truth_error());
  return out;
}

}  // namespace rgbdt::text
