#include "calib/methods/single_shot/plane_matching.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "calib/model/check.h"
#include "calib/model/linear_algebra.h"

namespace rgbdt {
namespace {

using Pieces = std::vector<FlatPiece>;
using Triple = std::array<std::size_t, 3>;

double AngleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// Volume that three normals span: 0 where they lie in a plane, and a shift along it is loose.
double Spread(const Pieces& boards, const Triple& t) {
  return std::abs(boards[t[0]].normal.dot(boards[t[1]].normal.cross(boards[t[2]].normal)));
}

std::vector<Triple> BoardTriples(const Pieces& boards, int most) {
  constexpr double kLeastSpread = 0.02;
  std::vector<Triple> triples;
  for (std::size_t i = 0; i < boards.size(); ++i) {
    for (std::size_t j = i + 1; j < boards.size(); ++j) {
      for (std::size_t k = j + 1; k < boards.size(); ++k) {
        if (Spread(boards, {i, j, k}) > kLeastSpread) triples.push_back({i, j, k});
      }
    }
  }
  std::stable_sort(triples.begin(), triples.end(), [&](const Triple& a, const Triple& b) {
    return Spread(boards, a) > Spread(boards, b);
  });
  if (triples.size() > static_cast<std::size_t>(most)) {
    triples.resize(static_cast<std::size_t>(most));
  }
  return triples;
}

// Whether two pieces could be two boards: as far apart, turned alike.
class Alike {
 public:
  Alike(const Pieces& boards, const Pieces& pieces, const PlaneMatchingOptions& options)
      : boards_(boards), pieces_(pieces), options_(options) {}

  bool operator()(std::size_t i, std::size_t j, std::size_t a, std::size_t b) const {
    if (a == b) return false;
    const double apart = (boards_[i].centre - boards_[j].centre).norm() -
                         (pieces_[a].centre - pieces_[b].centre).norm();
    if (std::abs(apart) > options_.centre_m) return false;
    const double turned = AngleBetween(boards_[i].normal, boards_[j].normal) -
                          AngleBetween(pieces_[a].normal, pieces_[b].normal);
    return std::abs(turned) < options_.normal_rad;
  }

 private:
  const Pieces& boards_;
  const Pieces& pieces_;
  const PlaneMatchingOptions& options_;
};

bool IsSame(const Rigid3& a, const Rigid3& b, const PlaneMatchingOptions& options) {
  return RotationDistance(a, b) < options.apart_rad && CentreDistance(a, b) < options.apart_m;
}

// The best poses so far, no two the same.
class Best {
 public:
  explicit Best(const PlaneMatchingOptions& options) : options_(options) {}

  void Offer(PlaneMatch match) {
    if (matches_.size() == options_.most_poses && match.score <= matches_.back().score) return;
    for (const PlaneMatch& kept : matches_) {
      if (kept.score >= match.score &&
          IsSame(kept.camera_from_lidar, match.camera_from_lidar, options_)) {
        return;
      }
    }
    matches_.erase(std::remove_if(matches_.begin(), matches_.end(),
                                  [&](const PlaneMatch& kept) {
                                    return IsSame(kept.camera_from_lidar, match.camera_from_lidar,
                                                  options_);
                                  }),
                   matches_.end());
    const auto place = std::find_if(matches_.begin(), matches_.end(), [&](const PlaneMatch& kept) {
      return kept.score < match.score;
    });
    matches_.insert(place, std::move(match));
    if (matches_.size() > options_.most_poses) matches_.pop_back();
  }
  std::vector<PlaneMatch> Take() { return std::move(matches_); }

 private:
  const PlaneMatchingOptions& options_;
  std::vector<PlaneMatch> matches_;
};

}  // namespace

void PlaneMatchingOptions::Check() const {
  const OptionCheck check("plane matching");
  check.AtLeast(most_triples, 1, "most_triples");
  check.Positive(centre_m, "centre_m");
  check.Positive(normal_rad, "normal_rad");
  check.AtLeast(static_cast<int>(most_poses), 1, "most_poses");
}

PlaneMatch MatchAt(const Rigid3& camera_from_lidar, const Pieces& boards, const Pieces& pieces,
                   const PlaneMatchingOptions& options) {
  PlaneMatch match{camera_from_lidar, 0, std::vector<int>(boards.size(), -1)};
  std::vector<double> nearest(boards.size(), 1);
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    const Eigen::Vector3d centre = camera_from_lidar * pieces[p].centre;
    const Eigen::Vector3d normal = camera_from_lidar.rotation * pieces[p].normal;
    for (std::size_t b = 0; b < boards.size(); ++b) {
      const double off = (centre - boards[b].centre).squaredNorm() / std::pow(options.centre_m, 2);
      if (off >= nearest[b]) continue;
      const double turned = AngleBetween(normal, boards[b].normal) / options.normal_rad;
      if (off + turned * turned >= nearest[b]) continue;
      nearest[b] = off + turned * turned;
      match.piece[b] = static_cast<int>(p);
    }
  }
  for (const double cost : nearest) match.score += 1 - cost;
  return match;
}

Rigid3 PoseOfTriple(const FlatPiece (&boards)[3], const FlatPiece (&pieces)[3]) {
  Eigen::Matrix3d turned = Eigen::Matrix3d::Zero();
  for (int i = 0; i < 3; ++i) turned += boards[i].normal * pieces[i].normal.transpose();
  // A rotation, not a reflection: three normals alone would leave that open where they are noisy.
  const Eigen::Matrix3d nearest = NearestOrthogonal(turned);
  if (!(nearest.determinant() > 0)) return {Eigen::Quaterniond::Identity(), {1e3, 1e3, 1e3}};
  Rigid3 pose{Eigen::Quaterniond(nearest).normalized(), {0, 0, 0}};
  Eigen::Matrix3d planes = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d& normal = boards[i].normal;
    planes += normal * normal.transpose();
    right += normal * normal.dot(boards[i].centre - pose.rotation * pieces[i].centre);
  }
  pose.translation = SolveSymmetric(planes, right);
  return pose;
}

std::vector<PlaneMatch> MatchPlanes(const Pieces& boards, const Pieces& pieces,
                                    const PlaneMatchingOptions& options) {
  options.Check();
  const Alike alike(boards, pieces, options);
  Best best(options);
  for (const Triple& t : BoardTriples(boards, options.most_triples)) {
    for (std::size_t a = 0; a < pieces.size(); ++a) {
      for (std::size_t b = 0; b < pieces.size(); ++b) {
        if (!alike(t[0], t[1], a, b)) continue;
        for (std::size_t c = 0; c < pieces.size(); ++c) {
          if (!alike(t[0], t[2], a, c) || !alike(t[1], t[2], b, c)) continue;
          const Rigid3 pose = PoseOfTriple({boards[t[0]], boards[t[1]], boards[t[2]]},
                                           {pieces[a], pieces[b], pieces[c]});
          best.Offer(MatchAt(pose, boards, pieces, options));
        }
      }
    }
  }
  return best.Take();
}

}  // namespace rgbdt
