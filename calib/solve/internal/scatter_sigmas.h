#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/statistics.h"
#include "calib/solve/board_problem.h"

namespace rgbdt {

/// How far sides differ among themselves, by the data: never less than the physics says. The shifts
/// as found, over how many of them the data tell (MacKay 1992).
double SideSigma(const BoardProblem& problem, const BoardSolution& solution);

/// The range offset as the views have it, as if nothing had been known of it: one step from the
/// solution. Of a further LIDAR, or of the reference.
Estimate FreeRangeOffset(const BoardProblem& problem, const BoardSolution& solution,
                         std::optional<std::size_t> lidar = std::nullopt);

/// That the views refute what was known of it [m, 1 sigma], in words.
std::string RangesAreOff(const Estimate& offset, double known_m);

/// How far the board's sides in the images lie from where the rest puts them, beyond what their own
/// fits say: boards are not quite straight, and show their rims. Robust, as what contradicts the
/// rest is still among them; nothing where chance may make as much.
double ImageSideSigma(const BoardProblem& problem, const BoardState& state);

/// A side of a board in one cloud whose own shift is too unlikely to be chance.
struct UnlikelySide {
  std::size_t view = 0, side = 0;
  double shift_rad = 0;
};
/// The least likely, of the views' shifts; nothing where none is beyond 4 of their sigmas.
std::optional<UnlikelySide> LeastLikelySide(const BoardProblem& problem,
                                            const std::vector<std::array<double, 4>>& side_shift);

/// That it was left out, in words.
std::string SideIsOut(const std::string& view, const UnlikelySide& side);

}  // namespace rgbdt
