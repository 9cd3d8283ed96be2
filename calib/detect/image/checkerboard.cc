#include "calib/detect/image/checkerboard.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <opencv2/imgproc.hpp>

#include "calib/detect/image/internal/corner_fit.h"
#include "calib/detect/image/internal/corner_grid.h"
#include "calib/detect/image/internal/edge_profiles.h"
#include "calib/detect/image/internal/grey_image.h"
#include "calib/detect/image/internal/grid_model.h"
#include "calib/detect/image/internal/marked_board.h"
#include "calib/detect/image/internal/partial_match.h"
#include "calib/detect/image/internal/pattern_match.h"
#include "calib/detect/image/internal/saddles.h"
#include "calib/model/statistics.h"
#include "calib/model/view_detection.h"

namespace rgbdt {
namespace {

constexpr double kLeastSide = 16;       // of an image that is searched [px]
constexpr int kMostGrids = 40;          // looked at for one size of the image
constexpr double kLeastGrown = 0.4;     // of the pattern's corners, for a grid to be looked at
constexpr double kGridTolerance = 0.2;  // of a saddle, of the distance to the next
constexpr int kMostMeasured = 4;        // places of the pattern in a grid
constexpr double kSure = 0.015;         // uncertainty of corners, of the distance to the next
constexpr double kMostResidual = 0.5;   // median of CornerFit::residual; noise at 4 x NETD
constexpr int kSaturatedRounds = 3;     // of measuring again
constexpr double kPartialBetter = 0.5;  // uncertainty of a partial board, of a whole one's instead
constexpr double kMostLost = 0.05;      // of the corners, that may be measured by their neighbours

// A size at which to look: the image shrunk by a whole number or enlarged, then blurred.
struct Look {
  double scale = 1;    ///< size of the image searched, of the image's
  double sigma = 1.5;  ///< [px] there
  int narrow = 0;      ///< light patches are made narrower by so many pixels first
};

// Cheap and likely ones first.
std::vector<Look> LooksFor(const cv::Size& size) {
  const double shrink = std::ceil(std::max(size.width, size.height) / 1000.0);
  std::vector<Look> looks{{1 / shrink, 1.5}, {0.5 / shrink, 1.5}, {1 / shrink, 2.5}};
  looks.push_back({shrink > 1 ? 2 / shrink : 2.0, 1.5});
  return looks;
}

// Where white is so overexposed that it flows together between the tips of black squares, which
// then are no saddles: for images in which anything is saturated.
std::vector<Look> SaturatedLooksFor(const cv::Mat& grey, double saturated_from) {
  constexpr double kLeastSaturated = 1e-3;  // of the pixels
  if (!std::isfinite(saturated_from)) return {};
  const int saturated = cv::countNonZero(grey >= saturated_from);
  if (saturated < kLeastSaturated * static_cast<double>(grey.total())) return {};
  const double scale = LooksFor(grey.size()).front().scale;
  return {{scale, 2.5, 2}, {scale, 2.5, 1}};
}

cv::Mat Resized(const cv::Mat& grey, double scale) {
  if (scale == 1) return grey;
  cv::Mat out;
  cv::resize(grey, out, {}, scale, scale, scale < 1 ? cv::INTER_AREA : cv::INTER_CUBIC);
  return out;
}

// Pixel centres lie at integers: (x + 0.5) scales, not x.
Eigen::Vector2d Scaled(const Eigen::Vector2d& place, double scale) {
  return (place.array() + 0.5) * scale - 0.5;
}

std::string Size(const Target& target) {
  return std::to_string(target.corners_x()) + "x" + std::to_string(target.corners_y());
}

struct Measured {
  CornerGrid corners;
  std::map<std::pair<int, int>, double> contrasts;  ///< as CornerFit's
  double sigma_px = 0, blur_px = 0, residual = 0;   ///< medians
  bool saturated = false;                           ///< any of them
};

// Every corner of the pattern that can be measured in the full image.
Measured Measure(const cv::Mat& grey, double saturated_from, const GridModel& model,
                 std::optional<double> blur_px, const PatternMatch& match, const Target& target) {
  Measured measured;
  std::vector<double> sigmas;
  std::vector<double> blurs;
  std::vector<double> residuals;
  for (int row = match.row; row < match.row + match.rows(target); ++row) {
    for (int column = match.column; column < match.column + match.columns(target); ++column) {
      const auto fit = FitCorner(grey, model.At(column, row), model.Steps(column, row),
                                 model.Bends(column, row), blur_px, saturated_from);
      if (!fit) continue;
      measured.corners[{column, row}] = fit->place;
      measured.contrasts[{column, row}] = fit->contrast;
      measured.saturated |= fit->saturated;
      sigmas.push_back(fit->sigma_px);
      blurs.push_back(fit->blur_px);
      residuals.push_back(fit->residual);
    }
  }
  if (!sigmas.empty()) {
    measured.sigma_px = Median(sigmas);
    measured.blur_px = Median(blurs);
    measured.residual = Median(residuals);
  }
  return measured;
}

// Half of light minus dark where column + row is even, by the median.
double TypicalContrast(const Measured& measured) {
  std::vector<double> contrasts;
  for (const auto& [at, contrast] : measured.contrasts) {
    contrasts.push_back((at.first + at.second) % 2 == 0 ? contrast : -contrast);
  }
  return Median(contrasts);
}

// Takes out corners whose light and dark are exchanged or far too weak, or which lie off the grid.
void DropWrong(double contrast, const GridModel& model, Measured* measured) {
  for (auto corner = measured->corners.begin(); corner != measured->corners.end();) {
    const auto [column, row] = corner->first;
    const double own = measured->contrasts.at(corner->first) * ((column + row) % 2 == 0 ? 1 : -1);
    // What noise may do, and a little for what the model does not follow.
    const double spacing = model.Spacing(column, row);
    const double tolerance = (0.15 + 4.5 * measured->sigma_px) / spacing + 0.005;
    const bool good = own / contrast > 0.15 && model.Agrees(*corner, std::min(0.15, tolerance));
    corner = good ? std::next(corner) : measured->corners.erase(corner);
  }
}

// In the target's order: columns to the right of which rows go down. Corners that were not measured
// follow from the others, or, of a board that is partly outside the image, are unseen.
Checkerboard InOrder(const Measured& measured, const GridModel& model, double contrast,
                     const PatternMatch& match, const Target& target, bool partial) {
  const int wide = target.corners_x();
  const int high = target.corners_y();
  const Eigen::Matrix2d steps = model.Steps(match.column + 0.5 * (match.columns(target) - 1),
                                            match.row + 0.5 * (match.rows(target) - 1));
  const Eigen::Vector2d along = steps.col(match.turned ? 1 : 0);
  const bool mirrored = (steps.determinant() < 0) != match.turned;
  // Of the two orders half a turn apart, the one whose rows point to the right.
  const bool flip_x = along.x() < 0;
  const bool flip_y = flip_x != mirrored;
  Checkerboard board;
  for (int y = 0; y < high; ++y) {
    for (int x = 0; x < wide; ++x) {
      const int across = flip_x ? wide - 1 - x : x;
      const int down = flip_y ? high - 1 - y : y;
      const int column = match.column + (match.turned ? down : across);
      const int row = match.row + (match.turned ? across : down);
      const auto found = measured.corners.find({column, row});
      board.corners.push_back(found != measured.corners.end() ? found->second
                              : partial                       ? UnseenCorner()
                                                              : model.At(column, row));
      if (x > 0 || y > 0) continue;
      // A corner's contrast tells of the squares in the directions (+, +) and (-, -); a flip of one
      // axis looks at the two others.
      const double here = (column + row) % 2 == 0 ? contrast : -contrast;
      board.top_left_dark = flip_x == flip_y ? here < 0 : here > 0;
    }
  }
  board.sigma_px = measured.sigma_px;
  return board;
}

double SpacingOf(const GridModel& model, const PatternMatch& match, const Target& target) {
  return model.Spacing(match.column + 0.5 * (match.columns(target) - 1),
                       match.row + 0.5 * (match.rows(target) - 1));
}

class Search {
 public:
  Search(const cv::Mat& grey, const Target& target, double saturated_from)
      : grey_(grey), target_(target), saturated_from_(saturated_from), noise_(NoiseOf(grey)) {}

  /// Looks for boards at one size; keeps the best of what was found so far.
  void LookAt(const Look& look);
  /// Takes a board that is partly outside the image, where one of the grids seen certainly is one:
  /// instead of none, or of a whole one that is far worse.
  void TakePartial();
  const std::optional<Checkerboard>& best() const { return best_; }
  /// Whether there is no need to look at another size.
  bool sure() const { return best_ && best_uncertainty_ < kSure; }
  const std::string& why() const { return why_; }

 private:
  void Verify(const cv::Mat& picture, const CornerGrid& grid, double scale);
  bool MeasureBoard(const CornerGrid& rough, const PatternMatch& match, bool partial);
  bool Fits(const cv::Mat& picture, const GridModel& model, const PatternMatch& match);
  bool FitsPartly(const GridModel& model, const PatternMatch& match);
  bool IsFlat(const Measured& measured, const GridModel& model, double contrast,
              const PatternMatch& match) const;

  /// A grid that is no board wholly in the image, in one picture of it.
  struct Rest {
    cv::Mat picture;
    CornerGrid grid;
    double scale;
  };

  const cv::Mat& grey_;
  const Target& target_;
  double saturated_from_;
  double noise_;
  std::optional<Checkerboard> best_;
  double best_uncertainty_ = 0;  ///< of a corner, of the distance to the next
  std::string why_;
  std::vector<Rest> rests_;
};

void Search::LookAt(const Look& look) {
  if (look.scale * std::min(grey_.cols, grey_.rows) < kLeastSide) return;
  const cv::Mat picture = Resized(grey_, look.scale);
  cv::Mat narrowed = picture;
  if (look.narrow > 0) cv::erode(picture, narrowed, cv::Mat(), {-1, -1}, look.narrow);
  const std::vector<Saddle> saddles = FindSaddles(narrowed, look.sigma);
  const int corners = target_.corners_x() * target_.corners_y();
  // A grid may run on where the pattern meets its border.
  GridFinder finder(saddles, std::max(target_.corners_x(), target_.corners_y()) + 4);
  const auto least = static_cast<std::size_t>(std::max(8.0, kLeastGrown * corners));
  for (int i = 0; i < kMostGrids; ++i) {
    const auto grid = finder.Next(least);
    if (!grid) break;
    Verify(picture, *grid, look.scale);
  }
}

void Search::Verify(const cv::Mat& picture, const CornerGrid& grid, double scale) {
  const auto rough = GridModel::Fit(grid, kGridTolerance);
  if (!rough) return;
  int tried = 0;
  for (const PatternMatch& match : PatternCandidates(picture, *rough, grid, target_)) {
    const CornerGrid inside = CornersIn(match, grid, target_);
    const auto model = GridModel::Fit(inside, kGridTolerance);
    if (!model || !Fits(picture, *model, match)) continue;
    CornerGrid full;
    for (const auto& [at, place] : inside) full[at] = Scaled(place, 1 / scale);
    if (MeasureBoard(full, match, false)) return;
    if (++tried == kMostMeasured) break;
  }
  rests_.push_back({picture, grid, scale});
}

void Search::TakePartial() {
  for (const Rest& rest : rests_) {
    const auto model = GridModel::Fit(rest.grid, kGridTolerance);
    if (!model) continue;
    std::string why;
    const auto matches = PartialCandidates(rest.picture, *model, rest.grid, target_, &why);
    if (matches.size() > 1) why = "which of its rows or columns those are cannot be told";
    if (matches.size() == 1) {
      CornerGrid full;
      for (const auto& [at, place] : CornersIn(matches[0], rest.grid, target_)) {
        full[at] = Scaled(place, 1 / rest.scale);
      }
      if (MeasureBoard(full, matches[0], true)) return;
    }
    if (!why.empty() && why_.empty()) {
      why_ = "of a checkerboard with " + Size(target_) +
             " inner corners a part is outside the image, and " + why;
    }
  }
}

bool Search::FitsPartly(const GridModel& model, const PatternMatch& match) {
  const auto why = WhyNotPartial(grey_, model, match, target_);
  return why && why->empty();
}

bool Search::Fits(const cv::Mat& picture, const GridModel& model, const PatternMatch& match) {
  const PatternFit fit = MatchPattern(picture, model, match, target_);
  if (fit == PatternFit::kGoesOn) {
    why_ = "a checkerboard with more than " + Size(target_) + " inner corners is in the image";
  }
  return fit == PatternFit::kYes;
}

// Whether the corners lie as exactly on a smooth grid as a flat board's would. Printed ones are
// within 0.3% of the distance of neighbours; wire meshes and tiles are not, and where they are so
// faint that this drowns in noise, it has to be no more than the image's own noise makes.
bool Search::IsFlat(const Measured& measured, const GridModel& model, double contrast,
                    const PatternMatch& match) const {
  constexpr double kPrinted = 0.01;                  // of the distance of neighbours
  constexpr double kFaint = 0.01, kTooFaint = 0.02;  // of it, what noise alone does to a corner
  constexpr double kMostOfNoise = 2.5;               // scatter, over what noise does
  constexpr double kMostOfFaint = 1.15;              // the same, of a faint one
  constexpr double kMostNoise = 1.3;                 // of the image, over what fits leave
  constexpr double kGridUnknowns = 22;               // GridModel's, about
  double squares = 0;
  for (const auto& corner : measured.corners) {
    squares += (corner.second - model.At(corner.first.first, corner.first.second)).squaredNorm();
  }
  const double spacing = SpacingOf(model, match, target_);
  const double freedom =
      std::max(1.0, 2 * static_cast<double>(measured.corners.size()) - kGridUnknowns);
  const double scatter = std::sqrt(squares / freedom) / spacing;
  // Were what the fits leave over the image's noise alone. It is not less: where noise seems to be
  // more, that is the texture of other things in the image.
  const double of_noise = std::min(kMostNoise, noise_ / (measured.residual * std::abs(contrast)));
  const double by_noise = of_noise * measured.sigma_px / spacing;
  if (by_noise > kTooFaint) return false;
  return by_noise > kFaint ? scatter < kMostOfFaint * by_noise
                           : scatter < std::hypot(kPrinted, kMostOfNoise * by_noise);
}

bool Search::MeasureBoard(const CornerGrid& rough, const PatternMatch& match, bool partial) {
  const auto model = GridModel::Fit(rough, kGridTolerance);
  if (!model) return false;
  Measured measured = Measure(grey_, saturated_from_, *model, {}, match, target_);
  auto fine = GridModel::Fit(measured.corners, kGridTolerance);
  // Again with the blur that all corners agree on, and edges along the grid's lines. With white
  // saturated, the first time is much the worse: an edge is seen by its dark half.
  const int rounds = measured.saturated ? kSaturatedRounds : 1;
  for (int round = 0; fine && round < rounds; ++round) {
    measured = Measure(grey_, saturated_from_, *fine, measured.blur_px, match, target_);
    fine = GridModel::Fit(measured.corners, kGridTolerance);
  }
  if (!fine) return false;
  const double contrast = TypicalContrast(measured);
  DropWrong(contrast, *fine, &measured);
  const double corners = partial ? CornersInside(grey_.size(), *fine, match, target_)
                                 : target_.corners_x() * target_.corners_y();
  if (static_cast<double>(measured.corners.size()) < (1 - kMostLost) * corners ||
      measured.residual > kMostResidual) {
    return false;
  }
  const auto last = GridModel::Fit(measured.corners, kGridTolerance);
  if (!last || !IsFlat(measured, *last, contrast, match)) return false;
  if (!(partial ? FitsPartly(*last, match) : Fits(grey_, *last, match))) return false;
  const double uncertainty = measured.sigma_px / SpacingOf(*last, match, target_);
  // What merely resembles a checkerboard, such as rows of holes, fits worse.
  if (!best_ || uncertainty < (partial ? kPartialBetter : 1) * best_uncertainty_) {
    best_ = InOrder(measured, *last, contrast, match, target_, partial);
    best_uncertainty_ = uncertainty;
  }
  return true;
}

}  // namespace

CheckerboardResult FindCheckerboard(const cv::Mat& grey, const Target& target,
                                    double saturated_from) {
  CheckerboardResult result;
  if (grey.empty()) {
    result.why = "the image is empty";
    return result;
  }
  if (target.markers) return FindMarkedBoard(grey, target, saturated_from);
  if (std::min(target.corners_x(), target.corners_y()) < 3) {
    result.why = "a checkerboard with " + Size(target) +
                 " inner corners cannot be told from others; at least 3x3 are needed";
    return result;
  }
  const cv::Mat repaired = RepairDeadPixels(grey);
  Search search(repaired, target, saturated_from);
  for (const Look& look : LooksFor(grey.size())) {
    search.LookAt(look);
    if (search.sure()) break;
  }
  if (!search.best()) {
    for (const Look& look : SaturatedLooksFor(repaired, saturated_from)) {
      search.LookAt(look);
      if (search.best()) break;
    }
  }
  if (!search.sure()) search.TakePartial();
  result.board = search.best();
  if (result.board) return result;
  result.why = WhyImageIsUseless(grey);
  if (result.why.empty()) result.why = search.why();
  if (result.why.empty()) {
    result.why = "no checkerboard with " + Size(target) +
                 " inner corners in the image; is the whole board in view, sharp, with contrast?";
  }
  return result;
}

}  // namespace rgbdt
