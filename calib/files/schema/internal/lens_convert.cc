#include "calib/files/schema/internal/lens_convert.h"

#include <algorithm>
#include <string>

#include "calib/files/schema/proto_convert.h"

namespace rgbdt::text {
namespace {

template <typename ProtoLens>
Lens ToLens(const ProtoLens& proto, Lens::Model model, std::initializer_list<int> counts,
            const Place& place) {
  Lens lens;
  lens.model = model;
  lens.fx = proto.fx();
  lens.fy = proto.fy();
  lens.cx = proto.cx();
  lens.cy = proto.cy();
  const int count = proto.distortion_size();
  if (std::find(counts.begin(), counts.end(), count) == counts.end()) {
    std::string expected;
    for (const int n : counts) expected += (expected.empty() ? "" : ", ") + std::to_string(n);
    place.Fail("distortion",
               "has " + std::to_string(count) + " numbers; expected one of " + expected);
  }
  std::copy(proto.distortion().begin(), proto.distortion().end(), lens.distortion.begin());
  return lens;
}

// Of a message with the one or the other.
template <typename Holder>
Lens LensIn(const Holder& holder, const Place& place) {
  if (holder.has_pinhole()) {
    return ToLens(holder.pinhole(), Lens::Model::kPinhole, {0, 4, 5, 8}, place.In("pinhole"));
  }
  if (holder.has_fisheye()) {
    return ToLens(holder.fisheye(), Lens::Model::kFisheye, {0, 4}, place.In("fisheye"));
  }
  return {};
}

template <typename ProtoLens>
void FromLens(const Lens& lens, int least, ProtoLens* out) {
  out->set_fx(lens.fx);
  out->set_fy(lens.fy);
  out->set_cx(lens.cx);
  out->set_cy(lens.cy);
  int count = least;
  if (lens.model == Lens::Model::kPinhole) {
    if (lens.distortion[4] != 0) count = 5;
    if (lens.distortion[5] != 0 || lens.distortion[6] != 0 || lens.distortion[7] != 0) count = 8;
  }
  for (int i = 0; i < count; ++i) out->add_distortion(lens.distortion[static_cast<size_t>(i)]);
}

template <typename Holder>
void PutLens(const Lens& lens, Holder* out) {
  if (lens.model == Lens::Model::kFisheye) {
    proto::Fisheye* const fisheye = out->mutable_fisheye();
    if (lens.known()) FromLens(lens, 4, fisheye);
  } else if (lens.known()) {
    FromLens(lens, 4, out->mutable_pinhole());
  }
}

// How many numbers the model has.
int CountOf(const Lens& lens) { return static_cast<int>(NamesOfNumbers(lens.model).size()); }

std::string ListOf(const Lens& lens) {
  std::string list;
  for (const std::string& name : NamesOfNumbers(lens.model)) list += " " + name;
  return list;
}

// Sigmas, of all numbers or of fx fy cx cy alone; the distortion is then known as is usual.
LensCovariance OfSigmas(const Numbers& sigmas, const CameraSpec& camera, const Place& place) {
  const int count = CountOf(camera.lens);
  if (sigmas.size() != 4 && sigmas.size() != count) {
    place.Fail("sigma", "has " + std::to_string(sigmas.size()) + " numbers; expected 4 (fx fy cx " +
                            "cy) or " + std::to_string(count) + " (" +
                            ListOf(camera.lens).substr(1) + ")");
  }
  RequireNumbers(sigmas, sigmas.size(), place, "sigma");
  LensCovariance covariance =
      UsualLensUncertainty(camera.lens, camera.width, camera.height).covariance;
  covariance.topLeftCorner<4, 4>().setZero();
  for (int i = 0; i < sigmas.size(); ++i) {
    if (sigmas[i] < 0) place.Fail("sigma", "has a number below 0; expected 1 sigma, 0 or more");
    covariance(i, i) = sigmas[i] * sigmas[i];
  }
  return covariance;
}

}  // namespace

Lens ToLens(const proto::Camera& camera, const Place& place) { return LensIn(camera, place); }

void FromLens(const Lens& lens, proto::Camera* out) { PutLens(lens, out); }

SolvedLens ToSolvedLens(const proto::SolvedLens& message, const Place& place) {
  SolvedLens solved;
  solved.lens = LensIn(message, place);
  if (!(solved.lens.fx > 0 && solved.lens.fy > 0)) {
    place.Fail("pinhole", "is missing; expected pinhole { ... } or fisheye { ... } with fx and fy");
  }
  RequireNumbers(message.covariance(), kLensNumbers * kPoseAndLens, place, "covariance");
  int i = 0;
  for (int row = 0; row < kLensNumbers; ++row) {
    for (int column = 0; column < kPoseAndLens; ++column) {
      solved.covariance(row, column) = message.covariance(i++);
    }
  }
  return solved;
}

void FromSolvedLens(const SolvedLens& solved, proto::SolvedLens* out) {
  PutLens(solved.lens, out);
  for (int row = 0; row < kLensNumbers; ++row) {
    for (int column = 0; column < kPoseAndLens; ++column) {
      out->add_covariance(solved.covariance(row, column));
    }
  }
}

LensUncertainty ToLensUncertainty(const proto::LensUncertainty& message, const CameraSpec& camera,
                                  const Place& place) {
  const int given = (message.exact() ? 1 : 0) + (message.sigma_size() > 0 ? 1 : 0) +
                    (message.covariance_size() > 0 ? 1 : 0);
  if (given != 1) {
    place.Fail("sigma", "is to be given, or covariance, or exact: true; one of them");
  }
  LensUncertainty out;
  const Numbers& middles = message.made_from();
  RequireNumbers(middles, middles.size() / 2 * 2, place, "made_from");
  for (int i = 0; i < middles.size(); i += 2)
    out.made_from.emplace_back(middles[i], middles[i + 1]);
  if (message.exact()) return out;
  if (message.sigma_size() > 0) {
    out.covariance = OfSigmas(message.sigma(), camera, place);
    return out;
  }
  const int count = CountOf(camera.lens);
  RequireNumbers(message.covariance(), count * count, place, "covariance");
  for (int i = 0; i < count * count; ++i) {
    out.covariance(i / count, i % count) = message.covariance(i);
  }
  return out;
}

void FromLensUncertainty(const CameraSpec& camera, proto::LensUncertainty* out) {
  const LensUncertainty& uncertainty = *camera.lens_uncertainty;
  for (const Eigen::Vector2d& middle : uncertainty.made_from) {
    out->add_made_from(middle.x());
    out->add_made_from(middle.y());
  }
  if (uncertainty.exact()) {
    out->set_exact(true);
    return;
  }
  const int count = CountOf(camera.lens);
  for (int row = 0; row < count; ++row) {
    for (int column = 0; column < count; ++column) {
      out->add_covariance(uncertainty.covariance(row, column));
    }
  }
}

}  // namespace rgbdt::text
