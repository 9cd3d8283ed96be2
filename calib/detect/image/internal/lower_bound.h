#pragma once

namespace rgbdt {

/// What a value says of a model where only "at least `level`" is known of it, with normal noise of
/// 1 (Tobin's regression): with z = model - level, the negative log-likelihood -ln Phi(z), and how
/// it enters least squares' normal equations. z below zero by much: the same as a value at the
/// level; above zero by much: nothing. A pixel that is simply left out wherever it is clipped, or
/// taken for a value wherever the model is lower, is not unbiased: noise decides which are.
struct LowerBound {
  explicit LowerBound(double z);
  double residual;  ///< -d cost / d z
  double weight;    ///< d^2 cost / d z^2, 0 to 1
  double cost;      ///< -ln Phi(z)
};

}  // namespace rgbdt
