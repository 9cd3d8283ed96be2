#include "calib/model/rig.h"

#include <functional>
#include <limits>

#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

using testing::HasSubstr;

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Rig GoodRig() {
  Rig rig;
  rig.name = "test";
  CameraSpec camera;
  camera.name = "rgb";
  camera.width = 640;
  camera.height = 480;
  camera.lens.fx = camera.lens.fy = 500;
  camera.camera_from_lidar_guess = Rigid3();
  rig.cameras.push_back(camera);
  camera.name = "thermal";
  camera.kind = CameraKind::kThermal;
  camera.format = PixelFormat::kMono16;
  rig.cameras.push_back(camera);
  rig.lidar.turned_scanner = TurnedScanner{{}, 80000, 0, {}};
  rig.target = {11, 8, 0.1, 1.22, 0.91, {0, 0}, {}};
  return rig;
}

struct Bad {
  std::string name;
  std::string field;  // as the message must name it
  std::string value;
  std::function<void(Rig*)> spoil;
};

void PrintTo(const Bad& bad, std::ostream* out) { *out << bad.name; }

class RigCheck : public testing::TestWithParam<Bad> {};

TEST_P(RigCheck, NamesTheFieldAndItsValue) {
  Rig rig = GoodRig();
  GetParam().spoil(&rig);
  const std::string message = InputErrorOf([&] { rig.Check(); });
  EXPECT_THAT(message, HasSubstr(GetParam().field));
  EXPECT_THAT(message, HasSubstr(GetParam().value));
  EXPECT_THAT(message, HasSubstr("expected"));
}

INSTANTIATE_TEST_SUITE_P(
    Fields, RigCheck,
    testing::Values(
        Bad{"no_camera", "number of cameras", "0", [](Rig* r) { r->cameras.clear(); }},
        Bad{"too_many_cameras", "number of cameras", "33",
            [](Rig* r) { r->cameras.resize(33, r->cameras[0]); }},
        Bad{"empty_name", "camera.name", "\"\"", [](Rig* r) { r->cameras[0].name = ""; }},
        Bad{"upper_case", "camera.name", "\"Rgb\"", [](Rig* r) { r->cameras[0].name = "Rgb"; }},
        Bad{"name_twice", "camera.name", "\"rgb\" twice",
            [](Rig* r) { r->cameras[1].name = "rgb"; }},
        Bad{"width", "camera \"rgb\": width", "-1", [](Rig* r) { r->cameras[0].width = -1; }},
        Bad{"height", "camera \"thermal\": height", "20001",
            [](Rig* r) { r->cameras[1].height = 20001; }},
        Bad{"fx", "lens.fx", "0.0", [](Rig* r) { r->cameras[0].lens.fx = 0; }},
        Bad{"fy", "lens.fy", "-500", [](Rig* r) { r->cameras[0].lens.fy = -500; }},
        Bad{"cx", "lens.cx", "nan", [](Rig* r) { r->cameras[0].lens.cx = kNotANumber; }},
        Bad{"cy", "lens.cy", "inf", [](Rig* r) { r->cameras[0].lens.cy = kInfinity; }},
        Bad{"distortion", "lens.distortion", "nan",
            [](Rig* r) { r->cameras[0].lens.distortion[7] = kNotANumber; }},
        Bad{"readout_negative", "readout_s", "-0.1",
            [](Rig* r) { r->cameras[0].readout_s = -0.1; }},
        Bad{"readout_infinite", "readout_s", "inf",
            [](Rig* r) { r->cameras[0].readout_s = kInfinity; }},
        Bad{"emissivity_zero", "radiometry.emissivity", "0.0",
            [](Rig* r) { r->cameras[1].radiometry.emissivity = 0; }},
        Bad{"emissivity_percent", "radiometry.emissivity", "95",
            [](Rig* r) { r->cameras[1].radiometry.emissivity = 95; }},
        Bad{"guess", "camera_from_lidar_guess", "not a pose",
            [](Rig* r) { r->cameras[0].camera_from_lidar_guess->translation.x() = kNotANumber; }},
        Bad{"guess_quaternion", "camera_from_lidar_guess", "not a pose",
            [](Rig* r) { r->cameras[0].camera_from_lidar_guess->rotation.coeffs().setZero(); }},
        Bad{"color_16_bit", "pixel format", "MONO16",
            [](Rig* r) { r->cameras[0].format = PixelFormat::kMono16; }},
        Bad{"ticks", "ticks_per_degree", "0.0",
            [](Rig* r) { r->lidar.turned_scanner->ticks_per_rad = 0; }},
        Bad{"zero_ticks", "zero_ticks", "nan",
            [](Rig* r) { r->lidar.turned_scanner->zero_ticks = kNotANumber; }},
        Bad{"encoder_delay", "encoder_delay_s", "200.0",
            [](Rig* r) { r->lidar.turned_scanner->encoder_delay_s = 200; }},
        Bad{"motor_from_scanner", "motor_from_scanner", "not a pose",
            [](Rig* r) {
              r->lidar.turned_scanner->motor_from_scanner.translation.z() = kNotANumber;
            }},
        Bad{"range_sigma", "lidar.range_sigma_m", "0.0",
            [](Rig* r) { r->lidar.range_sigma_m = 0; }},
        Bad{"squares_x", "target.squares_x", "2", [](Rig* r) { r->target.squares_x = 2; }},
        Bad{"squares_y", "target.squares_y", "101", [](Rig* r) { r->target.squares_y = 101; }},
        Bad{"square", "target.square_m", "-0.1", [](Rig* r) { r->target.square_m = -0.1; }},
        Bad{"board_width", "target.width_m", "nan",
            [](Rig* r) { r->target.width_m = kNotANumber; }},
        Bad{"board_height", "target.height_m", "0.0", [](Rig* r) { r->target.height_m = 0; }},
        Bad{"pattern_wider_than_board", "target.width_m", "squares_x, squares_y",
            [](Rig* r) { r->target.width_m = 1.09; }},
        Bad{"pattern_off_the_board", "target.height_m", "0.91",
            [](Rig* r) { r->target.pattern_offset_m.y() = 0.06; }},
        Bad{"square_in_millimetres", "target.square_m is 100", "these are millimetres: 0.1",
            [](Rig* r) { r->target.square_m = 100; }},
        Bad{"board_in_millimetres", "target.width_m is 1219.2", "1.2192",
            [](Rig* r) { r->target.width_m = 1219.2; }},
        Bad{"guess_in_millimetres", "camera_from_lidar_guess.translation_m is -120", "-0.12",
            [](Rig* r) { r->cameras[0].camera_from_lidar_guess->translation.x() = -120; }},
        Bad{"range_sigma_in_millimetres", "lidar.range_sigma_m is 10", "0.01",
            [](Rig* r) { r->lidar.range_sigma_m = 10; }},
        Bad{"pattern_offset", "target.pattern_offset_m", "nan",
            [](Rig* r) { r->target.pattern_offset_m.x() = kNotANumber; }}),
    [](const testing::TestParamInfo<Bad>& info) { return info.param.name; });

TEST(Rig, AGoodOnePasses) {
  EXPECT_EQ(InputErrorOf([] { GoodRig().Check(); }), "");
}

TEST(Rig, CameraIsFoundByName) {
  const Rig rig = GoodRig();
  EXPECT_EQ(&rig.Camera("thermal"), &rig.cameras[1]);
}

TEST(Rig, AnUnknownCameraIsAnErrorThatSaysWhichThereAre) {
  const std::string message = InputErrorOf([] { GoodRig().Camera("lwir"); });
  EXPECT_THAT(message, HasSubstr("\"lwir\""));
  EXPECT_THAT(message, HasSubstr("rgb, thermal"));
}

TEST(Target, InnerCornersLieRowByRowFromTheTopLeft) {
  const Target target{4, 3, 0.1, 0.5, 0.4, {0.02, -0.01}, {}};
  const auto corners = target.InnerCorners();
  ASSERT_EQ(corners.size(), 6U);  // 3 x 2
  // Symmetric about the pattern's centre: x at -1, 0, 1 squares, y at -1/2, 1/2.
  EXPECT_THAT(corners[0], EigenNear(Eigen::Vector3d(0.02 - 0.1, -0.01 - 0.05, 0), 1e-15));
  EXPECT_THAT(corners[1], EigenNear(Eigen::Vector3d(0.02, -0.01 - 0.05, 0), 1e-15));
  EXPECT_THAT(corners[3], EigenNear(Eigen::Vector3d(0.02 - 0.1, -0.01 + 0.05, 0), 1e-15));
  EXPECT_THAT(corners[5], EigenNear(Eigen::Vector3d(0.02 + 0.1, -0.01 + 0.05, 0), 1e-15));
}

TEST(Target, OutlineGoesRoundFromTheTopLeftAndIgnoresThePatternsOffset) {
  const Target target{4, 3, 0.1, 0.5, 0.4, {0.02, -0.01}, {}};
  const auto corners = target.OutlineCorners();
  EXPECT_EQ(corners[0], Eigen::Vector3d(-0.25, -0.2, 0));
  EXPECT_EQ(corners[1], Eigen::Vector3d(0.25, -0.2, 0));
  EXPECT_EQ(corners[2], Eigen::Vector3d(0.25, 0.2, 0));
  EXPECT_EQ(corners[3], Eigen::Vector3d(-0.25, 0.2, 0));
}

}  // namespace
}  // namespace rgbdt
