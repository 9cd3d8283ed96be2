#include "tests/unit/solve/ceres_boards.h"

#include <ceres/dynamic_autodiff_cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/rotation.h>
#include <ceres/solver.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "calib/camera/lens.h"
#include "calib/model/linear_algebra.h"

namespace rgbdt {
namespace {

// Plain arrays, not Eigen's, of automatic derivatives: they compile in half the time.
template <typename T>
using Point = std::array<T, 3>;
template <typename T>
using Pixel = std::array<T, 2>;

template <typename T>
Point<T> Constant(const Eigen::Vector3d& p) {
  return {T(p.x()), T(p.y()), T(p.z())};
}

template <typename T>
T Dot(const Point<T>& a, const Eigen::Vector3d& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <typename T>
Point<T> Placed(const Rigid3& pose, const Point<T>& p) {
  const Eigen::Matrix3d r = pose.rotation.toRotationMatrix();
  const Eigen::Vector3d& t = pose.translation;
  return {Dot<T>(p, r.row(0)) + t[0], Dot<T>(p, r.row(1)) + t[1], Dot<T>(p, r.row(2)) + t[2]};
}

// delta = (rx, ry, rz, tx, ty, tz) applied to a point: equal to Exp(delta) to first order, and the
// problem is set up again where the solution is, so that delta ends at zero.
template <typename T>
Point<T> Moved(const T* delta, const Point<T>& p) {
  Point<T> out;
  ceres::AngleAxisRotatePoint(delta, p.data(), out.data());
  return {out[0] + delta[3], out[1] + delta[4], out[2] + delta[5]};
}

Rigid3 MotionOf(const Vector6d& delta) {
  Rigid3 motion = Exp((Vector6d() << delta.head<3>(), Eigen::Vector3d::Zero()).finished());
  motion.translation = delta.tail<3>();
  return motion;
}

Eigen::Vector3d OutwardsOf(int side) {
  const Eigen::Vector3d outwards[] = {{0, -1, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}};
  return outwards[side];
}

// The solver's robust cost as a loss: s up to 9 * scale, beyond it 9 * scale * (1 + log(s / ...)).
class TailLoss : public ceres::LossFunction {
 public:
  explicit TailLoss(double scale) : limit_(9 * scale) {}
  void Evaluate(double s, double rho[3]) const override {
    const bool tail = s > limit_;
    rho[0] = tail ? limit_ * (1 + std::log(s / limit_)) : s;
    rho[1] = tail ? limit_ / s : 1;
    rho[2] = tail ? -limit_ / (s * s) : 0;
  }

 private:
  double limit_;
};

// A camera that sees the board, both about where they are now.
struct Seen {
  Lens lens;  // of it the model, k4, k5 and k6; the other numbers are unknowns
  Rigid3 camera_from_lidar, lidar_from_target;

  template <typename T>
  Pixel<T> operator()(const T* camera, const T* numbers, const T* board,
                      const Point<T>& on_target) const {
    const Point<T> in_lidar = Placed<T>(lidar_from_target, Moved<T>(board, on_target));
    const Point<T> p = Moved<T>(camera, Placed<T>(camera_from_lidar, in_lidar));
    std::array<T, 12> all;
    std::copy(numbers, numbers + kLensNumbers, all.begin());
    for (std::size_t i = 5; i < 8; ++i) all[4 + i] = T(lens.distortion[i]);
    Pixel<T> pixel;
    ProjectUnchecked(lens.model, all.data(), &all[2], &all[4], p[0], p[1], p[2], &pixel[0],
                     &pixel[1]);
    return pixel;
  }
};

// A point of the board where its shape has it: a bowl's and a saddle's height over the mean plane.
template <typename T>
Point<T> Bent(const Target& target, Point<T> p, const T* shared) {
  const T x = p[0] / target.width_m;
  const T y = p[1] / target.height_m;
  p[2] += shared[kBowX] * (4.0 * x * x - 1.0 / 3) + shared[kTwist] * 4.0 * x * y +
          shared[kBowY] * (4.0 * y * y - 1.0 / 3);
  return p;
}

struct CornerResidual {  // of camera, lens, board, shared
  Seen seen;
  Target target;
  Eigen::Vector3d corner;
  Eigen::Vector2d at;
  double sigma;

  template <typename T>
  bool operator()(T const* const* block, T* residual) const {
    Point<T> printed = Constant<T>(corner);
    for (int k = 0; k < 2; ++k) {
      printed[k] += (corner[k] - target.pattern_offset_m[k]) * block[3][kPrintWidth + k];
    }
    const Pixel<T> pixel = seen(block[0], block[1], block[2], Bent(target, printed, block[3]));
    residual[0] = (pixel[0] - at.x()) / sigma;
    residual[1] = (pixel[1] - at.y()) / sigma;
    return true;
  }
};

struct ImageSideResidual {  // of camera, lens, board, shared
  Seen seen;
  Target target;
  int side;
  Eigen::Vector3d from, to;         // the side's corners
  Eigen::Vector2d at[2], along[2];  // the fitted curve's ends and its directions there
  Eigen::Matrix2d whitening;

  template <typename T>
  bool operator()(T const* const* block, T* residual) const {
    const Eigen::Vector3d out = OutwardsOf(side);
    const T& shift = block[3][kOutlineTop + side];
    const auto pixel_at = [&](const T& t) {
      Point<T> p;
      for (int k = 0; k < 3; ++k) p[k] = from[k] + t * (to - from)[k] + shift * out[k];
      return seen(block[0], block[1], block[2], Bent(target, p, block[3]));
    };
    T off[2];
    for (int end = 0; end < 2; ++end) {
      const auto beyond = [&](const T& t) {  // the curve's end
        const Pixel<T> p = pixel_at(t);
        return (p[0] - at[end].x()) * along[end].x() + (p[1] - at[end].y()) * along[end].y();
      };
      // Newton's steps: derivatives of t are exact after one more step than its value.
      T t(0.5);
      for (int i = 0; i < 8; ++i) {
        t -= beyond(t) * 2e-4 / (beyond(t + T(1e-4)) - beyond(t - T(1e-4)));
      }
      const Pixel<T> p = pixel_at(t);
      off[end] = (p[1] - at[end].y()) * along[end].x() - (p[0] - at[end].x()) * along[end].y();
    }
    for (int k = 0; k < 2; ++k) residual[k] = whitening(k, 0) * off[0] + whitening(k, 1) * off[1];
    return true;
  }
};

struct CrossingDistance {  // of board, shared, the view's sides
  Target target;
  Rigid3 lidar_from_target;
  Crossing crossing;

  template <typename T>
  bool operator()(T const* const* block, T* residual) const {
    // The LIDAR and its beam in the target's axes.
    const Rigid3 target_from_lidar = lidar_from_target.Inverse();
    const T back[6] = {-block[0][0], -block[0][1], -block[0][2], T(0), T(0), T(0)};
    Point<T> lidar = Constant<T>(target_from_lidar.translation);
    for (int k = 0; k < 3; ++k) lidar[k] -= block[0][3 + k];
    lidar = Moved<T>(back, lidar);
    const Point<T> beam = Moved<T>(back, Constant<T>(target_from_lidar.rotation *
                                                     Eigen::Vector3d(crossing.point.normalized())));
    // Its start, below the LIDAR's origin.
    const double rise = crossing.point.z() / crossing.point.head<2>().norm();
    const T none[6] = {back[0], back[1], back[2], T(0), T(0), T(0)};
    const Point<T> up =
        Moved<T>(none, Constant<T>(target_from_lidar.rotation * Eigen::Vector3d::UnitZ()));
    for (int k = 0; k < 3; ++k) lidar[k] -= block[1][kBeamsMeet] * rise * up[k];
    const T range = -lidar[2] / beam[2];
    const Eigen::Vector3d out = OutwardsOf(crossing.side);
    const T lean = Dot<T>(beam, out);
    const T per_rad = range / sqrt(1.0 - lean * lean);
    const T rim = lean < 0.0 ? T(-lean / beam[2]) : T(0);
    const double half = (crossing.side % 2 == 1 ? target.width_m : target.height_m) / 2;
    const int kind = kNoReturnShift + static_cast<int>(crossing.kind) - 1;
    // The rim's height over the mean plane, at which the beam is so much farther in.
    const Point<T> met = {lidar[0] + range * beam[0], lidar[1] + range * beam[1], T(0)};
    const T inwards = Bent(target, met, block[1])[2] * lean / beam[2];
    residual[0] = (Dot<T>(lidar, out) + range * lean + inwards - half -
                   block[1][kOutlineTop + crossing.side] -
                   per_rad * (block[1][kind] + block[2][crossing.side]) -
                   1.0 / sqrt(1.0 - lean * lean) * block[1][kFringe] - rim * block[1][kThickness]) *
                  crossing.point.norm() / range / crossing.sigma_m;
    return true;
  }
};

// The groups of points that share an error, stacked; without any, all points are one group.
struct PlaneDistances {  // of board, shared, range terms
  struct Group {
    Eigen::Matrix4d root;  // root' root = scatter / sigma^2
    std::vector<std::pair<std::size_t, double>> terms;
  };
  Rigid3 lidar_from_target;
  Eigen::Vector3d centre, mean_beam;
  std::vector<Group> groups;
  Eigen::MatrixXd whitening;  // of what the groups share

  template <typename T>
  bool operator()(T const* const* block, T* residual) const {
    std::vector<T> stacked;
    for (const Group& group : groups) {
      T offset = block[1][kRangeOffset];
      for (const auto& [term, weight] : group.terms) offset += weight * block[2][term];
      const std::array<T, 4> x = At<T>(block[0], offset, block[1][kBeamsMeet]);
      for (int row = 0; row < 4; ++row) {
        T sum(0);
        for (int k = 0; k < 4; ++k) sum += group.root(row, k) * x[k];
        stacked.push_back(sum);
      }
    }
    for (std::size_t row = 0; row < stacked.size(); ++row) {
      residual[row] = T(0);
      for (std::size_t k = 0; k < stacked.size(); ++k) {
        residual[row] += whitening(static_cast<int>(row), static_cast<int>(k)) * stacked[k];
      }
    }
    return true;
  }

  // (n + ..., distance of the centre), as in board_model.h.
  template <typename T>
  std::array<T, 4> At(const T* board, const T& offset, const T& meet) const {
    const Point<T> origin = Placed<T>(lidar_from_target, Moved<T>(board, Point<T>{}));
    const Point<T> tip = Placed<T>(lidar_from_target, Moved<T>(board, Constant<T>({0, 0, 1})));
    const Eigen::Vector3d along = centre.normalized();
    const Point<T> n = {tip[0] - origin[0], tip[1] - origin[1], tip[2] - origin[2]};
    // A beam at q off the centre is along + (q - along (along . q)) / range; times n, less its part
    // along n. tan(elevation) there is rise + rise_by . q, taken down the LIDAR's z alike.
    const T facing = Dot<T>(n, along);
    const double flat = centre.head<2>().norm();
    const double rise = centre.z() / flat;
    const Eigen::Vector3d rise_by =
        (Eigen::Vector3d::UnitZ() - rise / flat * Eigen::Vector3d(centre.x(), centre.y(), 0)) /
        flat;
    const T rise_along = Dot<T>(n, rise_by);
    std::array<T, 4> x = {T(0), T(0), T(0), -meet * rise * n[2]};
    for (int k = 0; k < 3; ++k) {
      const T across = n[k] - facing * along[k];
      x[k] = n[k] + offset / centre.norm() * (across - (1.0 - facing * facing) * n[k]) -
             meet * n[2] * (rise_by[k] - rise_along * n[k]);
      x[3] += n[k] * (centre[k] + offset * mean_beam[k] - origin[k]);
    }
    return x;
  }
};

// Of points spread about a centre: the second derivative of p / |p|.
Eigen::Vector3d MeanBeam(const Eigen::Vector3d& centre, const Eigen::Matrix4d& scatter) {
  Eigen::Vector3d mean = centre.normalized();
  constexpr double kStep = 1e-3;
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) {
      const Eigen::Vector3d da = kStep * Eigen::Vector3d::Unit(a);
      const Eigen::Vector3d db = kStep * Eigen::Vector3d::Unit(b);
      const Eigen::Vector3d curved =
          (centre + da + db).normalized() - (centre + da - db).normalized() -
          (centre - da + db).normalized() + (centre - da - db).normalized();
      mean += 0.5 * scatter(a, b) / scatter(3, 3) * curved / (4 * kStep * kStep);
    }
  }
  return mean;
}

struct PriorResidual {  // of one block
  std::vector<double> mean, sigma;

  template <typename T>
  bool operator()(T const* const* block, T* residual) const {
    for (std::size_t k = 0; k < mean.size(); ++k) {
      residual[k] = (block[0][k] - mean[k]) / sigma[k];
    }
    return true;
  }
};

struct MeanTerms {  // of the rings' offsets and of the octaves'
  std::vector<double> shares;
  std::size_t rings;

  template <typename T>
  bool operator()(T const* const* block, T* residual) const {
    residual[0] = residual[1] = T(0);
    for (std::size_t i = 0; i < shares.size(); ++i) {
      residual[i < rings ? 0 : 1] += shares[i] / kMeanTermSigmaM * block[0][i];
    }
    return true;
  }
};

struct LensPriorResidual {
  LensNumbers given;
  LensCovariance root;  // root' root: its information

  template <typename T>
  bool operator()(T const* const* block, T* residual) const {
    for (int row = 0; row < kLensNumbers; ++row) {
      residual[row] = T(0);
      for (int k = 0; k < kLensNumbers; ++k)
        residual[row] += root(row, k) * (block[0][k] - given[k]);
    }
    return true;
  }
};

class CeresBoards {
 public:
  CeresBoards(const BoardProblem& problem, const BoardState& state)
      : problem_(problem),
        state_(state),
        cameras_(problem.cameras.size(), Vector6d::Zero()),
        boards_(problem.views.size(), Vector6d::Zero()) {
    for (Vector6d& delta : cameras_) AddBlock(delta.data(), 6);
    AddBlock(state_.shared.data(), kSharedUnknowns);
    const auto means = problem.priors.Means();
    PriorResidual prior{{means.begin(), means.end()}, {}};
    for (int k = 0; k < kSharedUnknowns; ++k) prior.sigma.push_back(problem.priors.Sigma(k));
    Add(prior, kSharedUnknowns, {state_.shared.data()});
    for (const Lens& lens : state_.lenses) lenses_.push_back(NumbersOf(lens));
    for (std::size_t c = 0; c < lenses_.size(); ++c) {
      if (!problem.HasOwnLens(c)) continue;
      AddBlock(lenses_[c].data(), kLensNumbers);
      LensCovariance covariance = problem.lens_priors[c];
      for (double& variance : covariance.diagonal()) {
        if (variance == 0) variance = 1e-12;  // as the solver holds what is exact
      }
      const Eigen::LLT<LensCovariance> information(LensCovariance(covariance.inverse()));
      Add(LensPriorResidual{NumbersOf(problem.cameras[c].lens()), information.matrixU()},
          kLensNumbers, {lenses_[c].data()});
    }
    if (!state_.range_terms.empty()) {
      const auto count = state_.range_terms.size();
      AddBlock(state_.range_terms.data(), static_cast<int>(count));
      PriorResidual of_terms{std::vector<double>(count, 0.0), {}};
      for (std::size_t i = 0; i < count; ++i) of_terms.sigma.push_back(problem.SigmaOfTerm(i));
      Add(of_terms, static_cast<int>(count), {state_.range_terms.data()});
      Add(MeanTerms{problem.ranges.shares, problem.ranges.rings.size()}, 2,
          {state_.range_terms.data()});
    }
    for (std::size_t v = 0; v < boards_.size(); ++v) {
      AddBlock(boards_[v].data(), 6);
      AddBlock(state_.side_shift[v].data(), 4);
      AddView(v);
    }
  }
  CeresBoards(const CeresBoards&) = delete;
  CeresBoards& operator=(const CeresBoards&) = delete;

  BoardState Solve() {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.max_num_iterations = 200;
    options.function_tolerance = 0;  // as far as rounding allows
    options.gradient_tolerance = 0;
    options.parameter_tolerance = 1e-15;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &ceres_, &summary);
    BoardState found = state_;
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
      found.camera_from_lidar[c] = MotionOf(cameras_[c]) * state_.camera_from_lidar[c];
      found.lenses[c] = WithNumbers(found.lenses[c], lenses_[problem_.LensOf(c)]);
    }
    for (std::size_t v = 0; v < boards_.size(); ++v) {
      found.lidar_from_target[v] = state_.lidar_from_target[v] * MotionOf(boards_[v]);
    }
    return found;
  }

  Eigen::MatrixXd Jacobian() {
    ceres::Problem::EvaluateOptions options;
    options.parameter_blocks = blocks_;
    ceres::CRSMatrix sparse;
    ceres_.Evaluate(options, nullptr, nullptr, nullptr, &sparse);
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(sparse.num_rows, sparse.num_cols);
    for (int row = 0; row < sparse.num_rows; ++row) {
      for (int k = sparse.rows[row]; k < sparse.rows[row + 1]; ++k) {
        jacobian(row, sparse.cols[k]) = sparse.values[k];
      }
    }
    return jacobian;
  }

 private:
  void AddBlock(double* block, int size) {
    ceres_.AddParameterBlock(block, size);
    blocks_.push_back(block);
  }

  template <typename Residual>
  void Add(const Residual& residual, int rows, const std::vector<double*>& blocks,
           ceres::LossFunction* loss = nullptr) {
    auto* cost = new ceres::DynamicAutoDiffCostFunction<Residual, 4>(new Residual(residual));
    for (double* block : blocks) cost->AddParameterBlock(ceres_.ParameterBlockSize(block));
    cost->SetNumResiduals(rows);
    ceres_.AddResidualBlock(cost, loss, blocks);
  }

  void AddView(std::size_t v) {
    const BoardView& view = problem_.views[v];
    double* board = boards_[v].data();
    double* shared = state_.shared.data();
    double* sides = state_.side_shift[v].data();
    const Rigid3& pose = state_.lidar_from_target[v];
    for (const BoardImage& image : view.images) AddImage(image, pose, board);
    for (const Crossing& crossing : view.cloud.crossings) {
      const auto side = static_cast<std::size_t>(crossing.side);
      if (!view.sides[side]) continue;
      // From which distance on a crossing counts less is by its own sigma, as the cloud's own pose
      // has it; its weight is by the larger one, its neighbours' correlation counted in.
      const double own = ResidualOf(problem_.target, problem_.priors, crossing,
                                    view.cloud.pose->sensor_from_target, state_.shared, 0)
                             .sigma_m;
      Add(CrossingDistance{problem_.target, pose, crossing}, 1, {board, shared, sides},
          new TailLoss(std::pow(own / crossing.sigma_m, 2)));
    }
    AddPoints(view.cloud, pose, board);
    Add(PriorResidual{std::vector<double>(4, 0.0),
                      std::vector<double>(4, problem_.priors.side_sigma_rad)},
        4, {sides});
  }

  void AddPoints(const CloudEdges& cloud, const Rigid3& pose, double* board) {
    if (cloud.points == 0) return;
    const auto root_of = [](const Eigen::Matrix4d& scatter, double sigma) {
      const Eigensystem<4> eigen = EigensystemOf(scatter);
      const Eigen::Vector4d roots = eigen.values.cwiseMax(0).cwiseSqrt() / sigma;
      return Eigen::Matrix4d(roots.asDiagonal() * eigen.vectors.transpose());
    };
    PlaneDistances all{pose, cloud.centre, MeanBeam(cloud.centre, cloud.raw_scatter), {}, {}};
    std::map<int, PlaneDistances> rings;
    if (cloud.groups.empty()) {
      all.groups.push_back({root_of(cloud.scatter, cloud.scatter_sigma_m), {}});
      rings.emplace(-1, all);
    }
    for (const PointGroup& group : cloud.groups) {
      PlaneDistances& ring = rings.emplace(group.ring, all).first->second;
      ring.groups.push_back({root_of(group.scatter, cloud.group_sigma_m), TermsOf(group)});
    }
    for (auto& [number, ring] : rings) {
      // By how much an offset that the ring's groups share moves their residuals, where they are.
      const auto rows = static_cast<int>(4 * ring.groups.size());
      const double zero[6] = {};
      const std::array<double, 4> unmoved = ring.At<double>(zero, 0, 0);
      const std::array<double, 4> moved = ring.At<double>(zero, 1, 0);
      Eigen::VectorXd along(rows);
      for (std::size_t g = 0; g < ring.groups.size(); ++g) {
        const Eigen::Vector4d by_offset =
            Eigen::Vector4d(moved.data()) - Eigen::Vector4d(unmoved.data());
        along.segment<4>(static_cast<int>(4 * g)) = ring.groups[g].root * by_offset;
      }
      const double sigma = number < 0 ? 0 : problem_.priors.ring_view_sigma_m;
      const Eigen::MatrixXd covariance =
          Eigen::MatrixXd::Identity(rows, rows) + sigma * sigma * along * along.transpose();
      const Eigen::LLT<Eigen::MatrixXd> information(Eigen::MatrixXd(covariance.inverse()));
      ring.whitening = information.matrixU();
      std::vector<double*> blocks{board, state_.shared.data()};
      if (!state_.range_terms.empty()) blocks.push_back(state_.range_terms.data());
      Add(ring, rows, blocks);
    }
  }

  // Which range terms a group's points have a share in: its ring's and two octaves'.
  std::vector<std::pair<std::size_t, double>> TermsOf(const PointGroup& group) const {
    const RangeTerms& ranges = problem_.ranges;
    std::vector<std::pair<std::size_t, double>> terms;
    for (std::size_t i = 0; i < ranges.rings.size(); ++i) {
      if (ranges.rings[i] == group.ring) terms.emplace_back(i, 1.0);
    }
    for (std::size_t i = 0; i < ranges.octaves; ++i) {
      const double away =
          std::abs(group.log2_intensity - ranges.first_octave - static_cast<double>(i));
      if (away < 1) terms.emplace_back(ranges.rings.size() + i, 1 - away);
    }
    return terms;
  }

  void AddImage(const BoardImage& image, const Rigid3& board_pose, double* board) {
    const auto c = static_cast<std::size_t>(image.camera);
    double* camera = cameras_[c].data();
    double* lens = lenses_[problem_.LensOf(c)].data();
    const Seen seen{state_.lenses[c], state_.camera_from_lidar[c], board_pose};
    const ImageEdges& edges = *image.edges;
    const auto model = problem_.target.InnerCorners();
    for (std::size_t i = 0; i < model.size(); ++i) {
      Add(CornerResidual{seen, problem_.target, model[image.turned ? model.size() - 1 - i : i],
                         edges.corners[i], kCornerSigmaInflation * edges.corner_sigma_px},
          2, {camera, lens, board, state_.shared.data()}, new TailLoss(2));
    }
    const auto corners = problem_.target.OutlineCorners();
    for (std::size_t i = 0; i < 4; ++i) {
      const ImageSide& side = edges.sides[i];
      if (!side.seen) continue;
      const std::size_t s = image.turned ? (i + 2) % 4 : i;
      const auto& curve = side.curve;
      const auto last = curve.size() - 1;
      const double px_per_m =
          problem_.cameras[c].lens().fx / edges.pose->sensor_from_target.translation.norm();
      Eigen::Matrix2d covariance = side.covariance;
      for (double& variance : covariance.diagonal()) {
        variance += std::pow(px_per_m * problem_.priors.image_side_sigma_m, 2);
      }
      const Eigen::LLT<Eigen::Matrix2d> information(Eigen::Matrix2d(covariance.inverse()));
      Add(ImageSideResidual{seen,
                            problem_.target,
                            static_cast<int>(s),
                            corners[s],
                            corners[(s + 1) % 4],
                            {curve[0], curve[last]},
                            {(curve[1] - curve[0]).normalized(),
                             (curve[last] - curve[last - 1]).normalized()},
                            information.matrixU()},
          2, {camera, lens, board, state_.shared.data()}, new TailLoss(2));
    }
  }

  const BoardProblem& problem_;
  BoardState state_;
  std::vector<Vector6d> cameras_, boards_;
  std::vector<LensNumbers> lenses_;
  std::vector<double*> blocks_;
  ceres::Problem ceres_;
};

}  // namespace

BoardState SolveByCeres(const BoardProblem& problem, const BoardState& start) {
  BoardState state = start;
  for (int round = 0; round < 3; ++round) state = CeresBoards(problem, state).Solve();
  return state;
}

Eigen::MatrixXd JacobianByCeres(const BoardProblem& problem, const BoardState& state) {
  return CeresBoards(problem, state).Jacobian();
}

}  // namespace rgbdt
