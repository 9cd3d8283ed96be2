#include "tests/study/surface_minima.h"

#include <cmath>

namespace rgbdt::study {
namespace {

using Function = std::function<double(const Eigen::Vector2d&)>;

bool IsHollow(const Surface& surface, int i, int j) {
  for (int di = -1; di <= 1; ++di) {
    for (int dj = -1; dj <= 1; ++dj) {
      if ((di != 0 || dj != 0) && surface.At(i + di, j + dj) <= surface.At(i, j)) return false;
    }
  }
  return true;
}

// The lowest of so many places round about.
Eigen::Vector2d LowestAround(const Function& function, const Eigen::Vector2d& place, double step,
                             double turn, double* value) {
  constexpr int kDirections = 24;
  Eigen::Vector2d best = place;
  for (int k = 0; k < kDirections; ++k) {
    const double angle = turn + 2 * M_PI * k / kDirections;
    const Eigen::Vector2d there = place + step * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    const double here = function(there);
    if (here >= *value) continue;
    *value = here;
    best = there;
  }
  return best;
}

// Steps shrink where no direction leads down and grow where one does; directions are new ones each
// time, so that a valley is entered along its bottom sooner or later.
void Descend(const Function& function, double width, Hollow* hollow) {
  constexpr double kGoldenAngle = 2.399963229728653;
  constexpr int kMostRounds = 1500;
  double step = width;
  for (int round = 0; round < kMostRounds && step > 1e-3 * width; ++round) {
    const Eigen::Vector2d before = hollow->end;
    hollow->end = LowestAround(function, before, step, kGoldenAngle * round, &hollow->value);
    step *= hollow->end == before ? 0.5 : 1.4;
    step = std::min(step, width);
    if (hollow->end.cwiseAbs().maxCoeff() > 1) return;  // no minimum of this part of the surface
  }
}

}  // namespace

std::vector<Hollow> FindHollows(const Surface& surface, const Function& function) {
  std::vector<Hollow> hollows;
  for (int i = 1; i + 1 < surface.side(); ++i) {
    for (int j = 1; j + 1 < surface.side(); ++j) {
      if (!IsHollow(surface, i, j)) continue;
      hollows.push_back({i, j, surface.Place(i, j), surface.At(i, j)});
      Descend(function, 1.0 / surface.steps, &hollows.back());
    }
  }
  return hollows;
}

}  // namespace rgbdt::study
