#include "calib/files/schema/rig_file.h"

#include <cmath>

#include "calib/files/atomic_file.h"
#include "calib/model/beam_priors.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;
using ::testing::UnorderedElementsAre;

// `text` with the first `from` replaced.
std::string With(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

const char kRig[] = R"(name: "small"
lidar { name: "lidar" }
camera {
  name: "rgb"
  kind: COLOR
  width: 640
  height: 480
  pixel_format: BGR8
  pinhole { fx: 500 fy: 501 cx: 320 cy: 240 distortion: [0.1, 0.2, 0.3, 0.4] }
  camera_from_lidar_guess {
    roll_pitch_yaw_deg: [-90, 0, -90]
    translation_m: [1, 2, 3]
  }
}
target { squares_x: 11 squares_y: 8 square_m: 0.1 width_m: 1.2192 height_m: 0.9144 }
)";

std::string ErrorOfRig(const std::string& from, const std::string& to) {
  return test::ErrorOf([&] { ParseRig(With(kRig, from, to), "rig.textproto"); });
}

const char kTarget[] =
    "target { squares_x: 11 squares_y: 8 square_m: 0.1 width_m: 1.2192 height_m: 0.9144 }";

TEST(RigFile, BoardsWithMarkersAreReadAndWritten) {
  const auto round = [](const std::string& target) {
    const Rig rig = ParseRig(With(kRig, kTarget, target), "rig.textproto");
    return ParseRig(PrintRig(rig), "again").target;
  };
  const Target charuco = round(
      "target { charuco { squares_x: 11 squares_y: 8 square_m: 0.1 marker_m: 0.075 "
      "dictionary: \"DICT_5X5_100\" legacy: true } width_m: 1.2192 height_m: 0.9144 "
      "pattern_offset_m: [0.01, 0] }");
  ASSERT_TRUE(charuco.markers.has_value());
  EXPECT_EQ(charuco.squares_x, 11);
  EXPECT_EQ(charuco.markers->side_m, 0.075);
  EXPECT_TRUE(charuco.markers->legacy);
  EXPECT_FALSE(charuco.markers->grid());
  EXPECT_EQ(charuco.MarkerPlaces().size(), 44U);
  EXPECT_EQ(charuco.pattern_offset_m.x(), 0.01);
  const Target grid = round(
      "target { aprilgrid { tags_x: 7 tags_y: 5 tag_m: 0.13 spacing: 0.25 } "
      "width_m: 1.2192 height_m: 0.9144 }");
  ASSERT_TRUE(grid.markers.has_value());
  EXPECT_EQ(grid.squares_x, 15);
  EXPECT_EQ(grid.squares_y, 11);
  EXPECT_EQ(grid.markers->family, "APRILTAG_36h11");
  EXPECT_EQ(grid.markers->border_bits, kKalibrBorderBits);
  EXPECT_DOUBLE_EQ(grid.markers->gap_m, 0.0325);
}

TEST(RigFile, HostsAreReadAndWritten) {
  const std::string hosts =
      "host { name: \"sensor\" runs: [\"lidar\", \"camera-rgb\"] }\nhost { name: \"desk\" }\n";
  const Rig rig = ParseRig(PrintRig(ParseRig(kRig + hosts, "rig.textproto")), "again");
  ASSERT_EQ(rig.hosts.size(), 2U);
  EXPECT_EQ(rig.hosts[0].name, "sensor");
  EXPECT_EQ(rig.hosts[0].runs, std::vector<std::string>({"lidar", "camera-rgb"}));
  EXPECT_TRUE(rig.hosts[1].runs.empty());
  EXPECT_THAT(DifferencesOf(rig, ParseRig(kRig, "rig.textproto")), testing::IsEmpty())
      << "a calibration holds whichever machine runs what";
  const auto error = [&](const std::string& more) {
    return test::ErrorOf([&] { ParseRig(kRig + hosts + more, "rig.textproto"); });
  };
  EXPECT_THAT(error("host { name: \"sensor\" }"), HasSubstr("a name of its own"));
  EXPECT_THAT(error("host { name: \"third\" runs: \"lidar\" }"), HasSubstr("on one machine"));
}

TEST(RigFile, ABoardWithHolesHasTheUsualSizesUnlessTheyAreStated) {
  const auto round = [](const std::string& holes) {
    const Rig rig = ParseRig(With(kRig, kTarget, "target { holes { " + holes), "rig.textproto");
    return ParseRig(PrintRig(rig), "again").target;
  };
  const Target usual = round("marker_m: 0.16 } }");
  ASSERT_TRUE(usual.holes.has_value());
  EXPECT_EQ(usual.width_m, 1.4);
  EXPECT_EQ(usual.height_m, 1.0);
  EXPECT_EQ(usual.markers->family, "6X6_250");
  EXPECT_EQ(usual.HoleCentres().at(0), Eigen::Vector2d(-0.25, -0.2));
  const Target own = round(
      "marker_m: 0.1 dictionary: \"4X4_50\" first_marker: 5 hole_radius_m: 0.1 "
      "hole_spacing_x_m: 0.4 hole_spacing_y_m: 0.3 marker_spacing_x_m: 0.8 "
      "marker_spacing_y_m: 0.5 } width_m: 1 height_m: 0.7 print_sigma: 0.001 }");
  EXPECT_EQ(own.width_m, 1);
  EXPECT_EQ(own.holes->radius_m, 0.1);
  EXPECT_EQ(own.holes->spacing_m, Eigen::Vector2d(0.4, 0.3));
  EXPECT_EQ(own.holes->marker_spacing_m, Eigen::Vector2d(0.8, 0.5));
  EXPECT_EQ(own.MarkerPlaces().at(0).id, 5);
  EXPECT_EQ(own.print_sigma, 0.001);
}

TEST(RigFile, BoardsWithHolesThatCannotBeAreRefused) {
  const auto holes = [](const std::string& fields) {
    return ErrorOfRig(kTarget, "target { holes { " + fields + " } }");
  };
  EXPECT_THAT(holes(""), HasSubstr("target.holes.marker_m is 0"));
  EXPECT_THAT(holes("marker_m: 0.16 hole_spacing_x_m: 0.2"), HasSubstr("from centre to centre"));
  EXPECT_THAT(holes("marker_m: 0.16 hole_spacing_y_m: 0.8"), HasSubstr("holes inside the board"));
  EXPECT_THAT(holes("marker_m: 0.16 marker_spacing_x_m: 0.6 marker_spacing_y_m: 0.45"),
              HasSubstr("holes that touch no marker"));
  EXPECT_THAT(holes("marker_m: 0.16 first_marker: 247"), HasSubstr("249 at most"));
  EXPECT_THAT(holes("marker_m: 0.16 marker_spacing_x_m: 1.3"), HasSubstr("1 cm inside the board"));
  EXPECT_THAT(holes("marker_m: 0.16 marker_spacing_x_m: 0.1"), HasSubstr("a quarter of one"));
  EXPECT_THAT(ErrorOfRig(kTarget, "target { holes { marker_m: 0.16 } height_m: 1.4 }"),
              HasSubstr("a quarter turn is not told"));
  EXPECT_THAT(
      ErrorOfRig(kTarget, "target { holes { marker_m: 0.16 } pattern_offset_m: [0.01, 0] }"),
      HasSubstr("about the board's centre"));
}

TEST(RigFile, BoardsWithMarkersThatCannotBeAreRefused) {
  EXPECT_THAT(
      ErrorOfRig("target { squares_x: 11", "target { charuco { squares_x: 3 } squares_x: 11"),
      HasSubstr("expected one board"));
  const auto charuco = [](const std::string& rest) {
    return ErrorOfRig(kTarget, "target { charuco { squares_x: 11 squares_y: 8 square_m: 0.1 " +
                                   rest + " } width_m: 1.2192 height_m: 0.9144 }");
  };
  EXPECT_THAT(charuco("marker_m: 0.075"), HasSubstr("dictionary"));
  EXPECT_THAT(charuco("marker_m: 0.075 dictionary: \"9X9\""), HasSubstr("one of 4X4_50"));
  EXPECT_THAT(charuco("marker_m: 0.1 dictionary: \"5X5_100\""), HasSubstr("less than square_m"));
  EXPECT_THAT(ErrorOfRig(kTarget,
                         "target { aprilgrid { tags_x: 7 tags_y: 5 tag_m: 0.13 } "
                         "width_m: 1.2192 height_m: 0.9144 }"),
              HasSubstr("spacing"));
}

TEST(RigFile, ALensMayStateHowWellItIsKnown) {
  const auto with = [](const std::string& uncertainty) {
    return With(kRig, "  camera_from_lidar_guess", uncertainty + "\n  camera_from_lidar_guess");
  };
  const auto parse = [&](const std::string& uncertainty) {
    return ParseRig(with(uncertainty), "rig.textproto").cameras.at(0);
  };
  EXPECT_FALSE(parse("").lens_uncertainty);
  EXPECT_TRUE(parse("lens_uncertainty { exact: true }").lens_uncertainty->exact());
  const LensCovariance four =
      parse("lens_uncertainty { sigma: [2, 2, 3, 4] }").lens_uncertainty->covariance;
  EXPECT_EQ(four(3, 3), 16);
  EXPECT_GT(four(4, 4), 0) << "the distortion as is usual";
  EXPECT_EQ(four(0, 1), 0);
  const LensCovariance nine = parse("lens_uncertainty { sigma: [2, 2, 3, 4, 0.1, 0, 0, 0, 0] }")
                                  .lens_uncertainty->covariance;
  EXPECT_EQ(nine(4, 4), 0.1 * 0.1);
  EXPECT_EQ(nine(5, 5), 0);
  const auto error = [&](const std::string& uncertainty) {
    return test::ErrorOf([&] { parse(uncertainty); });
  };
  EXPECT_THAT(error("lens_uncertainty { sigma: [2, 2, 3] }"),
              AllOf(HasSubstr("lens_uncertainty.sigma has 3 numbers"), HasSubstr("fx fy cx cy")));
  EXPECT_THAT(error("lens_uncertainty { sigma: [2, 2, 3, -1] }"), HasSubstr("below 0"));
  EXPECT_THAT(error("lens_uncertainty { }"), HasSubstr("one of them"));
  EXPECT_THAT(error("lens_uncertainty { exact: true sigma: [1, 1, 1, 1] }"), HasSubstr("one of"));
  EXPECT_THAT(error("lens_uncertainty { covariance: [1, 2] }"), HasSubstr("covariance has 2"));
  EXPECT_THAT(error("lens_uncertainty { sigma: [1, 1, 1, 1] made_from: [1, 2, 3] }"),
              HasSubstr("made_from has 3"));
}

TEST(RigFile, GivesBackHowWellALensIsKnown) {
  Rig rig = test::MakeRig();
  for (CameraSpec& camera : rig.cameras) {
    LensUncertainty& stated = camera.lens_uncertainty.emplace();
    const auto count = static_cast<Eigen::Index>(NamesOfNumbers(camera.lens.model).size());
    stated.covariance.topLeftCorner(count, count).setConstant(0.01);
    stated.covariance.diagonal().head(count).array() += 0.25;
    stated.made_from = {{1.5, 2.5}, {100.25, 7}};
  }
  const Rig back = ParseRig(PrintRig(rig), "printed");
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    ASSERT_TRUE(back.cameras[c].lens_uncertainty);
    EXPECT_EQ(back.cameras[c].lens_uncertainty->covariance,
              rig.cameras[c].lens_uncertainty->covariance);
    EXPECT_EQ(back.cameras[c].lens_uncertainty->made_from,
              rig.cameras[c].lens_uncertainty->made_from);
  }
  rig.cameras[0].lens_uncertainty = LensUncertainty();
  EXPECT_TRUE(ParseRig(PrintRig(rig), "printed").cameras[0].lens_uncertainty->exact());
  rig.cameras[0].lens_uncertainty->covariance(0, 0) = -1;
  EXPECT_THAT(test::ErrorOf([&] { rig.Check(); }), HasSubstr("lens_uncertainty"));
}

TEST(RigFile, GivesBackEveryFieldBitForBit) {
  Rig rig = test::MakeRig();
  rig.lidar.turned_scanner->encoder_delay_s = 0.0123;
  const Rig back = ParseRig(PrintRig(rig), "printed");
  EXPECT_EQ(back.name, rig.name);
  EXPECT_EQ(back.lidar.name, rig.lidar.name);
  EXPECT_EQ(back.lidar.range_sigma_m, rig.lidar.range_sigma_m);
  EXPECT_EQ(back.lidar.range_offset_sigma_m, rig.lidar.range_offset_sigma_m);
  ASSERT_TRUE(back.lidar.turned_scanner);
  test::ExpectSame(back.lidar.turned_scanner->motor_from_scanner,
                   rig.lidar.turned_scanner->motor_from_scanner);
  EXPECT_EQ(back.lidar.turned_scanner->ticks_per_rad, rig.lidar.turned_scanner->ticks_per_rad);
  EXPECT_EQ(back.lidar.turned_scanner->zero_ticks, rig.lidar.turned_scanner->zero_ticks);
  EXPECT_EQ(back.lidar.turned_scanner->encoder_delay_s, 0.0123);
  ASSERT_EQ(back.cameras.size(), rig.cameras.size());
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
    const CameraSpec& a = rig.cameras[i];
    const CameraSpec& b = back.cameras[i];
    EXPECT_EQ(b.name, a.name);
    EXPECT_EQ(b.kind, a.kind);
    EXPECT_EQ(b.width, a.width);
    EXPECT_EQ(b.height, a.height);
    EXPECT_EQ(b.format, a.format);
    EXPECT_EQ(b.lens.model, a.lens.model);
    EXPECT_EQ(b.lens.fx, a.lens.fx);
    EXPECT_EQ(b.lens.cy, a.lens.cy);
    EXPECT_EQ(b.lens.distortion, a.lens.distortion);
    EXPECT_EQ(b.radiometry.kind, a.radiometry.kind);
    EXPECT_EQ(b.radiometry.r, a.radiometry.r);
    EXPECT_EQ(b.radiometry.o, a.radiometry.o);
    EXPECT_EQ(b.radiometry.emissivity, a.radiometry.emissivity);
    EXPECT_EQ(b.radiometry.reflected_temperature_k, a.radiometry.reflected_temperature_k);
    EXPECT_EQ(b.readout_s, a.readout_s);
    EXPECT_EQ(b.netd_k, a.netd_k);
    ASSERT_EQ(b.camera_from_lidar_guess.has_value(), a.camera_from_lidar_guess.has_value());
    if (a.camera_from_lidar_guess) {
      test::ExpectSame(*b.camera_from_lidar_guess, *a.camera_from_lidar_guess);
    }
  }
  EXPECT_EQ(back.target.squares_x, rig.target.squares_x);
  EXPECT_EQ(back.target.square_m, rig.target.square_m);
  EXPECT_EQ(back.target.height_m, rig.target.height_m);
  EXPECT_EQ(back.target.pattern_offset_m, rig.target.pattern_offset_m);
  EXPECT_EQ(PrintRig(back), PrintRig(rig));
  EXPECT_THAT(PrintRig(rig), HasSubstr("ticks_per_degree: 1400\n"));
  rig.lidar.turned_scanner->ticks_per_rad = 1e-310;  // what std::stod throws for
  EXPECT_NO_THROW(PrintRig(rig));
}

TEST(RigFile, HowFarTheMonitorIsFollowed) {
  Rig rig = test::MakeRig();
  EXPECT_EQ(PrintRig(rig).find("follow"), std::string::npos) << "as usual";
  rig.cameras[0].follow = {0.0125, 0.25};
  const Rig back = ParseRig(PrintRig(rig), "printed");
  EXPECT_DOUBLE_EQ(back.cameras[0].follow.rotation_rad, 0.0125);
  EXPECT_DOUBLE_EQ(back.cameras[0].follow.translation_m, 0.25);
  EXPECT_DOUBLE_EQ(back.cameras[1].follow.translation_m, FollowLimits().translation_m);
  EXPECT_THAT(DifferencesOf(test::MakeRig(), rig), IsEmpty()) << "no calibration depends on it";
  rig.cameras[0].follow.rotation_rad = -1;
  EXPECT_THROW(rig.Check(), InputError);
}

TEST(RigFile, InOneLineAreTheFirstDifferences) {
  EXPECT_EQ(InOneLine({}), "");
  EXPECT_EQ(InOneLine({"fx: 1 -> 2", "fy: 1 -> 2"}), "fx: 1 -> 2; fy: 1 -> 2");
  EXPECT_EQ(InOneLine({"a", "b", "c", "d", "e", "f", "g"}), "a; b; c; d; e; and 2 more");
  EXPECT_LT(InOneLine({std::string(5000, 'x')}).size(), 200U);
}

TEST(RigFile, WhatDiffersBetweenTwoRigsIsNamed) {
  const Rig rig = test::MakeRig();
  Rig other = rig;
  EXPECT_THAT(DifferencesOf(rig, other), IsEmpty());
  // What no calibration depends on.
  other.name = "another name";
  other.lidar.name = "another LIDAR";
  other.lidar.device = PcdFolderDevice{};
  for (CameraSpec& camera : other.cameras) {
    camera.camera_from_lidar_guess.reset();
    camera.device.reset();
    camera.radiometry.emissivity = 0.9;
    camera.radiometry.reflected_temperature_k = 275;
  }
  std::reverse(other.cameras.begin(), other.cameras.end());
  EXPECT_THAT(DifferencesOf(rig, other), IsEmpty());
  other.cameras.back().lens.fx += 10;
  other.target.square_m *= 2;
  EXPECT_THAT(DifferencesOf(rig, other),
              UnorderedElementsAre(HasSubstr(".fx: "), HasSubstr("target.square_m: ")));
  other = rig;
  other.cameras.pop_back();
  EXPECT_THAT(DifferencesOf(rig, other), ElementsAre(HasSubstr("camera")));
}

TEST(RigFile, AnotherModelOfLidarIsAnotherLidar) {
  Rig rig = test::MakeRig();
  rig.lidar.device = VelodyneDevice{VelodyneDevice::Model::kVlp16, 2368, ""};
  Rig other = rig;
  other.lidar.device = VelodyneDevice{VelodyneDevice::Model::kVlp16, 2369, "recorded.pcap"};
  EXPECT_THAT(DifferencesOf(rig, other), IsEmpty());
  other.lidar.device = VelodyneDevice{VelodyneDevice::Model::kVlp32c, 2368, ""};
  EXPECT_THAT(DifferencesOf(rig, other),
              ElementsAre("modified: lidar.velodyne.model: VLP16 -> VLP32C"));
  other.lidar.device = PcdFolderDevice{};  // of whichever LIDAR
  EXPECT_THAT(DifferencesOf(rig, other), IsEmpty());
  const PacketLidarDevice ouster{PacketLidarDevice::Make::kOuster, "os1.json", 7502, ""};
  other.lidar.device = ouster;
  EXPECT_THAT(DifferencesOf(rig, other), Not(IsEmpty()));
  rig.lidar.device = ouster;
  other.lidar.device =
      PacketLidarDevice{PacketLidarDevice::Make::kOuster, "elsewhere/os1.json", 7503, "a.pcap"};
  EXPECT_THAT(DifferencesOf(rig, other), IsEmpty());
}

TEST(RigFile, KeepsTextAndHash) {
  const Rig rig = ParseRig(kRig, "rig.textproto");
  EXPECT_EQ(rig.text, kRig);
  EXPECT_EQ(rig.hash, HashOfRigText(kRig));
  EXPECT_EQ(rig.hash.size(), 16u);
  EXPECT_NE(rig.hash, HashOfRigText(std::string(kRig) + " "));
  EXPECT_EQ(HashOfRigText(""), "cbf29ce484222325");  // the published values of FNV-1a
  EXPECT_EQ(HashOfRigText("foobar"), "85944171f73967e8");
}

TEST(RigFile, RollPitchYawTurnsTheLidarsAxesIntoTheCameras) {
  const Rigid3 guess = *ParseRig(kRig, "").cameras[0].camera_from_lidar_guess;
  // Rz(-90) * Ry(0) * Rx(-90): LIDAR's x (1, 0, 0) -> (0, -1, 0), z (0, 0, 1) -> (1, 0, 0).
  EXPECT_LT((guess.rotation * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(0, -1, 0)).norm(), 1e-12);
  EXPECT_LT((guess.rotation * Eigen::Vector3d(0, 0, 1) - Eigen::Vector3d(1, 0, 0)).norm(), 1e-12);
  EXPECT_EQ(guess.translation, Eigen::Vector3d(1, 2, 3));
}

TEST(RigFile, DefaultsAreFilledIn) {
  const Rig rig = ParseRig(kRig, "");
  EXPECT_EQ(rig.lidar.range_sigma_m, 0.01);
  EXPECT_EQ(rig.lidar.range_offset_sigma_m, kUsualRangeOffsetSigmaM);
  EXPECT_FALSE(rig.lidar.turned_scanner);
  EXPECT_EQ(rig.cameras[0].radiometry.emissivity, 1);
  EXPECT_EQ(rig.cameras[0].lens.distortion[3], 0.4);
  EXPECT_EQ(rig.cameras[0].lens.distortion[4], 0);
}

TEST(RigFile, ExactRangesMayBeStated) {
  const std::string exact = "lidar { name: \"lidar\" range_offset_sigma_m: 0 }";
  std::string text(kRig);
  const std::string plain = "lidar { name: \"lidar\" }";
  text.replace(text.find(plain), plain.size(), exact);
  EXPECT_EQ(ParseRig(text, "").lidar.range_offset_sigma_m, 0);
  EXPECT_THAT(ErrorOfRig(plain, "lidar { name: \"lidar\" range_offset_sigma_m: -1 }"),
              HasSubstr("lidar.range_offset_sigma_m"));
}

TEST(RigFile, AnUnknownKeyIsNamedWithFileLineAndColumn) {
  const std::string error = ErrorOfRig("height: 480", "hieght: 480");
  EXPECT_THAT(error, StartsWith("rig.textproto:7:3: "));
  EXPECT_THAT(error,
              HasSubstr("unknown key \"hieght\"; expected one of: name, kind, width, height, "));
  EXPECT_THAT(ErrorOfRig("COLOR", "COLOUR"), StartsWith("rig.textproto:5:"));
  EXPECT_THAT(ErrorOfRig("width: 640", "width: 640 px"), StartsWith("rig.textproto:6:"));
}

TEST(RigFile, WrongValuesAreNamedWithLineAndKey) {
  const auto expect = [](const std::string& from, const std::string& to, const std::string& start,
                         const std::string& part) {
    const std::string error = ErrorOfRig(from, to);
    EXPECT_THAT(error, StartsWith("rig.textproto:" + start));
    EXPECT_THAT(error, HasSubstr(part));
  };
  expect("0.3, 0.4]", "0.3]", "9: camera.pinhole.distortion has 3", "0, 4, 5, 8");
  expect("[1, 2, 3]", "[1, 2]", "12: camera.camera_from_lidar_guess.translation_m", "expected 3");
  expect("[1, 2, 3]", "[1, 2, nan]", "12: ", "finite");
  expect("roll_pitch_yaw_deg: [-90, 0, -90]", "quaternion_wxyz: [1, 0, 0, 0.1]",
         "11: camera.camera_from_lidar_guess.quaternion_wxyz", "norm");
  expect("roll_pitch_yaw_deg: [-90, 0, -90]", "quaternion_wxyz: [1, 0, 0]",
         "11: camera.camera_from_lidar_guess.quaternion_wxyz has 3", "expected 4");
  expect("translation_m", "quaternion_wxyz: [1, 0, 0, 0] translation_m", "11: ", "one of the two");
  expect("roll_pitch_yaw_deg: [-90, 0, -90]", "", "10: ", "roll_pitch_yaw_deg");
  expect("kind: COLOR", "", "3: camera.kind", "COLOR or THERMAL");
  expect("pixel_format: BGR8", "", "3: camera.pixel_format", "missing");
  // Protobuf takes any number for a name.
  expect("kind: COLOR", "kind: 9", "5: camera.kind is 9", "expected one of: COLOR, THERMAL");
  expect("pixel_format: BGR8", "pixel_format: 77", "8: camera.pixel_format is 77", "BGR8");
  expect("{ name: \"lidar\" }", "{ name: \"lidar\" velodyne { model: 99 } }",
         "2: lidar.velodyne.model is 99", "VLP16");
}

TEST(RigFile, WhatIsMissingIsNamed) {
  EXPECT_THAT(ErrorOfRig("lidar { name: \"lidar\" }", ""), HasSubstr("lidar is missing"));
  EXPECT_THAT(ErrorOfRig("kind: COLOR", "kind: THERMAL"), HasSubstr("one channel"));
  const std::string text(kRig);
  const std::size_t at = text.find("target");
  EXPECT_THAT(test::ErrorOf([&] { ParseRig(text.substr(0, at), "rig.textproto"); }),
              HasSubstr("target is missing"));
  const std::size_t lens = text.find("  pinhole");
  std::string no_lens = text;
  no_lens.erase(lens, text.find('\n', lens) - lens);
  EXPECT_THAT(test::ErrorOf([&] { ParseRig(no_lens, "rig.textproto"); }),
              HasSubstr("pinhole { ... } or fisheye { ... }"));
  // What Rig::Check finds carries the file's name as well.
  EXPECT_THAT(ErrorOfRig("width: 640", ""), StartsWith("rig.textproto: rig: "));
}

TEST(RigFile, ALensMayBeUnknownWhereItIsStillToBeFound) {
  const std::string lens =
      "pinhole { fx: 500 fy: 501 cx: 320 cy: 240 distortion: [0.1, 0.2, 0.3, 0.4] }";
  for (const char* unknown : {"", "pinhole {}", "fisheye {}", "pinhole { cx: 320 cy: 240 }"}) {
    const std::string text = With(kRig, lens, unknown);
    const std::string error = test::ErrorOf([&] { ParseRig(text, "rig.textproto"); });
    EXPECT_THAT(error, HasSubstr("camera \"rgb\" has no lens"));
    EXPECT_THAT(error, HasSubstr("rgbdt intrinsics DIR"));
    const Rig rig = ParseRig(text, "rig.textproto", LensNeed::kMayBeUnknown);
    EXPECT_FALSE(rig.cameras[0].lens.known());
    // Printed and read again it is the same: not known, of the same model.
    const Rig back = ParseRig(PrintRig(rig), "", LensNeed::kMayBeUnknown);
    EXPECT_FALSE(back.cameras[0].lens.known());
    EXPECT_EQ(back.cameras[0].lens.model, rig.cameras[0].lens.model);
  }
  // A lens that is there has to make sense all the same.
  EXPECT_THAT(test::ErrorOf([&] {
                ParseRig(With(kRig, "fy: 501", ""), "rig.textproto", LensNeed::kMayBeUnknown);
              }),
              HasSubstr("lens.fy"));
}

TEST(RigFile, AQuaternionThatIsRoundedIsNormalised) {
  const Rig rig = ParseRig(
      With(kRig, "roll_pitch_yaw_deg: [-90, 0, -90]", "quaternion_wxyz: [0.5, 0.5, 0.5, 0.5005]"),
      "");
  EXPECT_NEAR(rig.cameras[0].camera_from_lidar_guess->rotation.norm(), 1, 1e-15);
}

TEST(RigFile, DamagedTextNeverCrashes) {
  const auto parse = [](const std::string& text) { ParseRig(text, "rig.textproto"); };
  test::ParseTruncations(PrintRig(test::MakeRig()), parse);
  test::ParseDamaged(PrintRig(test::MakeRig()), parse);
  EXPECT_THAT(test::ErrorOf([&] { parse(std::string(100'000, '{')); }), HasSubstr("rig.textproto"));
  std::string deep;
  for (int i = 0; i < 100'000; ++i) deep += "camera {";
  test::ErrorOf([&] { parse(deep); });
  EXPECT_THAT(test::ErrorOf([&] { parse("name: \"\xff\xfe\""); }), HasSubstr("UTF-8"));
}

TEST(RigFile, TheExampleIsTwoDegreesAndFiveCentimetresOffThePublishedPose) {
  const Rig rig = ReadRig(std::string(RGBDT_SOURCE_DIR) + "/scripts/rigs/acfr_vlp16.rig.textproto");
  Rigid3 lidar_from_camera = RotationAbout(Eigen::Vector3d::UnitZ(), -1.4929) *
                             RotationAbout(Eigen::Vector3d::UnitY(), -0.0209) *
                             RotationAbout(Eigen::Vector3d::UnitX(), -1.695);
  lidar_from_camera.translation = {0.063, 0.004, -0.196};
  const PoseError error =
      ErrorOf(*rig.Camera("rgb").camera_from_lidar_guess, lidar_from_camera.Inverse());
  EXPECT_NEAR(error.rotation_deg, 2, 0.05);
  EXPECT_NEAR(error.translation_mm, 50, 1);
  EXPECT_EQ(rig.target.corners_x(), 7);
  EXPECT_EQ(rig.target.corners_y(), 5);
  EXPECT_FALSE(rig.lidar.turned_scanner);
}

TEST(RigFile, EveryShippedRigLoads) {
  int count = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::string(RGBDT_SOURCE_DIR) + "/scripts/rigs")) {
    if (entry.path().extension() != ".textproto") continue;
    EXPECT_NO_THROW(ReadRig(entry.path(), LensNeed::kMayBeUnknown)) << entry.path();
    ++count;
  }
  EXPECT_GT(count, 0);
}

}  // namespace
}  // namespace rgbdt
