#include "tests/unit/files/test_data.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>

namespace rgbdt::test {
namespace {

bool SameBits(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison): NaN equals itself here, -0 not 0
  return std::memcmp(a.data(), b.data(), 3 * sizeof(float)) == 0;
}

void ExpectSameVectors(const std::vector<Eigen::Vector3f>& a, const std::vector<Eigen::Vector3f>& b,
                       const char* what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_TRUE(SameBits(a[i], b[i]))
        << what << " " << i << ": " << a[i].transpose() << " and " << b[i].transpose();
  }
}

CameraSpec MakeColour() {
  CameraSpec camera;
  camera.name = "rgb";
  camera.kind = CameraKind::kColor;
  camera.width = 48;
  camera.height = 32;
  camera.format = PixelFormat::kBayerRg8;
  camera.lens = {Lens::Model::kPinhole, 40.1, 40.2, 23.3, 15.7, {-0.1, 0.02, 1e-4, -2e-4, 0.003}};
  camera.readout_s = 0.035;
  camera.camera_from_lidar_guess = MakePose(0.3, {0.01, 0.2, -0.3});
  return camera;
}

CameraSpec MakeThermal() {
  CameraSpec camera;
  camera.name = "thermal";
  camera.kind = CameraKind::kThermal;
  camera.width = 24;
  camera.height = 18;
  camera.format = PixelFormat::kMono16;
  camera.lens = {Lens::Model::kFisheye, 20.1, 20.2, 11.3, 8.7, {0.1, -0.02, 0.003, 1.0 / 3}};
  camera.radiometry.kind = Radiometry::Kind::kPlanck;
  camera.radiometry.r = 16556.5;
  camera.radiometry.b = 1428;
  camera.radiometry.f = 1;
  camera.radiometry.o = -342.5;
  camera.radiometry.emissivity = 0.95;
  camera.radiometry.reflected_temperature_k = 288.15;
  camera.netd_k = 0.05;
  return camera;
}

CameraReport MakeCameraReport(const std::string& name) {
  CameraReport camera;
  camera.calibration = {name, MakePose(0.4, {0.1, 0.2, 0.3}), std::nullopt, SolveStatus::kConverged,
                        ""};
  camera.first_guess = MakePose(0.41, {0.12, 0.2, 0.3});
  camera.used = {"0001", "0002", "0004", "0005", "0007"};
  camera.heldout = {"0003"};
  camera.rejected = {{"0006", "the board is not in view"}};
  camera.distance_transform_px = {1.25, 1.0 / 3};
  camera.edge_rms_px = {0.5, 0.625};
  camera.views = {{"0001", false, 1.5, 0.5, {}}, {"0003", true, 1.0 / 3, 0.625, {}}};
  StartResult start;
  start.start = "30 deg about x, 40 deg about z";
  start.calibration = {name, MakePose(0.5, {0, 0, 1}), std::nullopt, SolveStatus::kNotConverged,
                       "stopped"};
  start.distance_transform_px = 3.5;
  start.from_result = {5.7, 700.5};
  camera.other_starts = {start};
  camera.detect_image_s = 1.5;
  camera.detect_cloud_s = 0.25;
  camera.solve_s = 0.125;
  return camera;
}

// What a method with crossings and a covariance tells as well; no two numbers alike.
void AddUncertainty(CameraReport* camera) {
  camera->views[1].edge_rms_whitened = 1.0625;
  camera->edge_rms_whitened = {0.96875, 1.0 / 0.95};
  camera->views[1].edge_rms_mm = 1.0 / 11;
  camera->views[1].plane_rms_mm = 1.0 / 13;
  camera->edge_rms_mm = {7.5, 1.0 / 17};
  camera->plane_rms_mm = {8.5, 1.0 / 19};
  PoseSigma sigma;
  sigma.rotation_deg = {0.01, 0.02, 1.0 / 30};
  sigma.centre_mm = {0.4, 0.5, 2.0 / 3};
  sigma.colouring = {{2, 0.3, 0.7}, {5, 0.1, 0.6}, {10, 0.2, 0.61}, {50, 0.25, 2.0 / 3}};
  camera->sigma = sigma;
  camera->nuisance = {{"beam edge, no return", "mrad", {-0.21, 0.05}},
                      {"board's thickness", "mm", {1.0 / 7, 3}}};
  camera->folds = {{{"0001", "0002"}, 1.01, 1.02, 1.03, {0.004, 0.104}},
                   {{"0004"}, 0.91, 1.0 / 9, 0.93, {0.005, 0.105}}};
  camera->halves = Halves{{0.013, 1.0 / 3}, 5.25};
  camera->edges_planes = Halves{{0.017, 1.0 / 7}, 6.75, 1.5};
}

}  // namespace

Rigid3 MakePose(double angle, const Eigen::Vector3d& translation) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d(1, -2, 3).normalized()))
              .normalized(),
          translation};
}

Rig MakeRig() {
  Rig rig;
  rig.name = "test rig";
  rig.lidar.name = "scanner";
  rig.lidar.range_sigma_m = 0.0123;
  rig.lidar.turned_scanner =
      TurnedScanner{MakePose(0.01, {0.02, 0.003, -0.1}), 1400 * 180 / M_PI, -77.5, {}};
  rig.cameras = {MakeColour(), MakeThermal()};
  rig.target = {11, 8, 0.1, 1.2192, 0.9144, {0.001, -0.002}, {}};
  return rig;
}

Cloud MakeCloud() {
  Cloud cloud;
  cloud.sweep_utime = kNow;
  cloud.first_line = 3;
  cloud.lines = 4;
  cloud.beams = 5;
  for (int i = 0; i < cloud.lines * cloud.beams; ++i) {
    const Eigen::Vector3f direction =
        Eigen::Vector3f(1, 0.01f * static_cast<float>(i), -0.3f).normalized();
    cloud.directions.push_back(direction);
    cloud.points.push_back(i % 3 == 1 ? Eigen::Vector3f(kNan, kNan, kNan)
                                      : Eigen::Vector3f(direction * (2.f + 0.1f * i)));
    cloud.intensity.push_back(static_cast<float>(i) / 33.f);
    cloud.utime.push_back(kNow + 101 * i);
    cloud.ring.push_back(static_cast<std::uint16_t>(i % 5 + 65000));
  }
  for (int line = 0; line < cloud.lines; ++line) {
    cloud.origins.emplace_back(0.1f * line, 0.02f, -0.3f);
  }
  return cloud;
}

View MakeView() {
  View view;
  view.name = "0001";
  view.cloud = MakeCloud();
  Image rgb;
  rgb.camera = "rgb";
  rgb.utime = kNow + 5'000'001;
  rgb.frame_number = 17;
  rgb.device_utime = 999;
  rgb.exposure_s = 0.0125;
  rgb.format = PixelFormat::kBayerRg8;
  rgb.pixels = cv::Mat(32, 48, CV_8UC1);
  cv::randu(rgb.pixels, 0, 256);
  Image thermal;
  thermal.camera = "thermal";
  thermal.utime = kNow + 6'000'001;
  thermal.format = PixelFormat::kMono16;
  thermal.pixels = cv::Mat(18, 24, CV_16UC1);
  cv::randu(thermal.pixels, 0, 16384);
  thermal.radiometry.kind = Radiometry::Kind::kLinear;
  thermal.radiometry.gain = 0.04;
  thermal.radiometry.offset = 0.1;
  thermal.radiometry.emissivity = 0.9;
  thermal.radiometry.reflected_temperature_k = 290.25;
  view.images = {rgb, thermal};
  CornerSelection picks;
  picks.camera = "thermal";
  picks.utime = picks.image_utime = thermal.utime;
  for (std::size_t i = 0; i < 4; ++i) picks.corners[i] = {1.1 * i, 17 - i / 3.0};
  view.picks = {picks};
  return view;
}

RangeErrors MakeRangeErrors() {
  RangeErrors errors;
  errors.offset_m = {-1.0 / 30, 1.0 / 7000};
  errors.rings = {{0, {0.01 / 3, 0.001}}, {7, {-0.02 / 3, 0.002}}, {255, {0, 0}}};
  errors.intensities = {{-3.3, {0.01 / 7, 0.003}}, {-2.3, {0.02 / 7, 0.004}}};
  errors.beams_meet_m = {0.04 / 3, 0.005};
  return errors;
}

Report MakeReport() {
  Report report;
  report.method = "paper";
  report.rig_hash = "0123456789abcdef";
  report.utime = kNow;
  report.detections = {{"0001", false, {{"rgb", ""}, {"thermal", ""}}, 2, ""},
                       {"0003", true, {{"rgb", ""}, {"thermal", "no checkerboard"}}, 1, ""},
                       {"0006", false, {{"rgb", "too dark"}, {"thermal", ""}}, 0, "no plane"}};
  report.cameras = {MakeCameraReport("rgb"), MakeCameraReport("thermal")};
  Matrix6d covariance;
  for (int i = 0; i < 36; ++i) covariance(i / 6, i % 6) = 1e-8 / (i / 6 + i % 6 + 3);
  report.cameras[0].calibration.covariance = covariance;
  AddUncertainty(&report.cameras[0]);
  report.closure = {{"rgb",
                     "thermal",
                     MakePose(0.11, {0.1, 0, 0}),
                     MakePose(0.12, {0.2, 0, 0}),
                     {0.03, 1.25},
                     {0.02, 1.0 / 6},
                     7.5}};
  report.next_view = NextView{"Hold the board 6 m ahead, at the image's top left.",
                              MakePose(0.2, {6, 1.5, 1.25}), "thermal", 0.875, 1.0 / 11};
  report.cameras[1].first_guess_error = PoseError{2.5, 50.125};
  report.cameras[1].truth_error = PoseError{0.1, 1.0 / 3};
  report.cameras[1].other_starts[0].truth_error = PoseError{0.25, 3};
  return report;
}

RgbdtCloud MakeRgbdtCloud(int columns, int rows) {
  RgbdtCloud cloud;
  cloud.sweep_utime = kNow;
  cloud.sweep_end = cloud.whole_sweep = true;
  cloud.cameras = {"rgb", "thermal"};
  cloud.calibration_utime = {kNow - 2, kNow - 1};
  cloud.map_from_lidar = MakePose(0.7, {12.5, -3, 1.0 / 3});
  cloud.frame_utime = kNow + 1;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double azimuth = (static_cast<double>(column) / columns - 0.5);
      const double elevation = (static_cast<double>(row) / rows - 0.6) * 0.8;
      // A ground, a wall behind, and a board in front of it.
      const bool board = std::abs(azimuth) < 0.12 && std::abs(elevation) < 0.1;
      const double ground = elevation < 0 ? 1.2 / std::sin(-elevation) : 1e9;
      const double range = std::min(ground, (board ? 3.0 : 6.0) / std::cos(azimuth));
      const int i = row * columns + column;
      cloud.points.emplace_back(range * std::cos(elevation) * std::cos(azimuth),
                                range * std::cos(elevation) * std::sin(azimuth),
                                range * std::sin(elevation));
      cloud.intensity.push_back(board ? 0.7f : 0.25f);
      cloud.utime.push_back(kNow + i);
      const bool seen = std::abs(azimuth) < 0.35;
      const std::uint8_t light = board ? ((column / 3 + row / 3) % 2 != 0 ? 230 : 20) : 120;
      cloud.rgb.push_back(seen ? std::array<std::uint8_t, 3>{light, light, 90}
                               : std::array<std::uint8_t, 3>{0, 0, 0});
      const bool warm = seen && std::abs(azimuth) < 0.25;
      cloud.temperature_k.push_back(warm ? (board ? 305.f : 290.f + 5.f * row / rows) : kNan);
      cloud.temperature_sigma_k.push_back(warm ? 0.5f + 0.001f * i : kNan);
      cloud.thermal_counts.push_back(warm ? 7000.f + i : kNan);
      cloud.valid.push_back((seen ? 1u : 0u) | (warm ? 2u : 0u));
    }
  }
  return cloud;
}

MapCloud MakeMap() {
  MapCloud map;
  map.voxel_m = 0.1;
  map.points = {{1.25F, -2.5F, 0.1F}, {1e4F, 0, -3}};
  map.rgb = {{{1, 128, 255}, {0, 0, 0}}};
  map.temperature_k = {300.25F, kNan};
  map.count = {7, 4'000'000'000U};
  map.last_seen = {kNow, kNow + 1};
  return map;
}

void ExpectSame(const Rigid3& a, const Rigid3& b) {
  EXPECT_EQ(a.rotation.coeffs(), b.rotation.coeffs());
  EXPECT_EQ(a.translation, b.translation);
}

void ExpectSame(const Cloud& a, const Cloud& b) {
  EXPECT_EQ(a.sweep_utime, b.sweep_utime);
  EXPECT_EQ(a.first_line, b.first_line);
  EXPECT_EQ(a.lines, b.lines);
  EXPECT_EQ(a.beams, b.beams);
  EXPECT_EQ(a.organised, b.organised);
  ExpectSameVectors(a.points, b.points, "points");
  ExpectSameVectors(a.directions, b.directions, "directions");
  ExpectSameVectors(a.origins, b.origins, "origins");
  EXPECT_EQ(a.intensity, b.intensity);
  EXPECT_EQ(a.utime, b.utime);
  EXPECT_EQ(a.ring, b.ring);
}

}  // namespace rgbdt::test
