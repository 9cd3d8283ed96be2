#include "calib/model/rig.h"

#include <cctype>
#include <cmath>
#include <set>
#include <utility>

#include "calib/model/errors.h"
#include "calib/model/linear_algebra.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

// Larger than any, and smaller than any in millimetres.
constexpr double kLargestRigM = 50, kLargestBoardM = 20, kLargestSquareM = 3, kMostNoiseM = 1;

void Require(bool good, const std::string& field, const std::string& value,
             const std::string& expected) {
  if (!good) throw InputError("rig: " + field + " is " + value + "; expected " + expected);
}

void RequirePositive(double value, const std::string& field) {
  Require(std::isfinite(value) && value > 0, field, std::to_string(value), "a positive number");
}

// A length in metres, of something that is never larger than `most`.
void RequireMetres(double value, double most, const std::string& field) {
  Require(std::abs(value) <= most, field, Format("%g", value),
          Format("metres, %g at most; where these are millimetres: %g", most, value / 1000));
}

void CheckName(const std::string& name, const std::string& field) {
  bool good = !name.empty() && name.size() <= 32;
  for (const char c : name) {
    good &= std::islower(static_cast<unsigned char>(c)) != 0 ||
            std::isdigit(static_cast<unsigned char>(c)) != 0 || c == '_';
  }
  Require(good, field, "\"" + name + "\"", "1 to 32 of a-z, 0-9 and _");
}

void CheckPose(const Rigid3& pose, const std::string& field) {
  Require(pose.translation.allFinite() && std::abs(pose.rotation.norm() - 1) < 1e-6, field,
          "not a pose", "finite metres and a unit quaternion");
  for (const double along : pose.translation) {
    RequireMetres(along, kLargestRigM, field + ".translation_m");
  }
}

void CheckLens(const Lens& lens, const std::string& field) {
  RequirePositive(lens.fx, field + "lens.fx");
  RequirePositive(lens.fy, field + "lens.fy");
  Require(std::isfinite(lens.cx), field + "lens.cx", std::to_string(lens.cx), "a finite number");
  Require(std::isfinite(lens.cy), field + "lens.cy", std::to_string(lens.cy), "a finite number");
  for (const double k : lens.distortion) {
    Require(std::isfinite(k), field + "lens.distortion", std::to_string(k), "finite numbers");
  }
}

// Some combination of the numbers has it, beyond rounding; each in its own sigma.
bool HasNegativeVariance(const LensCovariance& c) {
  LensNumbers scale = c.diagonal().cwiseSqrt();
  for (double& s : scale) s = s > 0 ? 1 / s : 0;
  const LensCovariance correlation = scale.asDiagonal() * c * scale.asDiagonal();
  return EigensystemOf(correlation).values[0] < -1e-6;
}

void CheckLensUncertainty(const LensUncertainty& uncertainty, const std::string& field) {
  const LensCovariance& c = uncertainty.covariance;
  const bool good = c.allFinite() && (c.diagonal().array() >= 0).all() &&
                    c.isApprox(c.transpose(), 1e-6) && !HasNegativeVariance(c);
  Require(good, field + "lens_uncertainty", "no covariance",
          "finite sigmas, 0 or more, or a symmetric, positive semidefinite covariance");
}

void CheckCamera(const CameraSpec& camera, LensNeed lenses) {
  CheckName(camera.name, "camera.name");
  const std::string field = "camera \"" + camera.name + "\": ";
  Require(camera.width > 0 && camera.width <= 20000, field + "width", std::to_string(camera.width),
          "1 to 20000 px");
  Require(camera.height > 0 && camera.height <= 20000, field + "height",
          std::to_string(camera.height), "1 to 20000 px");
  if (lenses == LensNeed::kKnown || camera.lens.known()) CheckLens(camera.lens, field);
  if (camera.lens_uncertainty) CheckLensUncertainty(*camera.lens_uncertainty, field);
  Require(camera.readout_s >= 0 && camera.readout_s <= 60, field + "readout_s",
          std::to_string(camera.readout_s), "0 to 60 seconds");
  Require(camera.rolling_s >= 0 && camera.rolling_s <= 1, field + "rolling_s",
          std::to_string(camera.rolling_s), "0 to 1 second");
  Require(camera.follow.rotation_rad >= 0 && camera.follow.rotation_rad <= M_PI,
          field + "follow.rotation_deg", std::to_string(camera.follow.rotation_rad * 180 / M_PI),
          "0 to 180");
  Require(camera.follow.translation_m >= 0 && camera.follow.translation_m <= 10,
          field + "follow.translation_mm", std::to_string(1e3 * camera.follow.translation_m),
          "0 to 10000");
  const double emissivity = camera.radiometry.emissivity;
  Require(emissivity > 0 && emissivity <= 1, field + "radiometry.emissivity",
          std::to_string(emissivity), "more than 0, at most 1");
  if (camera.camera_from_lidar_guess) {
    CheckPose(*camera.camera_from_lidar_guess, field + "camera_from_lidar_guess");
  }
  const bool sixteen_bit = camera.format == PixelFormat::kMono16;
  Require(camera.kind == CameraKind::kThermal || !sixteen_bit, field + "pixel format", "MONO16",
          "a colour or 8-bit format for a camera of kind COLOR");
}

void CheckMarkers(const Target& target, const Markers& markers) {
  const MarkerFamily* family = FindMarkerFamily(markers.family);
  Require(family != nullptr, "the target's family of markers", "\"" + markers.family + "\"",
          "one of " + MarkerFamilyNames());
  Require(markers.border_bits >= 1 && markers.border_bits <= 4, "the markers' border_bits",
          std::to_string(markers.border_bits), "1 to 4 (Kalibr's tags: 2)");
  RequirePositive(markers.side_m, "the markers' side");
  Require(markers.gap_m >= 0 && markers.gap_m < 2 * kLargestSquareM, "the markers' spacing",
          std::to_string(markers.gap_m), "metres, 0 or more");
  Require(markers.grid() || markers.side_m < target.square_m, "target.charuco.marker_m",
          Exact(markers.side_m), "less than square_m, " + Exact(target.square_m));
  const auto places = target.MarkerPlaces();
  Require(places.back().id < family->count, "the number of the target's last marker",
          std::to_string(places.back().id),
          Format("%d at most: %s has no more", family->count - 1, family->name));
}

void CheckHoles(const Target& target, const Holes& holes) {
  constexpr double kLeastRadiusM = 0.05, kLeastRimM = 0.01, kLeastOblongM = 0.05;
  RequirePositive(target.markers->side_m, "target.holes.marker_m");
  RequireMetres(target.markers->side_m, kLargestSquareM, "target.holes.marker_m");
  Require(holes.radius_m >= kLeastRadiusM, "target.holes.hole_radius_m", Exact(holes.radius_m),
          "5 cm or more");
  Require(target.pattern_offset_m.isZero(0), "target.pattern_offset_m",
          Exact(target.pattern_offset_m.x()) + ", " + Exact(target.pattern_offset_m.y()),
          "none: holes and markers lie about the board's centre");
  Require(std::abs(target.width_m - target.height_m) > kLeastOblongM, "target.width_m",
          Exact(target.width_m), "not as much as height_m: a quarter turn is not told then");
  Require(holes.first_marker >= 0, "target.holes.first_marker", std::to_string(holes.first_marker),
          "0 or more");
  const double side = target.markers->side_m;
  const Eigen::Vector2d size(target.width_m, target.height_m);
  for (int axis = 0; axis < 2; ++axis) {
    const std::string along = axis == 0 ? "x" : "y";
    Require(holes.spacing_m[axis] > 2 * holes.radius_m, "target.holes.hole_spacing_" + along + "_m",
            Exact(holes.spacing_m[axis]), "more than a hole's width: it is from centre to centre");
    Require(0.5 * holes.spacing_m[axis] + holes.radius_m < 0.5 * size[axis],
            "target.holes.hole_spacing_" + along + "_m", Exact(holes.spacing_m[axis]),
            "holes inside the board");
    Require(holes.marker_spacing_m[axis] > 1.25 * side,
            "target.holes.marker_spacing_" + along + "_m", Exact(holes.marker_spacing_m[axis]),
            "more than a marker and a quarter of one: it is from centre to centre");
    Require(holes.marker_spacing_m[axis] + side + 2 * kLeastRimM <= size[axis],
            "target.holes.marker_spacing_" + along + "_m", Exact(holes.marker_spacing_m[axis]),
            "markers at least 1 cm inside the board");
  }
  const Eigen::Vector2d apart =
      (0.5 * (holes.marker_spacing_m - holes.spacing_m).cwiseAbs().array() - 0.5 * side).max(0);
  Require(apart.norm() > holes.radius_m, "target.holes.hole_radius_m", Exact(holes.radius_m),
          "holes that touch no marker");
}

void CheckTarget(const Target& target) {
  RequirePositive(target.width_m, "target.width_m");
  RequirePositive(target.height_m, "target.height_m");
  RequireMetres(target.width_m, kLargestBoardM, "target.width_m");
  RequireMetres(target.height_m, kLargestBoardM, "target.height_m");
  if (!target.HasPattern()) return;
  if (target.holes) CheckHoles(target, *target.holes);
  Require(target.squares_x >= 3 && target.squares_x <= 100, "target.squares_x",
          std::to_string(target.squares_x), "3 to 100");
  Require(target.squares_y >= 3 && target.squares_y <= 100, "target.squares_y",
          std::to_string(target.squares_y), "3 to 100");
  RequirePositive(target.square_m, "target.square_m");
  RequireMetres(target.square_m, kLargestSquareM, "target.square_m");
  for (const double offset : target.pattern_offset_m) {
    Require(std::isfinite(offset), "target.pattern_offset_m", std::to_string(offset),
            "finite numbers");
    RequireMetres(offset, kLargestBoardM, "target.pattern_offset_m");
  }
  Require(target.print_sigma >= 0 && target.print_sigma < 0.1, "target.print_sigma",
          std::to_string(target.print_sigma), "0 (exact) to 0.1");
  if (target.markers) CheckMarkers(target, *target.markers);
  const Eigen::Vector2d half = 0.5 * target.PatternSize() + target.pattern_offset_m.cwiseAbs();
  const std::string or_pattern =
      " m, by squares_x, squares_y (squares, not inner corners) and square_m: one of these, or the "
      "board's size, was counted or measured wrong";
  Require(half.x() <= 0.5 * target.width_m + 1e-6, "target.width_m", std::to_string(target.width_m),
          "at least the pattern's width " + std::to_string(2 * half.x()) + or_pattern);
  Require(half.y() <= 0.5 * target.height_m + 1e-6, "target.height_m",
          std::to_string(target.height_m),
          "at least the pattern's height " + std::to_string(2 * half.y()) + or_pattern);
}

// `field` names the LIDAR.
void CheckLidar(const LidarSpec& lidar, const std::string& field) {
  if (lidar.turned_scanner) {
    const double ticks = lidar.turned_scanner->ticks_per_rad;
    Require(std::isfinite(ticks) && ticks != 0, field + ".turned_scanner.ticks_per_degree",
            std::to_string(ticks), "a number other than zero (negative: turns the other way)");
    Require(std::isfinite(lidar.turned_scanner->zero_ticks), field + ".turned_scanner.zero_ticks",
            std::to_string(lidar.turned_scanner->zero_ticks), "a finite number");
    Require(std::abs(lidar.turned_scanner->encoder_delay_s) <= 1,
            field + ".turned_scanner.encoder_delay_s",
            std::to_string(lidar.turned_scanner->encoder_delay_s), "-1 to 1 s");
    CheckPose(lidar.turned_scanner->motor_from_scanner,
              field + ".turned_scanner.motor_from_scanner");
  }
  RequirePositive(lidar.range_sigma_m, field + ".range_sigma_m");
  RequireMetres(lidar.range_sigma_m, kMostNoiseM, field + ".range_sigma_m");
  Require(lidar.range_offset_sigma_m >= 0 && std::isfinite(lidar.range_offset_sigma_m),
          field + ".range_offset_sigma_m", std::to_string(lidar.range_offset_sigma_m),
          "a number not less than zero");
}

// `names` are the cameras'. Files and frames are called after further LIDARs.
void CheckFurtherLidars(const Rig& rig, std::set<std::string> names) {
  Require(rig.further_lidars.size() < 8, "number of LIDARs",
          std::to_string(rig.further_lidars.size() + 1), "1 to 8");
  names.insert(rig.lidar.name);
  for (const LidarSpec& lidar : rig.further_lidars) {
    CheckName(lidar.name, "lidar.name");
    Require(names.insert(lidar.name).second, "lidar.name", "\"" + lidar.name + "\" twice",
            "a name of its own for each sensor");
    CheckLidar(lidar, "lidar \"" + lidar.name + "\"");
  }
}

// Which processes there are is not known here.
void CheckHosts(const std::vector<HostSpec>& hosts) {
  std::set<std::string> names;
  std::set<std::string> processes;
  for (const HostSpec& host : hosts) {
    Require(!host.name.empty() && host.name.size() <= 64, "host.name", "\"" + host.name + "\"",
            "what `hostname` prints there");
    Require(names.insert(host.name).second, "host.name", "\"" + host.name + "\" twice",
            "a name of its own for each machine");
    for (const std::string& process : host.runs) {
      Require(processes.insert(process).second, "host \"" + host.name + "\": runs",
              "\"" + process + "\", as another does", "each process on one machine");
    }
  }
}

}  // namespace

double Target::EdgeAt(int index, int axis) const {
  if (!markers || !markers->grid()) return index * square_m;
  const int gaps = (index + 1) / 2;
  if (holes) {  // no gaps but the one between the two
    const int markers_before = index / 2;
    return markers_before * markers->side_m +
           (index >= 3 ? holes->marker_spacing_m[axis] - markers->side_m : 0);
  }
  return gaps * markers->gap_m + (index - gaps) * markers->side_m;
}

bool Target::IsBlack(int column, int row) const {
  if (holes) return column % 2 == 1 && row % 2 == 1;
  const bool white_first = markers && markers->legacy && squares_y % 2 == 0;
  return ((column + row) % 2 == 0) != white_first;
}

std::vector<Eigen::Vector3d> Target::InnerCorners() const {
  const auto from_middle = [&](int index, int squares, int axis) {
    const double scale = print_scale[axis];
    if (!markers || !markers->grid()) return (index - 0.5 * squares) * (square_m * scale);
    return (EdgeAt(index, axis) - 0.5 * EdgeAt(squares, axis)) * scale;
  };
  std::vector<Eigen::Vector3d> corners;
  corners.reserve(static_cast<std::size_t>(corners_x() * corners_y()));
  for (int row = 1; row < squares_y; ++row) {
    for (int column = 1; column < squares_x; ++column) {
      corners.emplace_back(pattern_offset_m.x() + from_middle(column, squares_x, 0),
                           pattern_offset_m.y() + from_middle(row, squares_y, 1), 0.0);
    }
  }
  return corners;
}

std::vector<MarkerPlace> Target::MarkerPlaces() const {
  std::vector<MarkerPlace> places;
  if (!markers) return places;
  const Eigen::Vector2d first = pattern_offset_m - 0.5 * PatternSize();
  for (int i = 0; i < squares_y; ++i) {
    const int row = markers->grid() && !holes ? squares_y - 1 - i : i;
    for (int column = 0; column < squares_x; ++column) {
      const bool here = markers->grid() ? column % 2 == 1 && row % 2 == 1 : !IsBlack(column, row);
      if (!here) continue;
      const Eigen::Vector2d middle(ColumnEdge(column) + ColumnEdge(column + 1),
                                   RowEdge(row) + RowEdge(row + 1));
      const int number = static_cast<int>(places.size()) + (holes ? holes->first_marker : 0);
      places.push_back({number, first + 0.5 * middle});
    }
  }
  return places;
}

std::vector<Eigen::Vector2d> Target::HoleCentres() const {
  std::vector<Eigen::Vector2d> centres;
  if (!holes) return centres;
  for (const double y : {-0.5, 0.5}) {
    for (const double x : {-0.5, 0.5}) {
      centres.emplace_back(x * holes->spacing_m.x(), y * holes->spacing_m.y());
    }
  }
  return centres;
}

Eigen::Vector3d Target::BowFactors(const Eigen::Vector2d& at) const {
  const double x = 2 * at.x() / width_m;
  const double y = 2 * at.y() / height_m;
  return {x * x - 1.0 / 3, x * y, y * y - 1.0 / 3};
}

std::array<Eigen::Vector3d, 4> Target::OutlineCorners() const {
  const double x = 0.5 * width_m;
  const double y = 0.5 * height_m;
  return {Eigen::Vector3d(-x, -y, 0), Eigen::Vector3d(x, -y, 0), Eigen::Vector3d(x, y, 0),
          Eigen::Vector3d(-x, y, 0)};
}

Target GridOfMarkers(int markers_x, int markers_y, const Markers& markers) {
  Target target;
  target.squares_x = 2 * markers_x + 1;
  target.squares_y = 2 * markers_y + 1;
  target.square_m = 0.5 * (markers.side_m + markers.gap_m);
  target.markers = markers;
  return target;
}

Target BoardWithHoles(const Markers& markers, const Holes& holes) {
  Target target;
  target.markers = markers;
  target.holes = holes;
  target.squares_x = target.squares_y = 5;
  target.square_m = markers.side_m;
  target.markers->gap_m = holes.marker_spacing_m.minCoeff() - markers.side_m;
  target.width_m = 1.4;
  target.height_m = 1.0;
  return target;
}

void Rig::Check(LensNeed lenses) const {
  Require(!cameras.empty() && cameras.size() <= 32, "number of cameras",
          std::to_string(cameras.size()), "1 to 32");
  std::set<std::string> names;
  for (const CameraSpec& camera : cameras) {
    CheckCamera(camera, lenses);
    Require(names.insert(camera.name).second, "camera.name", "\"" + camera.name + "\" twice",
            "a name of its own for each camera");
  }
  CheckLidar(lidar, "lidar");
  CheckFurtherLidars(*this, std::move(names));
  CheckHosts(hosts);
  CheckTarget(target);
}

LensUncertainty CameraSpec::LensUncertaintyOrUsual() const {
  return lens_uncertainty ? *lens_uncertainty : UsualLensUncertainty(lens, width, height);
}

const CameraSpec* Rig::FindCamera(const std::string& camera_name) const {
  for (const CameraSpec& camera : cameras) {
    if (camera.name == camera_name) return &camera;
  }
  return nullptr;
}

const CameraSpec& Rig::Camera(const std::string& camera_name) const {
  if (const CameraSpec* found = FindCamera(camera_name)) return *found;
  std::string names;
  for (const CameraSpec& camera : cameras) names += (names.empty() ? "" : ", ") + camera.name;
  throw InputError("the rig has no camera \"" + camera_name + "\"; it has: " + names);
}

namespace {

LidarSpec SensorOf(const LidarSpec& lidar) {
  LidarSpec sensor;
  sensor.name = lidar.name;
  if (const auto* velodyne = std::get_if<VelodyneDevice>(&lidar.device)) {
    VelodyneDevice model;
    model.model = velodyne->model;
    sensor.device = model;
  } else if (const auto* packets = std::get_if<PacketLidarDevice>(&lidar.device)) {
    PacketLidarDevice make;
    make.make = packets->make;
    sensor.device = make;
  }
  if (lidar.turned_scanner) {
    sensor.turned_scanner = lidar.turned_scanner;
    sensor.turned_scanner->motor.reset();
  }
  return sensor;
}

}  // namespace

Rig SensorsOf(const Rig& rig) {
  Rig sensors;
  sensors.name = rig.name;
  sensors.lidar = SensorOf(rig.lidar);
  for (const LidarSpec& lidar : rig.further_lidars) {
    sensors.further_lidars.push_back(SensorOf(lidar));
  }
  for (const CameraSpec& camera : rig.cameras) {
    CameraSpec& sensor = sensors.cameras.emplace_back();
    sensor.name = camera.name;
    sensor.kind = camera.kind;
    sensor.format = camera.format;
    sensor.width = camera.width;
    sensor.height = camera.height;
    sensor.lens = camera.lens;
  }
  return sensors;
}

}  // namespace rgbdt
