#include "calib/solve/internal/given_wrong.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "calib/model/linear_algebra.h"
#include "calib/model/statistics.h"
#include "calib/model/text.h"
#include "calib/solve/internal/lens_by_images.h"
#include "calib/solve/internal/pattern_word.h"

namespace rgbdt {
namespace {

using Index = Eigen::Index;

// What a careful person leaves when measuring, 1 sigma.
constexpr double kSquareTolerance = 0.002;     // of a square's side
constexpr double kScaleTolerance = 0.001;      // of the cloud's
constexpr double kSizeToleranceM = 0.003;      // of a board's width and height
constexpr double kPlainSizeToleranceM = 0.04;  // its rim is seen, too
constexpr double kPlaceToleranceM = 0.002;     // of the pattern on the board

constexpr char kWholeLens[] = "lens";
constexpr char kFindTheLens[] =
    "Find the lens with 20 views or more all over the image (rgbdt intrinsics)";

// What is known of a quantity that was given: by how much it is off.
struct Off {
  Eigen::VectorXd value;
  Eigen::MatrixXd covariance;
  std::optional<double> moves_sigma;

  double Sigma(Index i) const { return std::sqrt(covariance(i, i)); }
};

// "3.1 +- 0.2%"
std::string Percent(double value, double sigma) {
  return Format("%.1f +- %.1f%%", 100 * std::abs(value), 100 * sigma);
}

// "12 +- 3 mm"
std::string Millimetres(double value, double sigma) {
  return Format("%+.0f +- %.0f mm", 1000 * value, 1000 * sigma);
}

// Whether a focal length stands where the centre belongs, and the other way round.
bool AreExchanged(double focal, double centre, double found_focal, double found_centre) {
  const auto near = [](double a, double b) { return std::abs(a - b) < 0.05 * std::abs(b); };
  return near(focal, found_centre) && near(centre, found_focal) && !near(focal, found_focal);
}

Cause CauseOf(std::string name, std::string words, const Off& off) {
  return {std::move(name), std::move(words),
          off.value.dot(SolveSymmetric(off.covariance, off.value)),
          static_cast<int>(off.value.size()), off.moves_sigma};
}

class Tester {
 public:
  explicit Tester(const JointResult& result)
      : result_(result),
        problem_(result.joint.problem),
        places_(problem_),
        models_(problem_.cameras.size()) {
    const Index size = places_.Count();
    information_ = Eigen::MatrixXd::Zero(size, size);
    gradient_ = Eigen::VectorXd::Zero(size);
    for (const ViewInformation& view : result.solution.views) {
      information_ += view.information;
      gradient_ += view.gradient;
    }
    with_priors_ = gradient_ + PriorInformation(problem_, result.solution.state).gradient;
  }

  std::vector<Cause> Of(std::size_t camera) {
    camera_ = camera;
    std::vector<Cause> causes;
    const auto add = [&](std::optional<Cause> cause) {
      if (cause && std::isfinite(cause->Sigmas())) causes.push_back(std::move(*cause));
    };
    for (lens_ = 0; lens_ < problem_.cameras.size(); ++lens_) {
      if (!problem_.HasOwnLens(lens_)) continue;
      for (Cause& cause : OfLens()) {
        // Cameras that are solved together share boards: what is wrong of one moves the others.
        const bool own = lens_ == problem_.LensOf(camera_);
        if (own || cause.Sigmas() >= kGivenWrongSigmas) add(std::move(cause));
      }
    }
    if (problem_.PatternIsSeen()) {
      add(Squares());
      add(CloudScale());
      add(PatternPlace());
    }
    add(Larger(BoardSize(), SizeByClouds()));
    // A part of a lens that is surely wrong says more than that the whole is.
    const auto rank = [](const Cause& cause) {
      const bool sure = cause.Sigmas() >= kGivenWrongSigmas;
      return std::tuple(!sure, cause.name == kWholeLens, -cause.Sigmas());
    };
    std::stable_sort(causes.begin(), causes.end(),
                     [&](const Cause& a, const Cause& b) { return rank(a) < rank(b); });
    return causes;
  }

 private:
  const CameraSpec& Spec() const { return *result_.joint.cameras[lens_].views.spec; }
  const Target& Board() const { return problem_.target; }
  Index Lens(Index number) const { return places_.Lens(lens_) + number; }
  Eigen::MatrixXd Directions(Index count) const {
    return Eigen::MatrixXd::Zero(places_.Count(), count);
  }

  // By how much the state would have to differ along `v`; `tolerance` is what it may, 1 sigma.
  std::optional<Off> Test(const Eigen::MatrixXd& v, double tolerance) const {
    const Eigen::MatrixXd& covariance = result_.solution.covariance;
    const Eigen::MatrixXd dv = information_ * v;
    const Eigen::MatrixXd information = v.transpose() * dv - dv.transpose() * covariance * dv;
    if (!(information.diagonal().minCoeff() > 0)) return std::nullopt;
    const Eigen::MatrixXd inverse = InverseOfSymmetric(information);
    Off off;
    off.value = inverse * (v.transpose() * gradient_ - dv.transpose() * covariance * with_priors_);
    off.covariance = result_.variance_factor * inverse;
    off.covariance.diagonal().array() += tolerance * tolerance;
    if (!off.value.allFinite() || !off.covariance.allFinite()) return std::nullopt;
    const Eigen::VectorXd move = -(covariance * dv * off.value);
    const Vector6d pose = move.segment<6>(SharedPlaces::Pose(camera_));
    const Matrix6d of_pose = CovarianceOf(result_, camera_).topLeftCorner<6, 6>();
    off.moves_sigma = std::sqrt(std::max(0.0, pose.dot(SolveSymmetric(of_pose, pose))));
    return off;
  }

  Cause FocalCause(const Off& off) const {
    return CauseOf("focal length",
                   Format("the focal length of %s in the rig file is %s too %s. %s",
                          Spec().name.c_str(), Percent(off.value[0], off.Sigma(0)).c_str(),
                          off.value[0] > 0 ? "short" : "long", kFindTheLens),
                   off);
  }

  Cause AspectCause(const Off& off) const {
    return CauseOf("fx against fy",
                   Format("fx over fy of %s in the rig file is %s too %s. %s", Spec().name.c_str(),
                          Percent(off.value[0], off.Sigma(0)).c_str(),
                          off.value[0] > 0 ? "small" : "large", kFindTheLens),
                   off);
  }

  Cause CentreCause(const Off& off) const {
    return CauseOf("image centre",
                   Format("the centre (cx, cy) of %s in the rig file is off: these views put it "
                          "%+.1f +- %.1f, %+.1f +- %.1f px away. %s",
                          Spec().name.c_str(), off.value[0], off.Sigma(0), off.value[1],
                          off.Sigma(1), kFindTheLens),
                   off);
  }

  // How far the pose moves by the distortion's linear part is not how far it moves: views that it
  // bends too far are rejected.
  Cause DistortionCause(Off off) const {
    off.moves_sigma.reset();
    return CauseOf("distortion",
                   Format("the distortion of %s in the rig file does not fit these views. %s; give "
                          "pinhole or fisheye as the lens is",
                          Spec().name.c_str(), kFindTheLens),
                   off);
  }

  std::vector<Cause> OfLens() {
    const LensOff& off = result_.lenses_off[lens_];
    if (off.contradicts()) return OfRefutedLens(off);
    std::vector<Cause> causes;
    for (std::optional<Cause> cause : std::array{Focal(), Aspect(), Centre(), Distortion()}) {
      if (cause) causes.push_back(std::move(*cause));
    }
    return causes;
  }

  std::optional<Cause> Focal() const {
    Eigen::MatrixXd v = Directions(1);
    v(Lens(0), 0) = Spec().lens.fx;
    v(Lens(1), 0) = Spec().lens.fy;
    const auto off = Test(v, 0);
    return off ? std::optional(FocalCause(*off)) : std::nullopt;
  }

  std::optional<Cause> Aspect() const {
    Eigen::MatrixXd v = Directions(1);
    v(Lens(0), 0) = Spec().lens.fx / 2;
    v(Lens(1), 0) = -Spec().lens.fy / 2;
    const auto off = Test(v, 0);
    return off ? std::optional(AspectCause(*off)) : std::nullopt;
  }

  std::optional<Cause> Centre() const {
    Eigen::MatrixXd v = Directions(2);
    v(Lens(2), 0) = 1;
    v(Lens(3), 1) = 1;
    const auto off = Test(v, 0);
    return off ? std::optional(CentreCause(*off)) : std::nullopt;
  }

  std::optional<Cause> Distortion() const {
    const Index count = NumbersOfDistortion();
    Eigen::MatrixXd v = Directions(count);
    for (Index i = 0; i < count; ++i) v(Lens(4 + i), i) = 1;
    const auto off = Test(v, 0);
    return off ? std::optional(DistortionCause(*off)) : std::nullopt;
  }

  Index NumbersOfDistortion() const {
    return static_cast<Index>(NamesOfNumbers(Spec().lens.model).size()) - 4;
  }

  // The lens that was found against the one that was given, part by part. The result has it, so
  // that it does not move any more.
  std::vector<Cause> OfRefutedLens(const LensOff& lens) {
    const auto part = [&](const Eigen::MatrixXd& by_numbers) {
      return Off{by_numbers * lens.off, by_numbers * lens.covariance * by_numbers.transpose(), 0.0};
    };
    Eigen::MatrixXd focal = Eigen::MatrixXd::Zero(1, kLensNumbers);
    focal(0, 0) = 0.5 / Spec().lens.fx;
    focal(0, 1) = 0.5 / Spec().lens.fy;
    Eigen::MatrixXd aspect = 2 * focal;
    aspect(0, 1) *= -1;
    Eigen::MatrixXd centre = Eigen::MatrixXd::Zero(2, kLensNumbers);
    centre(0, 2) = centre(1, 3) = 1;
    const Index count = NumbersOfDistortion();
    Eigen::MatrixXd distortion = Eigen::MatrixXd::Zero(count, kLensNumbers);
    for (Index i = 0; i < count; ++i) distortion(i, 4 + i) = 1;
    Cause all{kWholeLens,
              Format("the lens of %s in the rig file contradicts these views: they put the focal "
                     "length %+.2f%%, the centre %+.1f, %+.1f px off. The lens found here is used "
                     "and stands in the calibration. %s and put it into the rig file",
                     Spec().name.c_str(),
                     50 * (lens.off[0] / Spec().lens.fx + lens.off[1] / Spec().lens.fy),
                     lens.off[2], lens.off[3], kFindTheLens),
              lens.chi2, lens.freedom, 0.0};
    const std::string exchanged = Exchanged(lens.off);
    if (!exchanged.empty()) {
      all = {exchanged, exchanged + " of " + Spec().name + " are exchanged in the rig file",
             lens.chi2, lens.freedom, 0.0};
      return {std::move(all)};
    }
    return {FocalCause(part(focal)), AspectCause(part(aspect)), CentreCause(part(centre)),
            ModelOrDistortion(DistortionCause(part(distortion))), std::move(all)};
  }

  // That the model is the wrong one, where the images want the other: it says more. One of another
  // model bends otherwise: where the distortion is as given, the model is, too.
  Cause ModelOrDistortion(Cause distortion) {
    if (!(distortion.Sigmas() >= kGivenWrongSigmas)) return distortion;
    const auto& model = ModelByImages();
    if (!model) return distortion;
    distortion.name = model->name;
    distortion.words = model->words;
    return distortion;
  }

  // Of one lens for all cameras' reports: it takes longer than all else here.
  const std::optional<Cause>& ModelByImages() {
    auto& model = models_[lens_];
    if (!model) {
      const auto lens = FindLensByImages(Board(), result_.joint.cameras[lens_].views);
      model = lens ? OtherModel(*lens, Spec()) : std::nullopt;
    }
    return *model;
  }

  // "fx and cx", "fy and cy", or nothing.
  std::string Exchanged(const LensNumbers& off) const {
    const auto& given = Spec().lens;
    if (AreExchanged(given.fx, given.cx, given.fx + off[0], given.cx + off[2])) return "fx and cx";
    if (AreExchanged(given.fy, given.cy, given.fy + off[1], given.cy + off[3])) return "fy and cy";
    return "";
  }

  std::optional<Cause> Squares() const {
    Eigen::MatrixXd v = Directions(1);
    v(places_.Of(kPrintWidth), 0) = v(places_.Of(kPrintHeight), 0) = 1;
    const auto off = Test(v, kSquareTolerance);
    if (!off) return std::nullopt;
    const double by = off->value[0];
    if (Board().holes) {
      const Eigen::Vector2d& given = Board().holes->marker_spacing_m;
      return CauseOf("markers",
                     Format("the markers lie %s %s than given: %.0f x %.0f mm where the rig file "
                            "has %.0f x %.0f mm. Measure from marker to marker",
                            Percent(by, off->Sigma(0)).c_str(), by > 0 ? "farther apart" : "nearer",
                            1000 * (1 + by) * given.x(), 1000 * (1 + by) * given.y(),
                            1000 * given.x(), 1000 * given.y()),
                     *off);
    }
    return CauseOf("squares",
                   Format("the squares are %s %s than given: %.1f mm where the rig file has %.1f "
                          "mm. Measure ten of them with a ruler",
                          Percent(by, off->Sigma(0)).c_str(), by > 0 ? "larger" : "smaller",
                          1000 * (1 + by) * Board().square_m, 1000 * Board().square_m),
                   *off);
  }

  // All that was measured by the LIDAR is larger than all that was measured with a ruler.
  std::optional<Cause> CloudScale() const {
    Eigen::MatrixXd v = Directions(1);
    v(places_.Of(kPrintWidth), 0) = v(places_.Of(kPrintHeight), 0) = 1;
    v(places_.Of(kOutlineRight), 0) = v(places_.Of(kOutlineLeft), 0) = Board().width_m / 2;
    v(places_.Of(kOutlineTop), 0) = v(places_.Of(kOutlineBottom), 0) = Board().height_m / 2;
    const auto off = Test(v, kScaleTolerance);
    if (!off) return std::nullopt;
    const double by = off->value[0];
    return CauseOf(
        "cloud's scale",
        Format("the cloud is %s too %s, or %s and board are all %s than given. "
               "Measure board and %s, and check the LIDAR's unit of length against a "
               "tape measure",
               Percent(by, off->Sigma(0)).c_str(), by > 0 ? "large" : "small", PatternWord(Board()),
               by > 0 ? "larger" : "smaller", PatternWord(Board())),
        *off);
  }

  std::optional<Cause> BoardSize() const {
    Eigen::MatrixXd v = Directions(2);
    v(places_.Of(kOutlineRight), 0) = v(places_.Of(kOutlineLeft), 0) = 0.5;
    v(places_.Of(kOutlineTop), 1) = v(places_.Of(kOutlineBottom), 1) = 0.5;
    const auto off = Test(v, SizeTolerance());
    return off ? std::optional(SizeCause(*off)) : std::nullopt;
  }

  double SizeTolerance() const {
    return Board().WhiteToTheRim() ? kPlainSizeToleranceM : kSizeToleranceM;
  }

  Cause SizeCause(const Off& off) const {
    return CauseOf(
        "board's size",
        Format("the board is %s wider and %s higher than given: %.0f x %.0f mm where the "
               "rig file has %.0f x %.0f mm (width_m, height_m: the whole board, border "
               "included). Measure it",
               Millimetres(off.value[0], off.Sigma(0)).c_str(),
               Millimetres(off.value[1], off.Sigma(1)).c_str(),
               1000 * (Board().width_m + off.value[0]), 1000 * (Board().height_m + off.value[1]),
               1000 * Board().width_m, 1000 * Board().height_m),
        off);
  }

  // By all crossings as they are: those that lie far from where they are looked for have next to no
  // say in the solve.
  std::optional<Cause> SizeByClouds() const {
    std::array<std::vector<double>, 2> excess;  // of width, of height; by view
    std::vector<double> ranges;
    const BoardState& state = result_.solution.state;
    for (std::size_t view = 0; view < problem_.views.size(); ++view) {
      const CloudEdges& cloud = problem_.views[view].cloud;
      std::array<std::vector<double>, 4> beyond;
      for (const Crossing& crossing : cloud.crossings) {
        const double off = ResidualOf(Board(), problem_.priors, crossing,
                                      state.lidar_from_target[view], state.shared, 0)
                               .beyond_m;
        if (std::isfinite(off)) beyond[static_cast<std::size_t>(crossing.side)].push_back(off);
      }
      for (std::size_t axis = 0; axis < 2; ++axis) {
        std::vector<double>& one = beyond[1 - axis];
        std::vector<double>& other = beyond[3 - axis];
        if (one.empty() || other.empty()) continue;
        excess[axis].push_back(Median(std::move(one)) + Median(std::move(other)));
      }
      ranges.push_back(cloud.centre.norm());
    }
    constexpr std::size_t kLeastViews = 3;
    Off off{Eigen::VectorXd(2), Eigen::MatrixXd::Zero(2, 2), std::nullopt};
    const double tolerance = SizeTolerance();
    if (excess[0].size() < kLeastViews || excess[1].size() < kLeastViews) return std::nullopt;
    // Shifts of classes move both sides outwards.
    const double shift = 2 * problem_.priors.class_sigma_rad * Median(std::move(ranges));
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const auto count = static_cast<double>(excess[axis].size());
      const double middle = Median(excess[axis]);
      for (double& value : excess[axis]) value = std::abs(value - middle);
      const double scatter = 1.4826 * Median(std::move(excess[axis]));
      const auto at = static_cast<Index>(axis);
      off.value[at] = middle + state.shared[axis == 0 ? kOutlineRight : kOutlineTop] +
                      state.shared[axis == 0 ? kOutlineLeft : kOutlineBottom];
      off.covariance(at, at) =
          1.57 * scatter * scatter / count + shift * shift + tolerance * tolerance;
    }
    return SizeCause(off);
  }

  std::optional<Cause> PatternPlace() const {
    Eigen::MatrixXd v = Directions(2);
    v(places_.Of(kOutlineRight), 0) = 1;
    v(places_.Of(kOutlineLeft), 0) = -1;
    v(places_.Of(kOutlineBottom), 1) = 1;
    v(places_.Of(kOutlineTop), 1) = -1;
    const auto off = Test(v, kPlaceToleranceM);
    if (!off) return std::nullopt;
    return CauseOf(
        "pattern's place",
        Format("the pattern does not lie where the rig file has it on the board: it lies "
               "%s to the right and %s lower (pattern_offset_m). Measure its distance "
               "from the board's four sides",
               Millimetres(-off->value[0], off->Sigma(0)).c_str(),
               Millimetres(-off->value[1], off->Sigma(1)).c_str()),
        *off);
  }

  static std::optional<Cause> Larger(std::optional<Cause> a, std::optional<Cause> b) {
    return b && (!a || b->Sigmas() > a->Sigmas()) ? std::move(b) : std::move(a);
  }

  const JointResult& result_;
  const BoardProblem& problem_;
  SharedPlaces places_;
  std::size_t camera_ = 0;                                   // whose pose it is about
  std::size_t lens_ = 0;                                     // whose lens is looked at
  std::vector<std::optional<std::optional<Cause>>> models_;  // by lens, where it was looked for
  Eigen::MatrixXd information_;
  Eigen::VectorXd gradient_, with_priors_;
};

}  // namespace

std::vector<std::vector<Cause>> GivenWrong(const JointResult& result) {
  Tester tester(result);
  std::vector<std::vector<Cause>> causes;
  for (std::size_t c = 0; c < result.joint.cameras.size(); ++c) causes.push_back(tester.Of(c));
  return causes;
}

}  // namespace rgbdt
