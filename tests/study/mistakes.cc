#include "tests/study/mistakes.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "calib/present/report/verdict.h"

namespace rgbdt::study {
namespace {

constexpr char kPairing[] = "pairs of images and clouds";
constexpr char kContradicts[] = "a view contradicts the others";
constexpr char kSizeInCloud[] = "board's size in the cloud";

double At(const Mistake& mistake, const std::array<double, 3>& sizes) {
  return sizes.at(static_cast<std::size_t>(mistake.size - 1));
}

// The true lens is nearly a pinhole's: taken for equidistant it bends all but the middle.
Lens AsOtherModel(Lens lens, double share) {
  lens.model = lens.model == Lens::Model::kPinhole ? Lens::Model::kFisheye : Lens::Model::kPinhole;
  // The image's edge, where it matters, is nearer the smaller the focal length seems.
  lens.fx *= 1 + share;
  lens.fy *= 1 + share;
  lens.distortion = {};
  return lens;
}

void SpoilLens(const Mistake& mistake, const CameraSpec& camera, Lens* lens) {
  const std::string& name = mistake.name;
  const double by = name == "focal" || name == "fx" ? At(mistake, {0.015, 0.03, 0.10}) : 0;
  if (name == "focal") {
    lens->fx *= 1 + by;
    lens->fy *= 1 + by;
  } else if (name == "fx") {
    lens->fx *= 1 + by;
  } else if (name == "centre") {
    lens->cx += At(mistake, {0.0125, 0.025, 0.05}) * camera.width;
    lens->cy -= At(mistake, {0.0125, 0.025, 0.05}) * camera.height;
  } else if (name == "distortion") {
    for (double& k : lens->distortion) k *= 1 - At(mistake, {0.5, 1, 2});
  } else if (name == "exchanged") {
    if (mistake.size != 2) std::swap(lens->fx, lens->cx);
    if (mistake.size != 1) std::swap(lens->fy, lens->cy);
  } else if (name == "model") {
    *lens = AsOtherModel(*lens, At(mistake, {0, 0.02, 0.05}));
  }
}

void SpoilTarget(const Mistake& mistake, Target* target) {
  if (mistake.name == "squares") {
    target->square_m *= 1 + At(mistake, {0.01, 0.025, 0.0526});
  } else if (mistake.name == "board") {
    // Towards the pattern's own size, as if there were no border.
    const double share = At(mistake, {0.25, 0.5, 1});
    const auto shrink = [&](double size, double pattern) {
      return size - share * std::max(0.0, size - pattern);
    };
    target->width_m = shrink(target->width_m, target->squares_x * target->square_m);
    target->height_m = shrink(target->height_m, target->squares_y * target->square_m);
  } else if (mistake.name == "size") {
    target->width_m += At(mistake, {0.02, 0.05, 0.1});
  } else if (mistake.name == "place") {
    target->pattern_offset_m.x() += At(mistake, {0.005, 0.01, 0.02});
  }
}

const std::map<std::string, std::set<std::string>>& NamesOfMistakes() {
  static const std::map<std::string, std::set<std::string>> kNames = {
      {"focal", {"focal length", "lens"}},
      {"fx", {"fx against fy", "focal length", "lens"}},
      {"centre", {"image centre", "lens"}},
      {"distortion", {"distortion", "lens"}},
      {"model", {"lens model", "distortion", "lens"}},
      {"exchanged", {"fx and cx", "fy and cy", "lens"}},
      {"squares", {"squares", "cloud's scale"}},
      {"scale", {"cloud's scale", "squares", kSizeInCloud}},
      {"board", {"board's size", kSizeInCloud}},
      {"size", {"board's size", kSizeInCloud}},
      {"place", {"pattern's place"}},
      {"pairs", {kPairing}},
      {"bumped", {"mount"}},
      {"moved", {kContradicts}}};
  return kNames;
}

// The beams, too, where the cloud has them.
void Move(const Eigen::Quaternionf& rotation, const Eigen::Vector3f& by, Cloud* cloud) {
  for (Eigen::Vector3f& point : cloud->points) point = rotation * point + by;
  for (Eigen::Vector3f& direction : cloud->directions) direction = rotation * direction;
}

// More than half of a camera's views, with these words in the reason.
bool MostAreRejected(const CameraReport& camera, const std::string& words) {
  const auto rejected = std::count_if(
      camera.rejected.begin(), camera.rejected.end(),
      [&](const RejectedView& view) { return view.why.find(words) != std::string::npos; });
  const std::size_t views = camera.used.size() + camera.heldout.size() + camera.rejected.size();
  return 2 * static_cast<std::size_t>(rejected) > views;
}

bool Says(const Verdict& verdict, const std::string& words) {
  return std::any_of(
      verdict.reasons.begin(), verdict.reasons.end(),
      [&](const std::string& reason) { return reason.find(words) != std::string::npos; });
}

}  // namespace

std::vector<Mistake> AllMistakes(const Target& target) {
  static const std::set<std::string> kOfPatterns = {"squares", "board", "place"};
  std::vector<Mistake> all = {{"none", 0}};
  for (const auto& [name, causes] : NamesOfMistakes()) {
    if (!target.HasPattern() && kOfPatterns.count(name) > 0) continue;
    for (int size = 1; size <= 3; ++size) all.push_back({name, size});
  }
  return all;
}

Rig WithMistake(const Mistake& mistake, Rig rig) {
  if (mistake.name == "none") return rig;
  for (CameraSpec& camera : rig.cameras) SpoilLens(mistake, camera, &camera.lens);
  SpoilTarget(mistake, &rig.target);
  return rig;
}

Cloud WithMistake(const Mistake& mistake, Cloud cloud, std::size_t view, std::size_t views) {
  if (mistake.name == "scale") {
    const auto by = static_cast<float>(At(mistake, {1.01, 1.03, 1.1}));
    for (Eigen::Vector3f& point : cloud.points) point *= by;
  } else if (mistake.name == "bumped" && 3 * view >= 2 * views) {
    const auto angle = static_cast<float>(At(mistake, {0.2, 0.5, 1.0}) * M_PI / 180);
    Move(Eigen::Quaternionf(Eigen::AngleAxisf(angle, Eigen::Vector3f(1, 2, 2) / 3)), {0, 0, 0},
         &cloud);
  } else if (mistake.name == "moved" && view == 1) {
    Move(Eigen::Quaternionf::Identity(),
         {0, static_cast<float>(At(mistake, {0.015, 0.03, 0.1})), 0}, &cloud);
  }
  return cloud;
}

bool IsOfTheCloud(const Mistake& mistake) {
  static const std::set<std::string> kNames = {"board", "size", "scale", "bumped", "moved"};
  return kNames.count(mistake.name) > 0;
}

int ViewsApart(const Mistake& mistake) { return mistake.name == "pairs" ? mistake.size : 0; }

std::vector<ViewDetection> PairedApart(std::vector<ViewDetection> views, int apart) {
  if (apart == 0) return views;
  const auto left = views.size() - static_cast<std::size_t>(apart);
  for (std::size_t i = 0; i < left; ++i) {
    views[i].cloud = views[i + static_cast<std::size_t>(apart)].cloud;
  }
  views.resize(left);
  return views;
}

bool Names(const Mistake& mistake, const std::string& cause) {
  const auto found = NamesOfMistakes().find(mistake.name);
  return found != NamesOfMistakes().end() && found->second.count(cause) > 0;
}

std::vector<std::string> CausesRead(const CameraReport& camera) {
  constexpr std::size_t kRead = 2;
  constexpr std::pair<const char*, const char*> kRejected[] = {
      {"no board of the target's size in the cloud", kSizeInCloud},
      {"measure it (width_m, height_m)", "board's size"},
      {"check the lens in the rig", "lens"}};
  if (camera.contradiction.rfind("Images and clouds are", 0) == 0) return {kPairing};
  const Verdict verdict = Judge(camera);
  std::vector<std::string> read;
  for (const auto& [words, cause] : kRejected) {
    if (MostAreRejected(camera, words) && Says(verdict, words)) read.emplace_back(cause);
  }
  for (const std::string& reason : verdict.reasons) {
    for (const Cause& cause : camera.causes) {
      const bool said = reason.find(cause.words) != std::string::npos;
      if (said && read.size() < kRead) read.push_back(cause.name);
    }
  }
  const bool contradicted =
      std::any_of(camera.rejected.begin(), camera.rejected.end(), [](const RejectedView& view) {
        return view.why.find("contradicts the other") != std::string::npos;
      });
  if (contradicted && read.size() < kRead) read.emplace_back(kContradicts);
  return read;
}

}  // namespace rgbdt::study
