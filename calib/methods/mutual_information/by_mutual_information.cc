#include "calib/methods/mutual_information/by_mutual_information.h"

#include <algorithm>
#include <string>

#include "calib/methods/mutual_information/internal/barzilai_borwein.h"
#include "calib/methods/scene/seen_points.h"
#include "calib/model/errors.h"
#include "calib/model/statistics.h"

namespace rgbdt {
namespace {

bool HasReflectivity(const Shot& shot) {
  return shot.cloud->intensity.size() == shot.cloud->size();
}

// As of images: between what few values are below and above.
void Stretch(std::vector<std::vector<float>*> values) {
  std::vector<float> all;
  for (const auto* v : values) all.insert(all.end(), v->begin(), v->end());
  if (all.empty()) return;
  const float low = Nth(all, all.size() / 100);
  const float high = std::max(Nth(all, all.size() - 1 - all.size() / 100), low + 1e-6F);
  for (auto* v : values) {
    for (float& value : *v) value = std::clamp((value - low) / (high - low), 0.0F, 1.0F);
  }
}

using Measure = double (Entropies::*)() const;

PoseObjective ObjectiveOf(const ReflectivityAgainstGrey& values, Measure measure) {
  return [&values, measure](const Rigid3& pose) { return (values.EntropiesAt(pose).*measure)(); };
}

std::string WhyNotUsable(const std::vector<Shot>& shots) {
  if (shots.empty()) return "there is no view with a cloud and an image";
  for (const Shot& shot : shots) {
    if (HasReflectivity(shot)) continue;
    return "the cloud of view " + shot.view +
           " has no intensities, of which this method is made: record them, or use a method of "
           "edges";
  }
  return "";
}

// What is wrong with a pose, whatever search it came from; empty: nothing.
std::string WhyNotGood(const ReflectivityAgainstGrey& values, const PoseObjective& objective,
                       const Rigid3& pose, const MutualInformationOptions& options) {
  const auto seen = static_cast<std::size_t>(values.At(pose).count());
  const std::string few = WhyTooFew(seen, options.least_points, "points");
  if (!few.empty()) return few;
  return WhyNoPeak(ShareWorse(objective, pose, options.unit), options.least_worse, options.unit);
}

SceneFit FitOf(const Rigid3& pose, const std::string& why_not) {
  return {pose, std::nullopt, why_not.empty(), why_not};
}

// Coarse differences look over small bumps; fine ones then find the top.
AscentResult AscendTwice(const PoseObjective& objective, const Rigid3& start,
                         const MutualInformationOptions& options) {
  AscentOptions ascent;
  ascent.unit = options.unit;
  ascent.reach = options.reach;
  ascent.max_iterations = options.max_iterations;
  ascent.difference = 0.5;
  ascent.tolerance = 0.01;
  const AscentResult coarse = Ascend(objective, start, ascent);
  if (coarse.at_border) return coarse;
  ascent.difference = 0.1;
  ascent.tolerance = 1e-3;
  ascent.max_step = 0.1;
  return Ascend(objective, coarse.pose, ascent);
}

}  // namespace

void MutualInformationOptions::Check() const {
  if (bins < 2) {
    throw InputError("mutual information: bins is " + std::to_string(bins) +
                     "; expected 2 or more");
  }
  if (!(unit.rotation_rad > 0) || !(unit.translation_m > 0)) {
    throw InputError("mutual information: unit is " + std::to_string(unit.rotation_rad) +
                     " rad and " + std::to_string(unit.translation_m) + " m; expected more than 0");
  }
  if (max_iterations < 1) {
    throw InputError("mutual information: max_iterations is " + std::to_string(max_iterations) +
                     "; expected 1 or more");
  }
  swarm.Check();
}

ReflectivityAgainstGrey::ReflectivityAgainstGrey(const CameraSpec& camera,
                                                 const std::vector<Shot>& shots, const Rigid3& near,
                                                 const MutualInformationOptions& options)
    : camera_(camera), bins_(options.bins) {
  const std::vector<cv::Mat> grey = GreyValues(camera, shots);
  const std::size_t most = options.most_points / std::max<std::size_t>(1, shots.size());
  for (std::size_t s = 0; s < shots.size(); ++s) {
    const Cloud& cloud = *shots[s].cloud;
    Values values;
    values.grey = grey[s];
    for (const std::size_t i : PointsNearImage(camera_, near, cloud.points, most)) {
      values.points.push_back(cloud.points[i]);
      values.reflectivity.push_back(cloud.intensity[i]);
    }
    shots_.push_back(std::move(values));
  }
  std::vector<std::vector<float>*> all;
  for (Values& values : shots_) all.push_back(&values.reflectivity);
  Stretch(all);
}

JointHistogram ReflectivityAgainstGrey::At(const Rigid3& camera_from_lidar) const {
  JointHistogram histogram(bins_);
  for (const Values& shot : shots_) {
    ForEachSeen(camera_, camera_from_lidar, shot.points, [&](std::size_t i, float u, float v) {
      histogram.Add(shot.reflectivity[i], Interpolated(shot.grey, u, v));
    });
  }
  return histogram;
}

Entropies ReflectivityAgainstGrey::EntropiesAt(const Rigid3& camera_from_lidar) const {
  return EntropiesOf(At(camera_from_lidar).Density());
}

SceneFit AlignByMutualInformation(const CameraSpec& camera, const std::vector<Shot>& shots,
                                  const Rigid3& start, const MutualInformationOptions& options) {
  options.Check();
  const std::string unusable = WhyNotUsable(shots);
  if (!unusable.empty()) return FitOf(start, unusable);
  const ReflectivityAgainstGrey values(camera, shots, start, options);
  const PoseObjective objective = ObjectiveOf(values, &Entropies::MutualInformation);
  const AscentResult found = AscendTwice(objective, start, options);
  if (found.at_border) return FitOf(found.pose, WhyAtBorder(options.unit * options.reach));
  std::string why_not = WhyNotGood(values, objective, found.pose, options);
  if (why_not.empty() && !found.converged) {
    why_not = "the ascent did not come to rest; take more views, or start from a better guess";
  }
  return FitOf(found.pose, why_not);
}

SceneFit AlignByNormalisedMutualInformation(const CameraSpec& camera,
                                            const std::vector<Shot>& shots, const Rigid3& start,
                                            const MutualInformationOptions& options) {
  options.Check();
  const std::string unusable = WhyNotUsable(shots);
  if (!unusable.empty()) return FitOf(start, unusable);
  const ReflectivityAgainstGrey values(camera, shots, start, options);
  const PoseObjective objective = ObjectiveOf(values, &Entropies::Normalised);
  const SwarmResult found = MaximiseBySwarm(objective, start, options.swarm);
  std::string why_not = WhyNotGood(values, objective, found.pose, options);
  if (why_not.empty() && found.at_border) why_not = WhyAtBorder(options.swarm.reach);
  return FitOf(found.pose, why_not);
}

}  // namespace rgbdt
