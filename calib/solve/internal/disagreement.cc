#include "calib/solve/internal/disagreement.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "calib/model/statistics.h"
#include "calib/model/text.h"
#include "calib/solve/internal/lens_by_images.h"
#include "calib/solve/internal/pattern_word.h"

namespace rgbdt {
namespace {

constexpr int kMostApart = 3;
constexpr std::size_t kLeastViews =
    5;  // that pairs of views must leave, so as not to agree by chance

constexpr double kLeastOffScale = 0.02;  // less does not keep views from agreeing

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

// By what distances between the boards of any two views differ in clouds and images: of any
// candidates, as the likeliest need not be the board. No pose of the camera has a say in them.
std::vector<double> ScalesOfPairs(const std::vector<const CameraView*>& views) {
  constexpr double kLeastApartM = 0.3, kMost = 1.35;
  const auto apart = [](const TargetPose& a, const TargetPose& b) {
    return (a.sensor_from_target.translation - b.sensor_from_target.translation).norm();
  };
  std::vector<double> scales;
  for (std::size_t i = 0; i < views.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (!views[i]->image->pose || !views[k]->image->pose) continue;
      const double by_images = apart(*views[i]->image->pose, *views[k]->image->pose);
      if (by_images < kLeastApartM) continue;
      for (const CloudEdges* a : views[i]->candidates) {
        for (const CloudEdges* b : views[k]->candidates) {
          if (!a->pose || !b->pose) continue;
          const double scale = apart(*a->pose, *b->pose) / by_images;
          if (scale > 1 / kMost && scale < kMost) scales.push_back(scale);
        }
      }
    }
  }
  std::sort(scales.begin(), scales.end());
  return scales;
}

// How much larger than by the images all is by the clouds: where most pairs of boards agree.
std::optional<Estimate> ScaleOfClouds(const std::vector<const CameraView*>& views) {
  constexpr double kAgree = 1.03;
  const std::vector<double> scales = ScalesOfPairs(views);
  auto first = scales.begin();
  auto last = scales.begin();
  for (auto from = scales.begin(); from != scales.end(); ++from) {
    const auto to = std::upper_bound(from, scales.end(), kAgree * *from);
    if (to - from <= last - first) continue;
    first = from;
    last = to;
  }
  if (last - first < static_cast<std::ptrdiff_t>(kLeastViews)) return std::nullopt;
  std::vector<double> agreeing(first, last);
  const double scale = Median(agreeing);
  for (double& one : agreeing) one = std::abs(one - scale);
  const auto count = static_cast<double>(views.size());
  return Estimate{scale, 1.4826 * Median(std::move(agreeing)) / std::sqrt(count)};
}

// As images of boards so many times as large would be.
CameraViews Scaled(CameraViews views, double scale) {
  for (CameraView& view : views.all) {
    if (!view.usable() || !view.image->pose) continue;
    auto edges = std::make_shared<ImageEdges>(*view.image);
    edges->pose->sensor_from_target.translation *= scale;
    view.image = edges.get();
    views.posed_again.push_back(std::move(edges));
  }
  return views;
}

// How much larger than given the board is in the clouds, where it is by this guess.
double BoardInClouds(const Target& target, const std::vector<const CameraView*>& views,
                     const Rigid3& camera_from_lidar) {
  std::vector<double> ratios;
  for (const CameraView* view : views) {
    const int board = ChooseCandidate(*view, camera_from_lidar, kVotingGate).candidate;
    if (board < 0) continue;
    ratios.push_back(view->candidates[static_cast<std::size_t>(board)]->width_m /
                     std::max(target.width_m, target.height_m));
  }
  return ratios.empty() ? 1 : Median(std::move(ratios));
}

// Images measure by the board's size and the focal length, clouds by the LIDAR's unit. Where the
// board itself is as much too large in the clouds, it is these, or all of the board.
// `board`: how much larger than given it is in the clouds.
std::vector<Cause> CausesOfScale(const Target& target, double board, const Estimate& scale) {
  constexpr double kTolerance = 0.002;
  const double off = std::abs(scale.value - 1);
  const double sigma = std::hypot(scale.sigma, kTolerance);
  const double chi2 = off * off / (sigma * sigma);
  const std::string apart =
      Format("the boards of any two views lie %.1f +- %.1f%% %s in the clouds than by the images: ",
             100 * off, 100 * sigma, scale.value > 1 ? "farther apart" : "nearer to each other");
  const char* larger = scale.value > 1 ? "larger" : "smaller";
  const std::string pattern = PatternWord(target);
  const Cause cloud{
      "cloud's scale",
      apart + Format("the cloud is too %s, or %s and board are all %s than given. Measure "
                     "board and %s, and check the LIDAR's unit of length against a tape "
                     "measure",
                     scale.value > 1 ? "large" : "small", pattern.c_str(), larger, pattern.c_str()),
      chi2, 1};
  const std::string what = target.HasPattern() ? pattern + " are" : "board is";
  const char* measure = target.holes          ? "them, and from one to the next"
                        : target.HasPattern() ? "ten of them with a ruler"
                                              : "it";
  const Cause size{
      target.HasPattern() ? pattern : "board's size",
      apart + Format("the %s %s than given. Measure %s", what.c_str(), larger, measure), chi2, 1};
  const Cause focal{"focal length",
                    apart + Format("the focal length of the lens in the rig file is too %s. Find "
                                   "the lens with 20 views or more all over the image (rgbdt "
                                   "intrinsics)",
                                   scale.value > 1 ? "short" : "long"),
                    chi2, 1};
  const bool all_of_it = std::abs(board - scale.value) < std::abs(board - 1);
  return all_of_it ? std::vector{cloud, size} : std::vector{size, focal};
}

// Nothing where another scale does not make half of the views agree, and far more than before.
std::vector<Cause> WrongInScale(const Target& target, const CalibrateOptions& options,
                                const CameraViews& views, int agreeing) {
  const auto scale = ScaleOfClouds(views.Used());
  if (!scale || !(std::abs(scale->value - 1) > kLeastOffScale)) return {};
  const CameraViews scaled = Scaled(views, scale->value);
  const auto used = scaled.Used();
  const FirstGuess guess = GuessFromBoards(used, options.first_guess);
  if (!guess.camera_from_lidar || guess.agreeing < 2 * agreeing) return {};
  const auto agree = static_cast<std::size_t>(guess.agreeing);
  if (2 * agree < used.size() || agree + 1 < kLeastViews) return {};
  return CausesOfScale(target, BoardInClouds(target, used, *guess.camera_from_lidar), *scale);
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
    const auto used = shifted.Usable();  // those held out, too: nothing is solved by it
    if (used.size() < kLeastViews) continue;
    const FirstGuess other = GuessFromBoards(used, options.first_guess);
    if (!other.camera_from_lidar || !MostAgree(other.agreeing, used.size())) continue;
    if (other.agreeing < 2 * agreeing || other.agreeing <= most) continue;
    most = other.agreeing;
    why.contradiction = PairsAreOff(views, apart, other.agreeing, used.size());
  }
  if (!why.contradiction.empty()) return why;
  why.causes = WrongInScale(target, options, views, agreeing);
  const auto lens = FindLensByImages(target, views);
  if (!lens) return why;
  if (const auto model = OtherModel(*lens, *views.spec))
    why.causes.insert(why.causes.begin(), *model);
  if (!lens->result.converged) return why;
  const CameraViews posed = PosedAgain(views, lens->result.lens, target);
  const FirstGuess other = GuessFromBoards(posed.Used(), options.first_guess);
  if (other.camera_from_lidar && other.agreeing > agreeing && other.agreeing >= options.min_views) {
    why.lens = lens->result.lens;
  }
  return why;
}

}  // namespace rgbdt
