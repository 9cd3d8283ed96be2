#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/solve/board_problem.h"

namespace rgbdt {

/// How large unknowns of one kind are, by the data: their common sigma, about zero.
struct Evidence {
  double sigma = 0;
  double gain = 0;  ///< by how much the logarithm of the likelihood is the higher for it, twice
};

/// Of unknowns about which the data say x' information x / 2 - x' gradient, everything else at its
/// best (MacKay 1992). The likelihood of sigma s, with l the information's eigenvalues and c the
/// gradient along their vectors, is
/// sum of s^2 c^2 / (1 + s^2 l) - log(1 + s^2 l), twice its logarithm.
/// Between `least` and `most`; where nothing is the likeliest, both are zero.
Evidence MostLikelySigma(const Eigen::MatrixXd& information, const Eigen::VectorXd& gradient,
                         double least, double most);

/// What is said of some unknowns, the others at their best; those that are neither are as they are.
ViewInformation Marginal(const ViewInformation& all, const std::vector<Eigen::Index>& kept,
                         const std::vector<Eigen::Index>& others);

/// The sigma of what values scatter beyond their own variances, `freedom` of them being free
/// (Paule and Mandel 1982); 0 where chance may make as much.
double ScatterBeyond(const std::vector<double>& values, const std::vector<double>& variances,
                     double freedom);

/// Whether a mean of `between_freedom` squares exceeds one of `within_freedom` by more than chance
/// does once in 10,000 cases, both having the same expectation (the F-test, by Paulson's normal
/// approximation, 1942).
bool Exceeds(double between, double between_freedom, double within, double within_freedom);

/// How likely it is that variances are as stated, where `freedom` squares, each over its variance,
/// have the mean `measured`. Before, one session in two is taken to be; in the others the factor's
/// logarithm is spread over 0 and more (half a normal of sigma 1).
double ShareAsStated(double measured, double freedom);

/// The factor of variance with which the 95% region of a pose holds 95%, likewise: neither the
/// likeliest factor nor the expected one does, as it is not known exactly. `as_stated`: how likely
/// that is by what else is known. 1 or more.
double FactorFor(double measured, double freedom, double as_stated);

}  // namespace rgbdt
