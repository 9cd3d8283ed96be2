#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "calib/model/beam_priors.h"
#include "calib/model/devices.h"
#include "calib/model/image.h"
#include "calib/model/lens.h"
#include "calib/model/markers.h"
#include "calib/model/rigid3.h"

namespace rgbdt {

enum class CameraKind { kColor = 1, kThermal = 2 };

/// Whether a rig is of use without its lenses.
enum class LensNeed {
  kKnown,         ///< every camera has one
  kMayBeUnknown,  ///< they are still to be found
};

/// How far a fuser that follows the monitor may carry a camera away from its calibration.
struct FollowLimits {
  double rotation_rad = 0.0174533;
  double translation_m = 0.03;  ///< of the camera's centre
};

struct CameraSpec {
  std::string name;  ///< lower case; the channel is its upper case + "_IMAGE"
  CameraKind kind = CameraKind::kColor;
  int width = 0, height = 0;  ///< [px]
  PixelFormat format = PixelFormat::kBgr8;
  Lens lens;
  std::optional<LensUncertainty> lens_uncertainty;  ///< absent: as is usual of published lenses
  Radiometry radiometry;                            ///< thermal; used where an image brings none
  /// D: read-out and transfer time; an image serves points from utime + D (+ the calibration's time
  /// offset, where that is above 0).
  double readout_s = 0;
  /// Rolling read-out: from the first row's exposure to the last one's; the image's utime is that
  /// of the middle row. 0: all rows at once.
  double rolling_s = 0;
  double netd_k = 0;  ///< thermal: noise-equivalent temperature difference [K]; 0: unknown
  std::optional<Rigid3> camera_from_lidar_guess;  ///< measured by hand
  std::optional<CameraDevice> device;             ///< for rgbdt-camera
  FollowLimits follow;

  /// What the rig file states, or else UsualLensUncertainty.
  LensUncertainty LensUncertaintyOrUsual() const;
};

/// A 2D scanner on a motor. LIDAR frame: the motor's base, motor axis z, at encoder zero x forward.
/// point_in_lidar = Rz(angle) * motor_from_scanner * (r cos a, 0, r sin a).
struct TurnedScanner {
  Rigid3 motor_from_scanner;
  double ticks_per_rad = 0;
  double zero_ticks = 0;                 ///< reading at which the motor's angle is zero
  std::optional<DynamixelDevice> motor;  ///< for rgbdt-motor
  double encoder_delay_s = 0;            ///< a reading's time is so much after the motor was there
};

struct LidarSpec {
  std::string name;
  std::optional<TurnedScanner> turned_scanner;  ///< absent: the sensor gives 3D clouds itself
  double range_sigma_m = 0.01;
  /// How well a constant that all ranges may be off by is known (1 sigma, about zero); 0: exactly.
  double range_offset_sigma_m = kUsualRangeOffsetSigmaM;
  /// For rgbdt-lidar; std::monostate: none.
  std::variant<std::monostate, HokuyoDevice, VelodyneDevice, PacketLidarDevice, PcdFolderDevice>
      device;
};

/// 1 sigma of each of bow_x, twist and bow_y (Target::BowFactors) where the print is not exact
/// either: two cameras saw 0.9 mm of the recorded board (0.85 x 0.61 m).
inline constexpr double kBowSigmaM = 0.001;

/// The checkerboard. Target frame: origin in the board's centre, x to the right along the width,
/// y down, z away from who looks at it; the printed side is z = 0. The top left square is black:
/// where squares_x + squares_y is odd, that tells top from bottom. A grid of markers is one, too,
/// whose rows and columns are in turn as wide as a gap and as a marker, gaps all round: markers and
/// the small squares between them are black. A board with holes is a grid of two by two markers,
/// nothing round them and no small squares: its inner corners are the markers' corners.
struct Target {
  int squares_x = 0, squares_y = 0;  ///< along width and height; inner corners: one fewer
  double square_m = 0;  ///< side of a square; grid: mean of gap and marker; holes: a marker's
  double width_m = 0, height_m = 0;        ///< of the whole board, border included
  Eigen::Vector2d pattern_offset_m{0, 0};  ///< pattern's centre minus board's centre
  std::optional<Markers> markers;          ///< absent: squares alone
  /// 1 sigma of print_scale, of each: how exactly the pattern has the size that its squares say.
  double print_sigma = 0;
  /// The pattern's width and height over what square_m makes them, as a solve found them.
  Eigen::Vector2d print_scale{1, 1};
  std::optional<Holes> holes{};  ///< with markers only

  /// Whether it has a checkerboard. A plain board, of no squares, is known by its outline alone; it
  /// has no inner corners, and half a turn (a square: a quarter) cannot be told in one view.
  bool HasPattern() const { return squares_x != 0 || squares_y != 0; }
  /// White as far as its outline: a plain board, or one with holes.
  bool WhiteToTheRim() const { return !HasPattern() || holes; }
  int corners_x() const { return squares_x - 1; }
  int corners_y() const { return squares_y - 1; }
  /// Inner corners, row by row from the top left, target frame [m]; corners_x() * corners_y().
  std::vector<Eigen::Vector3d> InnerCorners() const;
  /// From the pattern's left to where that column begins [m]; 0 to squares_x. As square_m says,
  /// whatever print_scale is.
  double ColumnEdge(int column) const { return EdgeAt(column, 0); }
  /// From the pattern's top to where that row begins, likewise.
  double RowEdge(int row) const { return EdgeAt(row, 1); }
  Eigen::Vector2d PatternSize() const { return {ColumnEdge(squares_x), RowEdge(squares_y)}; }
  /// Of the square in that column and row.
  bool IsBlack(int column, int row) const;
  /// Each marker, by rising number. Empty without markers.
  std::vector<MarkerPlace> MarkerPlaces() const;
  /// The holes' centres (x and y of the target frame [m]); none without holes.
  std::vector<Eigen::Vector2d> HoleCentres() const;
  /// No board is quite flat. A point of it lies so far behind its mean plane, to the second order:
  /// z = bow_x (4 x^2 / w^2 - 1/3) + twist 4 x y / (w h) + bow_y (4 y^2 / h^2 - 1/3), w and h the
  /// board's width and height; here the factors of the three, at (x, y) of the target [m]. The
  /// LIDAR's points tell the mean plane; half a turn of the board leaves all three as they are.
  Eigen::Vector3d BowFactors(const Eigen::Vector2d& at) const;
  /// The board's corners: top left, top right, bottom right, bottom left; target frame [m].
  std::array<Eigen::Vector3d, 4> OutlineCorners() const;

 private:
  double EdgeAt(int index, int axis) const;
};

/// A grid of so many markers along width and height, on a board that is not yet given a size.
Target GridOfMarkers(int markers_x, int markers_y, const Markers& markers);

/// A board with holes, of velo2cam's and FAST-Calib's size; of these markers, the rest as `holes`
/// says.
Target BoardWithHoles(const Markers& markers, const Holes& holes = {});

/// A machine, and what of the rig runs there.
struct HostSpec {
  std::string name;               ///< as `hostname` prints it
  std::vector<std::string> runs;  ///< processes, by their names in STATUS: "camera-rgb", "solver"
};

struct Rig {
  std::string name;
  LidarSpec lidar;  ///< the reference: its frame is the rig's LIDAR frame
  std::vector<CameraSpec> cameras;
  Target target;
  std::string text;  ///< the rig file as read: what the bus carries
  std::string hash;  ///< of the text; a calibration names the rig it was made with
  /// LIDARs beside the reference, in the rig file's order; their poses are solved for
  /// (Calibration::lidars).
  std::vector<LidarSpec> further_lidars{};
  std::vector<HostSpec> hosts{};  ///< empty: one machine runs all

  /// Throws InputError naming the field and its value.
  void Check(LensNeed lenses = LensNeed::kKnown) const;
  /// Throws InputError with the names that there are.
  const CameraSpec& Camera(const std::string& camera_name) const;
  /// nullptr: there is none of that name.
  const CameraSpec* FindCamera(const std::string& camera_name) const;
};

/// What a calibration holds for: each camera's image size and lens, the LIDAR's turned scanner.
Rig SensorsOf(const Rig& rig);

}  // namespace rgbdt
