#include "calib/solve/internal/lens_by_images.h"

#include <algorithm>

#include "calib/camera/lens_choice.h"
#include "calib/model/linear_algebra.h"
#include "calib/model/text.h"
#include "calib/solve/internal/lens_check.h"

namespace rgbdt {
namespace {

constexpr std::size_t kLeastViews = 5;
// Of the RMS. Both models bend lines alike in a narrow view; with the right one, whatever else was
// given wrong of the lens, the other does not fit better.
constexpr double kMuchBetter = 0.8;

const char* NameOf(Lens::Model model) {
  return model == Lens::Model::kFisheye ? "fisheye" : "pinhole";
}

Lens::Model ModelOf(LensChoice choice) {
  return choice == LensChoice::kFisheye ? Lens::Model::kFisheye : Lens::Model::kPinhole;
}

const char* OptionOf(LensChoice choice) {
  return choice == LensChoice::kFisheye    ? "fisheye"
         : choice == LensChoice::kPinhole8 ? "pinhole8"
                                           : "pinhole5";
}

}  // namespace

std::optional<LensByImages> FindLensByImages(const Target& target, const CameraViews& views) {
  if (!target.HasPattern()) return std::nullopt;
  LensByImages lens;
  IntrinsicsInput& input = lens.input;
  input.choice = views.spec->lens.model == Lens::Model::kFisheye ? LensChoice::kFisheye
                                                                 : LensChoice::kPinhole5;
  input.width = views.spec->width;
  input.height = views.spec->height;
  input.target = target;
  for (const CameraView& view : views.all) {
    if (view.image == nullptr || view.image->corners.empty()) continue;
    if (!std::all_of(view.image->corners.begin(), view.image->corners.end(), &IsSeen)) continue;
    input.views.push_back({view.view, view.image->corners});
  }
  if (input.views.size() < kLeastViews) return std::nullopt;
  lens.result = CalibrateIntrinsics(input);
  return lens;
}

bool ImagesRefute(const LensByImages& lens, const Lens& given) {
  const IntrinsicsResult& found = lens.result;
  const Eigen::Index count = found.covariance.rows();
  if (!found.converged || count == 0 || found.lens.model != given.model) return false;
  const Eigen::VectorXd off = (NumbersOf(found.lens) - NumbersOf(given)).head(count);
  LensOff refuted;
  refuted.chi2 = off.dot(SolveSymmetric(Eigen::MatrixXd(4 * found.covariance), off));
  refuted.freedom = static_cast<int>(count);
  return refuted.contradicts();
}

std::optional<Cause> OtherModel(const LensByImages& lens, const CameraSpec& camera) {
  const auto better = CompareLenses(lens.input, lens.result).better;
  if (!better || ModelOf(better->choice) == camera.lens.model) return std::nullopt;
  if (!(better->rms_px < kMuchBetter * better->asked_rms_px)) return std::nullopt;
  const char* given = NameOf(camera.lens.model);
  const char* wanted = NameOf(ModelOf(better->choice));
  return Cause{
      "lens model",
      Format("%s has no %s lens, as the rig file says: a %s lens fits its images' corners to %.2f "
             "px, a %s lens to %.2f px. Find the lens with 20 views or more all over the image "
             "(rgbdt intrinsics --model %s)",
             camera.name.c_str(), given, wanted, better->rms_px, given, better->asked_rms_px,
             OptionOf(better->choice)),
      -better->bic, 1};
}

}  // namespace rgbdt
