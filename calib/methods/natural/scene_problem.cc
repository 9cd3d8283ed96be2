#include "calib/methods/natural/scene_problem.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "calib/camera/camera.h"
#include "calib/camera/pixel_by_point.h"
#include "calib/camera/pixels.h"
#include "calib/methods/natural/reflectivity_edges.h"

namespace rgbdt {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// A rim as the camera sees it.
struct Projected {
  Vector2d pixel;
  Eigen::Matrix<double, 2, kSceneUnknowns> by_unknowns;  // [px of the image]
  Vector2d across;                                       // half of the beams' distance [px]
  Vector2d normal;                                       // unit, across the rim
  Vector2d by_shift;                                     // of a shift outwards [px/rad]
};

std::optional<Projected> Project(const Camera& camera, const SceneState& state,
                                 const SceneEdge& rim) {
  const Matrix3d turn = state.camera_from_lidar.rotation.toRotationMatrix();
  const auto kind = static_cast<std::size_t>(rim.kind);
  const bool depth = rim.kind != SceneEdgeKind::kReflectivity;
  const double out = state.shift_rad[kind] - rim.reach * state.beam_rad;
  const Vector3d aside = rim.across - rim.across.dot(rim.along) * rim.along;
  const double range = rim.point.norm();
  const Vector3d outwards = range * aside.normalized();
  const double farther = depth ? 1 + state.farther_m / range : 1;
  const Vector3d point =
      turn * (farther * (rim.point + out * outwards)) + state.camera_from_lidar.translation;
  const auto pixel = camera.Project(point);
  if (!pixel || !camera.Contains(*pixel)) return std::nullopt;
  Projected seen;
  seen.pixel = *pixel;
  const PixelDerivatives by_all = PixelByPointAndLens(camera.lens(), point);
  const Eigen::Matrix<double, 2, 3> by_point = by_all.leftCols<3>();
  seen.by_unknowns.setZero();
  seen.by_unknowns.leftCols<3>() = -by_point * CrossMatrix(point);
  seen.by_unknowns.middleCols<3>(3) = by_point;
  seen.by_shift = by_point * (turn * (farther * outwards));
  seen.by_unknowns.col(kShiftAt + static_cast<Eigen::Index>(kind)) = seen.by_shift;
  seen.by_unknowns.col(kBeamAt) = -rim.reach * seen.by_shift;
  if (depth) {
    seen.by_unknowns.col(kFartherAt) = by_point * (turn * (rim.point + out * outwards) / range);
  }
  seen.by_unknowns.rightCols<kLensNumbers>() = by_all.rightCols<kLensNumbers>();
  seen.across = by_point * (turn * (farther * rim.across));
  const Vector2d along = by_point * (turn * rim.along);
  const double length = along.norm();
  if (!(length > 0)) return std::nullopt;
  seen.normal = Vector2d(-along.y(), along.x()) / length;
  return seen;
}

std::vector<SceneEdge> Thinned(std::vector<SceneEdge> edges, std::size_t most) {
  if (edges.size() <= most) return edges;
  std::vector<SceneEdge> kept;
  for (std::size_t i = 0; i < most; ++i) kept.push_back(edges[i * edges.size() / most]);
  return kept;
}

// Behind those, as things of their own.
void Append(std::vector<SceneEdge> more, std::vector<SceneEdge>* edges) {
  int things = 0, rims = 0;
  for (const SceneEdge& edge : *edges) {
    things = std::max(things, edge.thing + 1);
    rims = std::max(rims, edge.rim + 1);
  }
  for (SceneEdge& edge : more) {
    edge.thing += things;
    edge.rim += rims;
    edges->push_back(edge);
  }
}

/// What some edges add that have a shift in common: the equations with it as a further unknown.
struct ShiftSums {
  SceneMatrix information = SceneMatrix::Zero();
  SceneVector gradient = SceneVector::Zero(), with_shift = SceneVector::Zero();
  double shift_information = 0, shift_gradient = 0;
  bool shown = false;  ///< the image may show some of them

  /// Adds a part of them, whose shift is this one's and one of its own (`variance`), which is
  /// eliminated (Schur).
  void Add(const ShiftSums& part, double variance) {
    if (!part.shown) return;
    const double prior = 1 / std::max(variance, 1e-18);
    const double all = part.shift_information + prior;
    if (!(all > 0)) return;
    const double kept = prior / all;
    information += part.information - part.with_shift * part.with_shift.transpose() / all;
    gradient += part.gradient - part.with_shift * (part.shift_gradient / all);
    with_shift += kept * part.with_shift;
    shift_information += kept * part.shift_information;
    shift_gradient += kept * part.shift_gradient;
    shown = true;
  }
};

/// The shifts eliminated: a rim's as it was met from one place about that which it has from
/// wherever, each rim's about its thing's, then each thing's.
void Eliminate(const std::vector<ShiftSums>& met, const std::vector<SceneRim>& known,
               const SceneLook& look, SceneSums* sums) {
  std::map<int, ShiftSums> rims, things;
  std::map<int, int> thing_of;
  for (std::size_t i = 0; i < met.size(); ++i) {
    if (!met[i].shown) continue;
    rims[known[i].rim].Add(met[i], std::pow(known[i].common_rad, 2));
    thing_of[known[i].rim] = known[i].thing;
  }
  for (const auto& [rim, own] : rims)
    things[thing_of[rim]].Add(own, std::pow(look.rim_sigma_rad, 2));
  const double prior = 1 / std::pow(look.thing_sigma_rad, 2);
  for (const auto& [number, thing] : things) {
    ShiftSums whole;
    whole.Add(thing, 1 / prior);
    if (!whole.shown) continue;
    sums->information += whole.information;
    sums->gradient += whole.gradient;
    sums->parts.emplace_back(whole.information, whole.gradient);
    sums->things += thing.shift_information / (thing.shift_information + prior);
  }
}

class Summing {
 public:
  Summing(const SceneLook& look, double pixels, const CameraSpec& spec)
      : look_(look), pixels_(pixels), columns_(spec.width), rows_(spec.height) {}

  void Add(const Projected& seen, std::size_t source, const std::vector<ImageRim>& met, int reach,
           ShiftSums* own, SceneSums* sums) const {
    const double usually_matched = look_.matched[source];
    // Densities over the line that was looked along [1/px of the level].
    const double nothing = (1 - usually_matched) / (2 * reach);
    double strengths = 0.5;
    for (const ImageRim& rim : met) strengths += rim.strength;
    double total = nothing;
    std::vector<Term>& terms = terms_;
    terms.clear();
    for (const ImageRim& rim : met) {
      Term term;
      term.residual = rim.offset * rim.normal.dot(seen.normal);
      const double spread = rim.normal.dot(seen.across) / pixels_;
      term.spread = spread * spread / 3;
      term.variance = look_.sigma_px * look_.sigma_px + term.spread;
      term.density = usually_matched * rim.strength / strengths *
                     std::exp(-0.5 * term.residual * term.residual / term.variance) /
                     std::sqrt(2 * M_PI * term.variance);
      term.normal = rim.normal;
      total += term.density;
      terms.push_back(term);
    }
    sums->shown[source].edges += 1;
    sums->log_likelihood += std::log(total / nothing * (1 - usually_matched));
    SceneVector mean = SceneVector::Zero();  // of the score: of what each of them would pull with
    double mean_by_shift = 0;
    double matched = 0;
    for (const Term& term : terms) {
      const double share = term.density / total;
      if (share < 1e-4) continue;
      const double weight = share / term.variance;
      const SceneVector by = (term.normal.transpose() * seen.by_unknowns).transpose() / pixels_;
      const double by_shift = term.normal.dot(seen.by_shift) / pixels_;
      // Which of them it is, if any, is not known: by so much less is told (Louis 1982).
      const double told =
          look_.observed ? weight * (1 - term.residual * term.residual / term.variance) : weight;
      own->information += told * by * by.transpose();
      own->with_shift += told * by_shift * by;
      own->shift_information += told * by_shift * by_shift;
      mean += weight * term.residual * by;
      mean_by_shift += weight * term.residual * by_shift;
      sums->squares += share * (term.residual * term.residual - term.spread);
      matched += share;
      own->shown = true;
    }
    sums->shown[source].matched += matched;
    sums->where[PartOf(seen.pixel)] += matched;
    own->gradient += mean;
    own->shift_gradient += mean_by_shift;
    if (!look_.observed) return;
    own->information += mean * mean.transpose();
    own->with_shift += mean_by_shift * mean;
    own->shift_information += mean_by_shift * mean_by_shift;
  }

 private:
  struct Term {
    double residual, spread, variance, density;
    Vector2d normal;
  };
  std::size_t PartOf(const Vector2d& pixel) const {
    const auto part = [](double at, int size, int parts) {
      return std::clamp(static_cast<int>((at + 0.5) / size * parts), 0, parts - 1);
    };
    return static_cast<std::size_t>(part(pixel.y(), rows_, kPartRows) * kPartColumns +
                                    part(pixel.x(), columns_, kPartColumns));
  }

  const SceneLook& look_;
  double pixels_;
  int columns_, rows_;
  mutable std::vector<Term> terms_;
};

}  // namespace

SceneState SceneState::Moved(const SceneVector& x) const {
  SceneState moved = *this;
  moved.camera_from_lidar = Exp(x.head<6>()) * camera_from_lidar;
  for (std::size_t k = 0; k < shift_rad.size(); ++k) {
    moved.shift_rad[k] += x[kShiftAt + static_cast<Eigen::Index>(k)];
  }
  moved.beam_rad += x[kBeamAt];
  moved.farther_m += x[kFartherAt];
  moved.lens = WithNumbers(lens, NumbersOf(lens) + x.tail<kLensNumbers>());
  return moved;
}

std::shared_ptr<const SceneShot> PrepareShot(const CameraSpec& camera, const Shot& shot,
                                             const SceneEdgeOptions& edges, int levels) {
  CheckImage(camera, *shot.image);
  auto ready = std::make_shared<SceneShot>();
  ready->place = shot.place;
  const RangeGrid grid(*shot.cloud);
  ready->edges = Thinned(FindDepthEdges(grid, edges.depth), edges.most_edges);
  if (edges.reflectivity && camera.kind != CameraKind::kThermal) {
    Append(Thinned(FindReflectivityEdges(grid), edges.most_edges), &ready->edges);
  }
  const cv::Mat grey = ToGrey(*shot.image);
  for (int level = 0; level < levels; ++level) {
    if (level > 0 && (std::min(camera.width, camera.height) >> level) < 16) break;
    ready->pictures.emplace_back(grey, level);
  }
  return ready;
}

namespace {

std::vector<std::shared_ptr<const SceneShot>> Prepared(const CameraSpec& camera,
                                                       const std::vector<Shot>& shots,
                                                       const SceneEdgeOptions& edges, int levels) {
  std::vector<std::shared_ptr<const SceneShot>> ready;
  ready.reserve(shots.size());
  for (const Shot& shot : shots) {
    ready.push_back(PrepareShot(camera, shot, edges, levels));
  }
  return ready;
}

}  // namespace

SceneProblem::SceneProblem(const CameraSpec& camera,
                           const std::vector<std::shared_ptr<const SceneShot>>& shots)
    : spec_(camera) {
  KnownRims known;
  for (const auto& shot : shots) {
    parts_.push_back({shot, known.Add(shot->edges, shot->place)});
    levels_ = static_cast<int>(shot->pictures.size());
  }
  rims_ = known.rims();
}

SceneProblem::SceneProblem(const CameraSpec& camera, const std::vector<Shot>& shots,
                           const SceneEdgeOptions& edges, int levels)
    : SceneProblem(camera, Prepared(camera, shots, edges, levels)) {}

std::size_t SceneProblem::edges() const {
  std::size_t sum = 0;
  for (const Part& part : parts_) sum += part.shot->edges.size();
  return sum;
}

SceneSums SceneProblem::SumsAt(const SceneState& state, const SceneLook& look) const {
  constexpr double kMostSpreadPx = 6;  // of the level: beams too far apart to tell anything
  CameraSpec spec = spec_;
  spec.lens = state.lens;
  const Camera camera(spec);
  SceneSums sums;
  std::vector<ShiftSums> rims(rims_.size());
  std::vector<ImageRim> met;
  for (const Part& part : parts_) {
    const ImageRims& picture = part.shot->pictures[static_cast<std::size_t>(look.level)];
    const Summing summing(look, picture.pixels(), spec);
    for (std::size_t i = 0; i < part.shot->edges.size(); i += look.stride) {
      const SceneEdge& edge = part.shot->edges[i];
      if (!look.reflectivity && edge.kind == SceneEdgeKind::kReflectivity) continue;
      const auto seen = Project(camera, state, edge);
      if (!seen) continue;
      const double spread = std::abs(seen->normal.dot(seen->across)) / picture.pixels();
      if (spread > kMostSpreadPx) continue;
      const int reach = look.reach_px + static_cast<int>(std::ceil(spread));
      picture.Meet(picture.ToLevel(seen->pixel), seen->normal, reach, &met);
      summing.Add(*seen, SourceOf(edge.kind), met, reach,
                  &rims[static_cast<std::size_t>(part.rims[i])], &sums);
    }
  }
  Eliminate(rims, rims_, look, &sums);
  return sums;
}

}  // namespace rgbdt
