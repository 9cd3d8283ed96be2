#include "calib/detect/image/internal/pick_alignment.h"

#include <algorithm>
#include <cmath>

#include "calib/detect/image/internal/board_map.h"
#include "calib/detect/image/internal/grey_image.h"

namespace rgbdt {
namespace {

using Outline = std::array<Eigen::Vector2d, 4>;

constexpr double kPickSigmaPx = 4;  // a pick farther off than that is unlikely
constexpr double kFarthestPx = 8;   // all picks together
constexpr double kFarthest = 0.75;  // of the distance between corners: beyond, it is the next one
constexpr int kRounds = 30;

// Correlation of the pixels round a corner with an ideal one, -1 to 1; 0 where it is not seen.
double LikenessAt(const cv::Mat& grey, const GridPlace& grid) {
  constexpr std::array<double, 6> kOffsets{-0.38, -0.25, -0.12, 0.12, 0.25, 0.38};
  double sum = 0;
  double squares = 0;
  double product = 0;
  for (const double a : kOffsets) {
    for (const double b : kOffsets) {
      const Eigen::Vector2d p = grid.place + grid.steps * Eigen::Vector2d(a, b);
      const double value = Interpolate(grey, p.x(), p.y());
      sum += value;
      squares += value * value;
      product += a * b > 0 ? value : -value;
    }
  }
  constexpr double kCount = kOffsets.size() * kOffsets.size();
  const double variance = squares / kCount - std::pow(sum / kCount, 2);
  return variance > 1e-12 * squares ? product / kCount / std::sqrt(variance) : 0;
}

class Alignment {
 public:
  Alignment(const cv::Mat& grey, const Camera& camera, const Target& target, const Outline& picks)
      : grey_(grey), camera_(camera), target_(target), picks_(picks), outline_(picks) {}

  void Run();
  const Outline& outline() const { return outline_; }
  double score() const { return score_; }
  double Likeness(const Outline& outline) const;

 private:
  double Score(const Outline& outline) const;
  bool Try(const Outline& outline);
  void Shift(double spacing);
  void Climb(double step);
  double Spacing() const;

  const cv::Mat& grey_;
  const Camera& camera_;
  const Target& target_;
  const Outline picks_;
  Outline outline_;
  double score_ = 0;
};

// Summed over the corners.
double Alignment::Likeness(const Outline& outline) const {
  const auto map = MapByOutline(camera_, target_, outline);
  if (!map) return 0;
  double sum = 0;
  int index = 0;
  for (const Eigen::Vector3d& corner : target_.InnerCorners()) {
    const bool even = (index % target_.corners_x() + index / target_.corners_x()) % 2 == 0;
    ++index;
    const auto grid = GridAt(*map, corner.head<2>(), target_.square_m);
    if (!grid) return 0;
    sum += (even ? 1 : -1) * LikenessAt(grey_, *grid);
  }
  return std::abs(sum);
}

double Alignment::Score(const Outline& outline) const {
  double moved = 0;
  for (std::size_t i = 0; i < 4; ++i) moved += (outline[i] - picks_[i]).squaredNorm();
  return Likeness(outline) - 0.5 * moved / (kPickSigmaPx * kPickSigmaPx);
}

bool Alignment::Try(const Outline& outline) {
  const double score = Score(outline);
  if (!(score > score_)) return false;
  score_ = score;
  outline_ = outline;
  return true;
}

// All picks alike.
void Alignment::Shift(double spacing) {
  const double reach = std::min(kFarthestPx, kFarthest * spacing);
  const double step = 0.15 * spacing;
  const int steps = static_cast<int>(reach / step);
  for (int y = -steps; y <= steps; ++y) {
    for (int x = -steps; x <= steps; ++x) {
      Outline moved = picks_;
      for (Eigen::Vector2d& p : moved) p += step * Eigen::Vector2d(x, y);
      Try(moved);
    }
  }
}

// One pick, two neighbours or all of them, a step in one of eight directions, while that helps.
void Alignment::Climb(double step) {
  constexpr std::array<unsigned, 9> kGroups{1, 2, 4, 8, 3, 6, 12, 9, 15};
  for (int round = 0; round < kRounds; ++round) {
    bool better = false;
    for (const unsigned group : kGroups) {
      for (int direction = 0; direction < 8; ++direction) {
        const double angle = 0.25 * 3.14159265358979323846 * direction;
        Outline moved = outline_;
        for (std::size_t i = 0; i < 4; ++i) {
          if ((group >> i & 1U) != 0) {
            moved[i] += step * Eigen::Vector2d(std::cos(angle), std::sin(angle));
          }
        }
        better = Try(moved) || better;
      }
    }
    if (!better) return;
  }
}

double Alignment::Spacing() const {
  const auto map = MapByOutline(camera_, target_, picks_);
  if (!map) return 0;
  const auto grid = GridAt(*map, target_.pattern_offset_m, target_.square_m);
  return grid ? grid->spacing() : 0;
}

void Alignment::Run() {
  const double spacing = Spacing();
  if (!(spacing > 3)) return;  // as FitCorner
  score_ = Score(outline_);
  Shift(spacing);
  for (const double step : {0.2, 0.1, 0.05, 0.02}) Climb(step * spacing);
}

// To the right of which the board goes on: clockwise as one sees it.
Outline Clockwise(Outline picks) {
  double area = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d& a = picks[i];
    const Eigen::Vector2d& b = picks[(i + 1) % 4];
    area += a.x() * b.y() - a.y() * b.x();
  }
  if (area < 0) std::reverse(picks.begin(), picks.end());
  return picks;
}

}  // namespace

std::optional<AlignedPicks> AlignPicks(const cv::Mat& grey, const Camera& camera,
                                       const Target& target, const Outline& picks) {
  Outline turned = Clockwise(picks);
  // A half turn that puts the pattern where it was cannot be told here.
  const int starts = target.pattern_offset_m.isZero() ? 2 : 4;
  std::optional<AlignedPicks> best;
  double best_score = 0;
  for (int start = 0; start < starts; ++start) {
    Alignment alignment(grey, camera, target, turned);
    alignment.Run();
    if (alignment.score() > best_score) {
      best_score = alignment.score();
      const double corners = target.corners_x() * target.corners_y();
      best = AlignedPicks{turned, alignment.outline(),
                          alignment.Likeness(alignment.outline()) / corners};
    }
    std::rotate(turned.begin(), turned.begin() + 1, turned.end());
  }
  return best;
}

}  // namespace rgbdt
