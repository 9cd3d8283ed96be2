#include "calib/methods/mutual_information/internal/barzilai_borwein.h"

#include <cmath>

namespace rgbdt {
namespace {

class Ascent {
 public:
  Ascent(const PoseObjective& objective, const Rigid3& start, const AscentOptions& options)
      : objective_(objective), start_(start), options_(options) {
    result_.pose = start;
    result_.value = objective(start);
  }

  AscentResult Run() {
    // The first step has no step before it: half the longest one.
    Vector6d gradient = Gradient();
    Step(Limited(gradient, 0.5 * options_.max_step / std::max(gradient.norm(), 1e-300)));
    for (int i = 1; i < options_.max_iterations && !Ended(); ++i) {
      const Vector6d next = Gradient();
      const double curvature = std::abs(step_.dot(next - gradient));
      const double length = curvature > 0 ? step_.squaredNorm() / curvature : 0;
      gradient = next;
      Step(Limited(gradient, length));
    }
    return result_;
  }

 private:
  double ValueAt(const Vector6d& place) const {
    return objective_(Moved(start_, place, options_.unit));
  }

  Vector6d Gradient() const {
    Vector6d gradient;
    for (int k = 0; k < 6; ++k) {
      const Vector6d ahead = options_.difference * Vector6d::Unit(k);
      gradient[k] = (ValueAt(place_ + ahead) - ValueAt(place_ - ahead)) / (2 * options_.difference);
    }
    return gradient;
  }

  Vector6d Limited(const Vector6d& gradient, double length) const {
    const Vector6d step = length * gradient;
    return step.norm() > options_.max_step ? (options_.max_step / step.norm() * step).eval() : step;
  }

  void Step(const Vector6d& step) {
    step_ = step;
    place_ += step;
    const double value = ValueAt(place_);
    result_.converged = step.norm() < options_.tolerance;
    result_.at_border = place_.cwiseAbs().maxCoeff() > options_.reach;
    if (!(value > result_.value)) return;
    result_.value = value;
    result_.pose = Moved(start_, place_, options_.unit);
  }

  bool Ended() const { return result_.converged || result_.at_border; }

  const PoseObjective& objective_;
  Rigid3 start_;
  AscentOptions options_;
  Vector6d place_ = Vector6d::Zero(), step_ = Vector6d::Zero();  // [units]
  AscentResult result_;
};

}  // namespace

AscentResult Ascend(const PoseObjective& objective, const Rigid3& start,
                    const AscentOptions& options) {
  return Ascent(objective, start, options).Run();
}

}  // namespace rgbdt
