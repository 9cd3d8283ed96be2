#pragma once

#include <array>
#include <optional>
#include <vector>

#include "calib/camera/camera.h"
#include "calib/solve/internal/joint_solve.h"
#include "tests/unit/matchers.h"
#include "tests/unit/solve/board_world.h"

namespace rgbdt {

/// What a made session is made of. Noise is drawn from the model that the solve states.
struct SolveWorldOptions {
  int views = 10;
  std::uint32_t seed = 1;
  double noise = 1;                ///< scale of all noise; sigmas are stated as for 1
  int heldout_every = 0;           ///< 0: none
  bool draw_nuisances = false;     ///< classes, thickness, outline: from their priors
  bool nuisances_by_view = false;  ///< drawn anew for each view, and the outline as it should be
  double side_sigma_rad = 0;       ///< each side's own shift
  /// What the rig says of its lenses, which are the very ones; absent: nothing.
  std::optional<LensUncertainty> lens_uncertainty = LensUncertainty{};
  double print_sigma = 0;  ///< Target::print_sigma
  /// Ranges, as a spinning LIDAR of 16 rings has them: clouds tell rings and intensities apart.
  struct Rings {
    double sigma_m = 0;          ///< of each ring's offset
    double dark_m = 0;           ///< what dark points are measured farther
    double in_view_sigma_m = 0;  ///< of each ring's further offset in each view
    double beams_meet_m = 0;
  };
  std::optional<Rings> rings;
  /// The LIDAR is a turned scanner.
  struct Motor {
    double turn_rad_s = 0;
    bool both_ways = false;      ///< every other view the other way
    double encoder_delay_s = 0;  ///< by which its encoder is stamped late
  };
  std::optional<Motor> motor;
  bool plain = false;  ///< a square without a pattern, told from each of its corners in turn
  std::array<double, kSharedUnknowns> shared = BoardPriors().Means();  ///< if not drawn
};

/// A session of a colour camera with a pinhole and a thermal one with a fisheye lens beside a
/// LIDAR: what detection would give of boards at known places. Clouds tell sides from either end.
class SolveWorld {
 public:
  explicit SolveWorld(const SolveWorldOptions& options = {});

  Rig rig;
  std::vector<Rigid3> camera_from_lidar;  ///< the truth, in the rig's order; so are the others
  std::array<double, kSharedUnknowns> shared{};
  std::vector<Rigid3> lidar_from_target;
  std::vector<std::array<double, 4>> side_shift;
  std::array<double, 16> ring_offset_m{};  ///< true less measured
  std::vector<ViewDetection> detections;   ///< one a view

  /// What a camera sees through, whatever the rig says.
  const Lens& TrueLens(std::size_t camera) const { return true_lenses_[camera]; }

  /// All cameras turned by so much about an axis of their own, and moved: what is seen from here
  /// on.
  void MoveCameras(double angle, double distance_m);

  /// The board held once more.
  void AddView(const Rigid3& board);

  /// What a second LIDAR sees in all views so far, made as the reference's clouds are; its ranges
  /// fall short by `ranges_off_m`, and classes of edges are shifted anew where nuisances are drawn.
  LidarViews SeenBy(const std::string& lidar, const Rigid3& reference_from_lidar,
                    double ranges_off_m);

  ImageEdges& ImageAt(std::size_t view, std::size_t camera) {
    return *detections[view].images[camera].edges;
  }
  CloudEdges& CloudAt(std::size_t view) { return detections[view].cloud.candidates.at(0); }

  /// The whole board lies in all images, and faces the LIDAR.
  bool Seen(const Rigid3& board, double margin_px = 5) const;

  double Normal();

  Rigid3 AnyBoard();

 private:
  std::vector<Lens> true_lenses_;
  double Noise() { return options_.noise * Normal(); }

  std::array<double, kSharedUnknowns> Drawn(bool outline);

  Eigen::Vector3d Bent(const Eigen::Vector3d& flat) const;

  // The image's corners and sides, and the pose that the corners give.
  ImageEdges SeeImage(std::size_t c, const Rigid3& camera_from_target);

  ImageSide SeeSide(const std::vector<Eigen::Vector2d>& chain, double sigma);
  TargetPose PoseOfCorners(const Camera& camera, const ImageEdges& image, Rigid3 pose) const;
  CloudEdges SeeCloud(const Rigid3& board, const std::array<double, 4>& shift, bool turned);

  // Where a scan leaves the board: the side as the beam's width, the rim and the cut shift it,
  // somewhere in the interval between two beams.
  Crossing SeeCrossing(const Rigid3& board, const Eigen::Vector3d& on_side, int side,
                       CrossingKind kind, const std::array<double, kSharedUnknowns>& nuisances,
                       double own_shift);

  void SeePlane(const Rigid3& board, CloudEdges* cloud);
  void SeeRings(const Rigid3& board, CloudEdges* cloud);
  // Where a cloud has what a beam met.
  Eigen::Vector3d Published(const Eigen::Vector3d& met) const;

  // From crossings and plane, their shifts unknown.
  TargetPose PoseOfCloud(const CloudEdges& cloud, Rigid3 pose) const;

  SolveWorldOptions options_;
  Random random_;
};

/// An image told from the board's other end.
void TurnImage(ImageEdges* image);

/// What CalibrateByBoards makes before it solves, of cameras whose first guess is given.
class SolveSession {
 public:
  SolveSession(const SolveWorld& world, const std::vector<Rigid3>& guesses);
  explicit SolveSession(const SolveWorld& world) : SolveSession(world, world.camera_from_lidar) {}
  SolveSession(const SolveSession&) = delete;
  SolveSession& operator=(const SolveSession&) = delete;

  /// Views from this one on are another session's, whose cameras are elsewhere.
  void Divide(std::size_t first_view, const std::vector<Rigid3>& camera_from_lidar);

  JointProblem Joint(double range_offset_sigma_m = 0) const;

  std::vector<GuessedCamera> cameras;

 private:
  Rig rig_;  // whose cameras `cameras` point to
};

/// Chi-square of a pose's error by a covariance of delta; 6 is to be expected.
double Chi2Of(const Rigid3& truth, const Rigid3& estimate, const Matrix6d& covariance);

}  // namespace rgbdt
