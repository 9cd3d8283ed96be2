#include "calib/files/schema/internal/report_parts.h"

#include <limits>

#include "calib/files/schema/proto_convert.h"
#include "calib/model/pose_sigma.h"
#include "calib/model/text.h"

namespace rgbdt::text {
namespace {

double OrNan(bool known, double value) {
  return known ? value : std::numeric_limits<double>::quiet_NaN();
}

bool Finite(const Rigid3& pose) {
  return pose.rotation.coeffs().allFinite() && pose.translation.allFinite();
}

// All three or none: a list with a gap would shift the axes.
void FromAxes(const std::array<double, 3>& axes, Numbers* out) {
  for (const double value : axes) {
    if (!std::isfinite(value)) return;
  }
  out->Add(axes.begin(), axes.end());
}

std::array<double, 3> ToAxes(const Numbers& numbers, const Place& place, const char* field) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  if (numbers.empty()) return {nan, nan, nan};
  RequireNumbers(numbers, 3, place, field);
  return {numbers[0], numbers[1], numbers[2]};
}

void FromSigma(const PoseSigma& sigma, proto::PoseSigma* out) {
  FromAxes(sigma.rotation_deg, out->mutable_rotation_deg());
  FromAxes(sigma.centre_mm, out->mutable_centre_mm());
  for (const ColouringSigma& at : sigma.colouring) {
    proto::ColouringSigma* message = out->add_colouring();
    SetFinite(at.distance_m, &proto::ColouringSigma::set_distance_m, message);
    SetFinite(at.centre_px, &proto::ColouringSigma::set_centre_px, message);
    SetFinite(at.worst_px, &proto::ColouringSigma::set_worst_px, message);
  }
}

PoseSigma ToSigma(const proto::PoseSigma& message, const Place& place) {
  PoseSigma sigma;
  sigma.rotation_deg = ToAxes(message.rotation_deg(), place, "rotation_deg");
  sigma.centre_mm = ToAxes(message.centre_mm(), place, "centre_mm");
  for (const proto::ColouringSigma& at : message.colouring()) {
    sigma.colouring.push_back({OrNan(at.has_distance_m(), at.distance_m()),
                               OrNan(at.has_centre_px(), at.centre_px()),
                               OrNan(at.has_worst_px(), at.worst_px())});
  }
  return sigma;
}

void FromFold(const Fold& fold, proto::Fold* out) {
  for (const std::string& view : fold.heldout) out->add_heldout(ValidUtf8(view));
  SetFinite(fold.edge_rms_whitened, &proto::Fold::set_edge_rms_whitened, out);
  SetFinite(fold.misfit, &proto::Fold::set_misfit, out);
  SetFinite(fold.expected_misfit, &proto::Fold::set_expected_misfit, out);
  SetFinite(fold.first_guess_misfit, &proto::Fold::set_first_guess_misfit, out);
  FromPoseError(fold.from_result, out->mutable_from_result());
}

Fold ToFold(const proto::Fold& message) {
  Fold fold;
  fold.heldout.assign(message.heldout().begin(), message.heldout().end());
  fold.edge_rms_whitened = OrNan(message.has_edge_rms_whitened(), message.edge_rms_whitened());
  fold.misfit = OrNan(message.has_misfit(), message.misfit());
  if (message.has_expected_misfit()) fold.expected_misfit = message.expected_misfit();
  fold.first_guess_misfit = OrNan(message.has_first_guess_misfit(), message.first_guess_misfit());
  fold.from_result = ToPoseError(message.from_result());
  return fold;
}

void FromNuisance(const Nuisance& nuisance, proto::Nuisance* out) {
  out->set_name(ValidUtf8(nuisance.name));
  out->set_unit(ValidUtf8(nuisance.unit));
  FromEstimate(nuisance.estimate, out->mutable_estimate());
}

void FromHalves(const Halves& halves, proto::Halves* out) {
  FromPoseError(halves.difference, out->mutable_difference());
  SetFinite(halves.chi2, &proto::Halves::set_chi2, out);
  if (halves.sigma_enlarged) out->set_sigma_enlarged(*halves.sigma_enlarged);
}

Halves ToHalves(const proto::Halves& message) {
  Halves halves{ToPoseError(message.difference()), OrNan(message.has_chi2(), message.chi2())};
  if (message.has_sigma_enlarged()) halves.sigma_enlarged = message.sigma_enlarged();
  return halves;
}

void FromClosure(const Closure& closure, proto::Closure* out) {
  out->set_from(ValidUtf8(closure.from));
  out->set_to(ValidUtf8(closure.to));
  FromRigid3(closure.by_lidar, out->mutable_to_from_from_by_lidar());
  FromRigid3(closure.by_images, out->mutable_to_from_from_by_images());
  FromPoseError(closure.difference, out->mutable_difference());
  FromPoseError(closure.sigma, out->mutable_sigma());
  SetFinite(closure.chi2, &proto::Closure::set_chi2, out);
}

Closure ToClosure(const proto::Closure& message, const Place& place) {
  Closure closure;
  closure.from = message.from();
  closure.to = message.to();
  closure.by_lidar = ToRigid3(message.to_from_from_by_lidar(), place.In("to_from_from_by_lidar"));
  closure.by_images =
      ToRigid3(message.to_from_from_by_images(), place.In("to_from_from_by_images"));
  closure.difference = ToPoseError(message.difference());
  closure.sigma = ToPoseError(message.sigma());
  closure.chi2 = OrNan(message.has_chi2(), message.chi2());
  return closure;
}

void FromNextView(const NextView& view, proto::NextView* out) {
  out->set_words(ValidUtf8(view.words));
  out->set_camera(ValidUtf8(view.camera));
  FromRigid3(view.lidar_from_target, out->mutable_lidar_from_target());
  SetFinite(view.sigma_before_px, &proto::NextView::set_sigma_before_px, out);
  SetFinite(view.sigma_after_px, &proto::NextView::set_sigma_after_px, out);
}

NextView ToNextView(const proto::NextView& message, const Place& place) {
  NextView view;
  view.words = message.words();
  view.camera = message.camera();
  view.lidar_from_target = ToRigid3(message.lidar_from_target(), place.In("lidar_from_target"));
  view.sigma_before_px = OrNan(message.has_sigma_before_px(), message.sigma_before_px());
  view.sigma_after_px = OrNan(message.has_sigma_after_px(), message.sigma_after_px());
  return view;
}

}  // namespace

void FromPoseError(const PoseError& error, proto::PoseError* out) {
  SetFinite(error.rotation_deg, &proto::PoseError::set_rotation_deg, out);
  SetFinite(error.translation_mm, &proto::PoseError::set_translation_mm, out);
}

PoseError ToPoseError(const proto::PoseError& error) {
  return {OrNan(error.has_rotation_deg(), error.rotation_deg()),
          OrNan(error.has_translation_mm(), error.translation_mm())};
}

void FromEstimate(const Estimate& estimate, proto::Estimate* out) {
  SetFinite(estimate.value, &proto::Estimate::set_value, out);
  SetFinite(estimate.sigma, &proto::Estimate::set_sigma, out);
}

Estimate ToEstimate(const proto::Estimate& estimate) {
  return {OrNan(estimate.has_value(), estimate.value()),
          OrNan(estimate.has_sigma(), estimate.sigma())};
}

void FromTiming(const CameraTiming& timing, proto::CameraTiming* out) {
  FromEstimate(timing.time_offset_s, out->mutable_time_offset_s());
  FromEstimate(timing.rolling_s, out->mutable_rolling_s());
}

CameraTiming ToTiming(const proto::CameraTiming& timing, const Place& place) {
  const auto seconds = [&](const proto::Estimate& message, const char* field, double most) {
    const Place at = place.In(field);
    RequireFinite(message.value(), at, "value");
    RequireFinite(message.sigma(), at, "sigma");
    if (std::abs(message.value()) > most || message.sigma() < 0) {
      place.Fail(field, "is " + std::to_string(message.value()) + " +- " +
                            std::to_string(message.sigma()) + "; expected seconds within " +
                            std::to_string(most) + ", and a sigma of 0 or more");
    }
    return Estimate{message.value(), message.sigma()};
  };
  // A minute is no offset of a clock, a second no read-out.
  return {seconds(timing.time_offset_s(), "time_offset_s", 60),
          seconds(timing.rolling_s(), "rolling_s", 1)};
}

void FromRangeErrors(const RangeErrors& errors, proto::RangeErrors* out) {
  FromEstimate(errors.offset_m, out->mutable_offset_m());
  for (const auto& [ring, offset_m] : errors.rings) {
    proto::RangeErrors::OfRing* const of = out->add_ring();
    of->set_ring(ring);
    FromEstimate(offset_m, of->mutable_offset_m());
  }
  for (const auto& [log2_intensity, offset_m] : errors.intensities) {
    proto::RangeErrors::OfIntensity* const of = out->add_intensity();
    of->set_log2_intensity(log2_intensity);
    FromEstimate(offset_m, of->mutable_offset_m());
  }
  FromEstimate(errors.beams_meet_m, out->mutable_beams_meet_m());
}

RangeErrors ToRangeErrors(const proto::RangeErrors& errors, const Place& place) {
  const auto estimate = [](const proto::Estimate& message, const Place& at) {
    const Estimate out = ToEstimate(message);
    RequireFinite(out.value, at, "value");
    RequireFinite(out.sigma, at, "sigma");
    if (out.sigma < 0) at.Fail("sigma", "is " + std::to_string(out.sigma) + "; expected 0 or more");
    return out;
  };
  RangeErrors out;
  out.offset_m = estimate(errors.offset_m(), place.In("offset_m"));
  out.beams_meet_m = estimate(errors.beams_meet_m(), place.In("beams_meet_m"));
  for (int i = 0; i < errors.ring_size(); ++i) {
    const Place at = place.In("ring", i);
    const int ring = errors.ring(i).ring();
    if (ring < 0 || ring >= kMostLasers || (i > 0 && ring <= out.rings.back().ring)) {
      at.Fail("ring", "is " + std::to_string(ring) + "; expected numbers from 0 on that rise");
    }
    out.rings.push_back({ring, estimate(errors.ring(i).offset_m(), at.In("offset_m"))});
  }
  for (int i = 0; i < errors.intensity_size(); ++i) {
    const Place at = place.In("intensity", i);
    const double log2 = errors.intensity(i).log2_intensity();
    if (!(log2 >= kLeastLog2Intensity && log2 <= 0) ||
        (i > 0 && log2 != out.intensities.back().log2_intensity + 1)) {
      at.Fail("log2_intensity",
              "is " + std::to_string(log2) + "; expected -16 to 0, each one more than the last");
    }
    out.intensities.push_back({log2, estimate(errors.intensity(i).offset_m(), at.In("offset_m"))});
  }
  return out;
}

void FromTrainHeldout(const TrainHeldout& figure, proto::TrainHeldout* out) {
  SetFinite(figure.train, &proto::TrainHeldout::set_train, out);
  SetFinite(figure.heldout, &proto::TrainHeldout::set_heldout, out);
}

TrainHeldout ToTrainHeldout(const proto::TrainHeldout& figure) {
  TrainHeldout out;
  if (figure.has_train()) out.train = figure.train();
  if (figure.has_heldout()) out.heldout = figure.heldout();
  return out;
}

namespace {

// Absent where neither is known.
void FromKnown(const TrainHeldout& figure, proto::TrainHeldout* (proto::CameraReport::*figure_of)(),
               proto::CameraReport* out) {
  proto::TrainHeldout message;
  FromTrainHeldout(figure, &message);
  if (message.has_train() || message.has_heldout()) *(out->*figure_of)() = message;
}

}  // namespace

namespace {

void FromScene(const SceneCheck& check, proto::SceneCheck* out) {
  out->set_edges(check.edges);
  out->set_shown(check.shown);
  SetFinite(check.heldout_start, &proto::SceneCheck::set_heldout_start, out);
  SetFinite(check.heldout_result, &proto::SceneCheck::set_heldout_result, out);
  if (check.joined) out->set_joined(true);
}

SceneCheck ToScene(const proto::SceneCheck& message) {
  SceneCheck check{message.edges(), message.shown(), {}, {}};
  if (message.has_heldout_start()) check.heldout_start = message.heldout_start();
  if (message.has_heldout_result()) check.heldout_result = message.heldout_result();
  check.joined = message.joined();
  return check;
}

}  // namespace

void FromUncertainty(const CameraReport& camera, proto::CameraReport* out) {
  FromKnown(camera.edge_rms_whitened, &proto::CameraReport::mutable_edge_rms_whitened, out);
  FromKnown(camera.edge_rms_mm, &proto::CameraReport::mutable_edge_rms_mm, out);
  FromKnown(camera.plane_rms_mm, &proto::CameraReport::mutable_plane_rms_mm, out);
  if (camera.sigma) FromSigma(*camera.sigma, out->mutable_sigma());
  if (const auto worst = WorstAxisSigma(camera.calibration); worst && camera.sigma) {
    out->mutable_sigma()->set_worst_rotation_deg(worst->rotation_deg);
    out->mutable_sigma()->set_worst_centre_mm(worst->translation_mm);
  }
  for (const Nuisance& nuisance : camera.nuisance) FromNuisance(nuisance, out->add_nuisance());
  for (const Fold& fold : camera.folds) FromFold(fold, out->add_folds());
  if (camera.halves) FromHalves(*camera.halves, out->mutable_halves());
  if (camera.edges_planes) FromHalves(*camera.edges_planes, out->mutable_edges_planes());
  if (camera.scene) FromScene(*camera.scene, out->mutable_scene());
}

void ToUncertainty(const proto::CameraReport& message, const Place& place, CameraReport* camera) {
  camera->edge_rms_whitened = ToTrainHeldout(message.edge_rms_whitened());
  camera->edge_rms_mm = ToTrainHeldout(message.edge_rms_mm());
  camera->plane_rms_mm = ToTrainHeldout(message.plane_rms_mm());
  if (message.has_sigma()) camera->sigma = ToSigma(message.sigma(), place.In("sigma"));
  for (const proto::Nuisance& nuisance : message.nuisance()) {
    camera->nuisance.push_back({nuisance.name(), nuisance.unit(), ToEstimate(nuisance.estimate())});
  }
  for (const proto::Fold& fold : message.folds()) camera->folds.push_back(ToFold(fold));
  if (message.has_halves()) camera->halves = ToHalves(message.halves());
  if (message.has_edges_planes()) camera->edges_planes = ToHalves(message.edges_planes());
  if (message.has_scene()) camera->scene = ToScene(message.scene());
}

void FromRigWide(const Report& report, proto::Report* out) {
  for (const Closure& closure : report.closure) {
    if (Finite(closure.by_lidar) && Finite(closure.by_images)) {
      FromClosure(closure, out->add_closure());
    }
  }
  if (report.next_view && Finite(report.next_view->lidar_from_target)) {
    FromNextView(*report.next_view, out->mutable_next_view());
  }
}

void ToRigWide(const proto::Report& message, const std::string& where, Report* report) {
  const Place place(where, message.GetDescriptor(), nullptr);
  for (int i = 0; i < message.closure_size(); ++i) {
    report->closure.push_back(ToClosure(message.closure(i), place.In("closure", i)));
  }
  if (message.has_next_view()) {
    report->next_view = ToNextView(message.next_view(), place.In("next_view"));
  }
}

}  // namespace rgbdt::text
