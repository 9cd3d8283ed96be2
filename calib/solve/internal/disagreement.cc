#include "calib/solve/internal/disagreement.h"

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "calib/model/text.h"
#include "calib/solve/internal/lens_by_images.h"

namespace rgbdt {
namespace {

constexpr int kMostApart = 3;
constexpr std::size_t kLeastViews =
    5;  // that pairs of views must leave, so as not to agree by chance

// Three quarters.
bool MostAgree(int agreeing, std::size_t views) {
  return 4 * static_cast<std::size_t>(std::max(0, agreeing)) >= 3 * views;
}

// Each image beside the cloud of the view `apart` farther on.
CameraViews Shifted(const CameraViews& views, int apart) {
  CameraViews shifted = views;
  shifted.all.clear();
  const int count = static_cast<int>(views.all.size());
  for (int i = 0; i < count; ++i) {
    const int other = i + apart;
    if (other < 0 || other >= count) continue;
    CameraView view = views.all[static_cast<std::size_t>(i)];
    const CameraView& cloud = views.all[static_cast<std::size_t>(other)];
    view.candidates = cloud.candidates;
    view.cloud = cloud.cloud;
    view.rejected = view.image != nullptr && !view.candidates.empty() ? "" : "no image or no cloud";
    shifted.all.push_back(std::move(view));
  }
  return shifted;
}

std::string PairsAreOff(const CameraViews& views, int apart, int agreeing, std::size_t of) {
  const auto first = static_cast<std::size_t>(std::max(0, -apart));
  const auto second = static_cast<std::size_t>(static_cast<int>(first) + apart);
  return Format(
      "Images and clouds are %d apart: with the image of view %s beside the cloud of view %s, and "
      "so on, %d of %zu views agree. Pair them anew (rgbdt session), or rename them",
      std::abs(apart), views.all[first].view.c_str(), views.all[second].view.c_str(), agreeing, of);
}

}  // namespace

Disagreement WhyViewsDisagree(const Target& target, const CalibrateOptions& options,
                              const CameraViews& views, const FirstGuess& guess) {
  Disagreement why;
  const std::size_t found = views.Used().size();
  const int agreeing = guess.camera_from_lidar ? guess.agreeing : 0;
  if (found < kLeastViews || MostAgree(agreeing, found)) return why;
  int most = agreeing;
  for (int apart = -kMostApart; apart <= kMostApart; ++apart) {
    if (apart == 0) continue;
    const CameraViews shifted = Shifted(views, apart);
    const auto used = shifted.Used();
    if (used.size() < kLeastViews) continue;
    const FirstGuess other = GuessFromBoards(used, options.first_guess);
    if (!other.camera_from_lidar || !MostAgree(other.agreeing, used.size())) continue;
    if (other.agreeing < 2 * agreeing || other.agreeing <= most) continue;
    most = other.agreeing;
    why.contradiction = PairsAreOff(views, apart, other.agreeing, used.size());
  }
  if (!why.contradiction.empty()) return why;
  const auto lens = FindLensByImages(target, views);
  if (!lens) return why;
  why.other_model = OtherModel(*lens, *views.spec);
  if (!lens->result.converged) return why;
  const CameraViews posed = PosedAgain(views, lens->result.lens, target);
  const FirstGuess other = GuessFromBoards(posed.Used(), options.first_guess);
  if (other.camera_from_lidar && other.agreeing > agreeing && other.agreeing >= options.min_views) {
    why.lens = lens->result.lens;
  }
  return why;
}

}  // namespace rgbdt
