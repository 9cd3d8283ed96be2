#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/model/rigid3.h"

namespace rgbdt {

/// What was known of some numbers before data came, and afterwards: both normal. Zero variances
/// beforehand: exact numbers, which say nothing.
struct BeforeAndAfter {
  Eigen::MatrixXd prior;       ///< covariance about 0
  Eigen::VectorXd mean;        ///< afterwards
  Eigen::MatrixXd covariance;  ///< afterwards
};

/// log of the data's density, had the numbers' covariance beforehand been `other`, over that with
/// the prior they were found with. The data's own likelihood is what afterwards and prior differ by
/// (a normal one); in directions of which more is stated to be unknown afterwards than before,
/// nothing is told.
double LogOdds(const BeforeAndAfter& found, const Eigen::MatrixXd& other);

/// The probability that a mount holds, of which `share` move: by the log-densities of the data had
/// it held, and had it moved by one of several sizes, each as likely.
double HoldsProbability(double holds, const std::vector<double>& moved, double share);

}  // namespace rgbdt
