#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/solve/board_problem.h"

namespace rgbdt {

/// How far a view's own estimate of a camera, or of a further LIDAR, is from that of all others.
struct Contradiction {
  std::size_t view = 0, image = 0;     ///< BoardProblem::views, BoardView::images
  std::optional<std::size_t> lidar{};  ///< of this further LIDAR instead, whose cloud it is
  double chi2 = 0;                     ///< six degrees of freedom
  double rotation_deg = 0, centre_mm = 0;
};

/// Beyond so much a view contradicts the others: of six degrees of freedom 4 in 100,000 lie there.
inline constexpr double kContradictionChi2 = 30;

/// Whose pose it is about: a camera's index, or the number of cameras and a further LIDAR's index.
std::size_t SensorOf(const BoardProblem& problem, const Contradiction& contradiction);

/// Of every image whose camera other views have, too, and likewise of every further cloud, by the
/// normal equations at the solution: the view alone would step by information^-1 gradient, the
/// others without it the other way.
std::vector<Contradiction> Contradictions(const BoardProblem& problem,
                                          const BoardSolution& solution);

/// How likely it is that views differ by no more than they state: by all directions of each view's
/// own estimate, where the moves of the result (ViewScatterOf) know but the few that it hangs on.
/// How much more they differ is for the moves to say.
double AsStated(const std::vector<Contradiction>& contradictions, std::size_t views);

/// How the result moves when each view is left out in turn, against how it should: nuisances,
/// robust weights and all, whatever makes views differ. Of an efficient estimate with covariance C
/// the move has covariance C_without - C (Hausman 1978), so the sum of move' C^-1 move is that of
/// tr(C^-1 C_without - I): the quotient is the factor of variance. Of more than ten views a tenth
/// at a time: the time then grows with the views, not with their square. Nothing of fewer than
/// four.
/// Of the cameras, all views left out in turn.
std::optional<ViewScatter> ViewScatterOf(const BoardProblem& problem,
                                         const BoardSolution& solution);
/// Of a further LIDAR, the views left out in which it saw the board.
std::optional<ViewScatter> ViewScatterOf(const BoardProblem& problem, const BoardSolution& solution,
                                         std::size_t lidar);

}  // namespace rgbdt
