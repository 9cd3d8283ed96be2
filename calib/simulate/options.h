#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/rig.h"
#include "calib/simulate/clutter_options.h"
#include "calib/simulate/lidar_options.h"
#include "calib/simulate/natural_options.h"

namespace rgbdt::simulate {

enum class Scene { kOutdoor, kIndoor, kNight };

/// As a person types them.
inline const std::map<std::string, Scene> kSceneNames = {
    {"outdoor", Scene::kOutdoor}, {"indoor", Scene::kIndoor}, {"night", Scene::kNight}};

/// A 2D scanner (80 degree line, 10,000 beams/s) turned about the LIDAR's z.
struct ScannerOptions : BeamOptions {
  int beams = 400;                         ///< per line
  double first_angle_rad = -40 * kDegree;  ///< elevation of beam 0; past 90 deg beams look back
  double angle_step_rad = 0.2 * kDegree;   ///< between two beams of a line
  double beam_period_s = 1e-4;             ///< between two beams; a line is whole microseconds
  double motor_speed_rad_s = 5 * kDegree;  ///< the motor turns while a line is fired
  double sweep_start_rad = -30 * kDegree;  ///< motor angle at which a sweep starts
  double sweep_rad = 60 * kDegree;         ///< what a sweep covers
  double ticks_per_rad = 1400 / kDegree;   ///< of the encoder, which reads whole ticks
  double zero_ticks = 100000;              ///< reading at motor angle zero
  Eigen::Vector3d lever_arm_m{0.02, 0.0, 0.05};  ///< scanner's origin in the motor's frame
  /// Rotation vector of motor_from_scanner [rad].
  Eigen::Vector3d tilt_rad{0.3 * kDegree, -0.4 * kDegree, 0.2 * kDegree};
  double encoder_delay_s = 0;  ///< a reading's time is so much after the motor was there
  /// The rig file's motor_from_scanner is the truth, turned by this rotation vector about the
  /// motor's axes [rad], its lever arm off by this.
  Eigen::Vector3d guess_lever_m{0, 0, 0}, guess_tilt_rad{0, 0, 0};
};

/// All the way round with a line of 270 degrees over the vertical: 556 lines of 540 beams in half a
/// minute. Every surface but the floor underneath is seen twice.
ScannerOptions FullTurnScanner();

/// One camera: lens, mount, noise. Lenses are pinhole with OpenCV's distortion.
struct CameraOptions {
  std::string name;
  CameraKind kind = CameraKind::kColor;  ///< kColor gives BayerRG8, kThermal Mono16
  int width = 0, height = 0;             ///< [px]
  Lens lens;
  /// The rig file's lens is the true one plus this, and is stated to be known to so much (1 sigma).
  LensNumbers lens_error = LensNumbers::Zero(), lens_sigma = LensNumbers::Zero();
  Eigen::Vector3d position_m{0, 0, 0};  ///< nominal camera centre, LIDAR frame
  double position_spread_m = 0.01;      ///< truth differs by up to this along each axis
  double tilt_rad = 3 * kDegree;        ///< truth looks up to this away from straight ahead
  double blur_px = 0;                   ///< sigma, besides the pixel's own area
  double noise_dn = 0;                  ///< colour: sigma [digital numbers]
  double white_dn = 200;      ///< colour: what the exposure makes of the board's brightest white
  double netd_k = 0;          ///< thermal: sigma [K]
  double gain_k = 0.02;       ///< thermal: [K per count]
  double offset_k = 233.15;   ///< thermal: [K] at zero counts
  int bits = 14;              ///< thermal: counts stop at 2^bits - 1
  double exposure_s = 0.004;  ///< colour: in full sun, longer where darker; thermal: always this
  double readout_s = 0.03;    ///< an image serves points from its utime + this
  int dead_pixels = 0;        ///< stuck at zero or at full scale; which ones, the seed says
};

/// The lens that the rig file has.
Lens RigLens(const CameraOptions& camera);

/// 1936x1456, f = 1100 px, BayerRG8, blur 0.7 px, noise 2 DN.
CameraOptions DefaultColorCamera();
/// 640x480, f = 530 px, 14 bit in Mono16, blur 1 px, NETD 50 mK.
CameraOptions DefaultThermalCamera();

/// A spinning LIDAR beside the rig's own, which is the reference.
struct FurtherLidarOptions {
  std::string name;
  SpinningOptions spinning;
  Eigen::Vector3d position_m{0, 0, 0};  ///< nominal, of its origin, the reference's frame
  double position_spread_m = 0.05;      ///< truth differs by up to this along each axis
  double tilt_rad = 3 * kDegree;        ///< of its z from the reference's, up to this
  /// Turned about its z by up to this, either way. No farther: boards stay off its grid's seam.
  double turn_rad = 120 * kDegree;
};

/// The checkerboard, its stand and its heat. Heat that is absent takes the scene's own value, which
/// is several kelvin outdoors and less in `indoor` and `night` (it was warmed in the sun before).
struct BoardOptions {
  int squares_x = 11, squares_y = 8;
  double square_m = 0.1;
  std::optional<Markers> markers;  ///< and what they do to the squares: see Target
  std::optional<Holes> holes{};    ///< likewise; the border is white then
  /// The pattern's true width and height over what the rig file's square_m makes them, and how well
  /// that is stated to be known (1 sigma, of each).
  Eigen::Vector2d print_scale{1, 1};
  double print_sigma = 0;
  double width_m = 1.2192, height_m = 0.9144;  ///< 4 ft x 3 ft, black border included
  double thickness_m = 0.015;
  double black_reflectivity = 0.08;  ///< in colour and at the LIDAR's wavelength
  double white_reflectivity = 0.7;
  double emissivity = 0.95;
  std::optional<double> temperature_k;        ///< [K] mean of black and white at the coolest
  std::optional<double> black_minus_white_k;  ///< [K]
  std::optional<double> gradient_k;           ///< [K] from one end of the board to the other
  std::optional<double> glow_k;               ///< [K] of the warm patch
  double glow_radius_m = 0.3;                 ///< sigma of the warm patch
  double hidden_outline_m = 0.35;  ///< length of the outline as warm as what lies behind it
  double hidden_depth_m = 0.1;     ///< sigma of how far that reaches inwards [m]
  std::optional<double> border_k;  ///< [K] of the border all round; absent: as warm as black
  double border_to_white = 0;      ///< the border's warmth: 0 that of black squares, 1 of white
  double stand_m = 0.04;           ///< side of the stand's square pole
  double stand_reflectivity = 0.3;
};

/// Where the board is put. Angles against the line of sight from the LIDAR to the board's centre.
struct PoseOptions {
  double min_range_m = 2, max_range_m = 6;  ///< of the board's centre
  double max_tilt_rad = 40 * kDegree;       ///< of its normal from the line of sight
  double max_roll_rad = 45 * kDegree;       ///< in its plane
  double image_margin = 0.03;               ///< outline to image border, of the image's width
  double sweep_margin_rad = 1.5 * kDegree;  ///< outline to the sweep's limits
  double clearance_m = 0.3;                 ///< to ground and objects
  double near_preference = 1.8;  ///< 1: ranges are spread evenly; more: near ones are likelier
  double min_tilt = 0.35;        ///< least tilt, as a share of max_tilt_rad
  double max_azimuth_rad = 25 * kDegree;  ///< of the board's centre from straight ahead
  double min_elevation_rad = -16 * kDegree, max_elevation_rad = 18 * kDegree;
  bool whole_in_lidar = true;  ///< false: the LIDAR's field need only hold the board's centre
  /// Share of the board that lies outside the image of the camera that sees least of it, within
  /// 0.05; 0: the board is wholly seen by all sensors.
  double outside_image = 0;
};

/// Who holds the board; nobody: it stands.
struct HolderOptions {
  int hands = 0;               ///< 0 to 4: at the left, right, upper and lower side
  double hand_reach_m = 0.05;  ///< of the fingers, from the outline inwards over the front
  double hand_k = 307;         ///< [K]
  bool person = false;         ///< close behind the board
  double person_aside_m = 0;   ///< to the left of the board's centre, seen from the LIDAR
};

struct SceneOptions {
  double ground_z_m = -1.2;            ///< the LIDAR stands this high
  double person_temperature_k = 306;   ///< of clothing; skin is 1 K warmer
  double reflected_temperature_k = 0;  ///< [K] what surfaces mirror; 0: the scene's own
  double lamp_range_m = 7;  ///< `night`: the rig's lamp lights the board up to here, then ends
};

/// Every term of the synthetic rig. Angles in radians, lengths in metres.
struct Options {
  std::uint64_t seed = 1;
  Scene scene = Scene::kOutdoor;
  ScannerOptions scanner;
  std::optional<SpinningOptions> spinning;  ///< the rig's LIDAR in place of the scanner
  std::optional<LivoxOptions> livox;        ///< likewise; not both
  std::vector<CameraOptions> cameras{DefaultColorCamera(), DefaultThermalCamera()};
  BoardOptions board;
  PoseOptions pose;
  HolderOptions holder;
  SceneOptions world;
  ClutterOptions clutter;
  NaturalOptions natural;
  double guess_rotation_rad = 2 * kDegree;  ///< hand-measured rotation is wrong by up to this
  double guess_translation_m = 0.05;        ///< hand-measured camera centre: wrong by up to this
  double pick_sigma_px = 1.5;               ///< of a picked corner, along x and along y
  int supersampling = 5;                    ///< n x n rays in a pixel that holds an edge
  int threads = 0;                          ///< 0: as many as the machine has; same result
  std::vector<FurtherLidarOptions> further_lidars;  ///< beside the rig's LIDAR

  /// Whether the rig's LIDAR is the turned scanner.
  bool turned() const { return !spinning && !livox; }
  /// Of the rig's LIDAR.
  const BeamOptions& beam() const;

  /// Throws InputError naming the field and its value.
  void Check() const;
};

/// Gives the rig a spinning LIDAR of so many rings, see SpinningLidar, or kMid360 or kAvia; 0: the
/// turned scanner. That of 64 rings looks down and stands 2 m high, or no board would be wholly in
/// its field.
void UseLidar(int rings, Options* options);

/// Adds a spinning LIDAR of so many rings beside the rig's own, half a metre to its left, the next
/// one to its right: "lidar2", "lidar3" and so on. One of 64 rings raises the rig as UseLidar does.
void AddLidar(int rings, Options* options);

}  // namespace rgbdt::simulate
