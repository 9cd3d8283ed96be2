#pragma once

#include <string>

#include "calib/solve/internal/joint_solve.h"

namespace rgbdt {

/// The result with `edges_planes` in its cameras' reports, and lidars_edges_planes: the boards'
/// edges alone, in clouds and images, against their planes alone. Both have the corners or, of a
/// plain board, its sides in the images, by which alone these know it. What the two share counts
/// twice in the covariance of their difference. Nothing with fewer than 4 views.
[[nodiscard]] JointResult HoldEdgesAgainstPlanes(JointResult result);

/// By how much variances are enlarged where the two contradict each other; 1: they do not.
double FactorWhereTheyDiffer(const Halves& edges_planes);

/// That they were, in words.
std::string EnlargedWords(double chi2, double factor);

/// Edges and planes are two measurements of one pose: where they contradict each other, nobody
/// knows which is off. The result lies between them; its covariance is enlarged until they agree
/// (Birge 1932). After it was judged whether the views determine the pose at all.
[[nodiscard]] CameraReport EnlargedWhereTheyDiffer(CameraReport report);

}  // namespace rgbdt
