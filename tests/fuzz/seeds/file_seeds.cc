#include <liblzf/lzf.h>

#include <cstring>
#include <opencv2/imgcodecs.hpp>

#include "calib/files/image_files.h"
#include "calib/files/points/cloud_files.h"
#include "calib/files/points/map_files.h"
#include "calib/files/schema/calibration_file.h"
#include "calib/files/schema/report_file.h"
#include "calib/files/schema/rig_file.h"
#include "calib/files/session/session_dir.h"
#include "tests/fuzz/seeds/seeds.h"
#include "tests/fuzz/small_session.h"

namespace rgbdt::fuzz {
namespace {

using Inputs = std::map<std::string, std::string>;

void AddRigs(Inputs* seeds) {
  (*seeds)["small"] = kSmallRig;
  (*seeds)["whole"] = PrintRig(test::MakeRig());
  (*seeds)["turned"] = kTurnedRig;
  const std::string small = kSmallRig;
  const auto with = [&](const std::string& at, const std::string& more) {
    std::string text = small;
    return text.insert(text.find(at), more + " ");
  };
  const std::string lens = "pinhole {",
                    covariance = "1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1";
  for (const std::string more :
       {"exact: true", "sigma: [1, 2, 3, 4]", "sigma: [1, 2]", "sigma: [1, 2, 3, -4]",
        "exact: true sigma: 1", "sigma: [1, 1, 1, 1] made_from: [1, 2, 3, 4]", "made_from: 1"}) {
    (*seeds)["lens " + more] = with(lens, "lens_uncertainty { " + more + " }");
  }
  (*seeds)["covariance"] = with(lens, "lens_uncertainty { covariance: [" + covariance + "] }");
  (*seeds)["no_lens"] = "camera { name: \"rgb\" kind: COLOR width: 4 height: 3 }";
  (*seeds)["guess"] = with(lens, "camera_from_lidar_guess { roll_pitch_yaw_deg: [1, 2, 3] }");
  (*seeds)["guess_norm"] = with(lens, "camera_from_lidar_guess { quaternion_wxyz: [1, 2, 3, 4] }");
  (*seeds)["guess_both"] = with(lens,
                                "camera_from_lidar_guess { quaternion_wxyz: [1, 0, 0, 0] "
                                "roll_pitch_yaw_deg: [1, 2, 3] }");
  const auto board = [&](const std::string& pattern) {
    return small.substr(0, small.find("target {")) + "target { " + pattern +
           " width_m: 1 height_m: 0.8 }";
  };
  (*seeds)["plain"] = board("plain { width_m: 1 height_m: 1 }");
  for (const std::string rest : {"", "legacy: true", "marker_m: 0.2", "dictionary: \"none\""}) {
    (*seeds)["charuco " + rest] = board(
        "charuco { squares_x: 8 squares_y: 6 square_m: 0.1 marker_m: 0.07 "
        "dictionary: \"4X4_50\" " +
        rest + " }");
  }
  for (const std::string rest : {"", "family: \"36h10\" border_bits: 1", "border_bits: 99"}) {
    (*seeds)["aprilgrid " + rest] =
        board("aprilgrid { tags_x: 3 tags_y: 2 tag_m: 0.2 spacing: 0.3 " + rest + " }");
  }
  for (const std::string rest :
       {"", "hole_radius_m: 1", "first_marker: 249", "marker_spacing_x_m: 9"}) {
    (*seeds)["holes " + rest] = board("holes { marker_m: 0.1 " + rest + " }");
  }
  (*seeds)["host"] =
      small + "host { name: \"a\" runs: [\"lidar\", \"viewer\"] } host { name: \"b\" }";
  (*seeds)["distortion"] = with("fx: 4", "distortion: [1, 2, 3]");
  for (const auto& entry :
       std::filesystem::directory_iterator(std::string(RGBDT_SOURCE_DIR) + "/scripts/rigs")) {
    if (entry.path().extension() != ".textproto") continue;
    (*seeds)[entry.path().stem().string()] = ReadWholeFile(entry.path());
  }
}

void AddCalibrations(Inputs* seeds) {
  Calibration calibration = test::MakeReport().ToCalibration();
  (*seeds)["plain"] = PrintCalibration(calibration);
  SolvedLens& lens = calibration.cameras[1].lens.emplace();
  lens.lens = {Lens::Model::kFisheye, 500.1, 501.2, 320.3, 240.4, {0.1, -0.2, 0.3, -0.4}};
  calibration.cameras[1].range_errors = test::MakeRangeErrors();
  calibration.sensors = SensorsOf(test::MakeRig());
  (*seeds)["whole"] = PrintCalibration(calibration);
  Truth truth;
  truth.camera_from_lidar["rgb"] = test::MakePose(0.1, {1, 2, 3});
  truth.lidar_from_target["0001"] = test::MakePose(0.2, {3, 2, 1});
  (*seeds)["truth"] = Written([&](const std::filesystem::path& path) { WriteTruth(path, truth); });
}

void AddReports(Inputs* seeds) {
  Report report = test::MakeReport();
  (*seeds)["plain"] = ReportToJson(report);
  report.cameras[0].scene = SceneCheck{4321, 1.0 / 6, 1.0 / 21, 0.5};
  report.cameras[0].variance_factor = 2.25;
  report.cameras[0].view_scatter = ViewScatter{1.5, 20};
  report.cameras[1].calibration.range_errors = test::MakeRangeErrors();
  (*seeds)["whole"] = ReportToJson(report);
}

void AddSessions(Inputs* seeds) {
  (*seeds)["view"] = kSmallView;
  (*seeds)["linear"] =
      "cloud: \"cloud.pcd\"\nimage { camera: \"thermal\" file: \"thermal.png\" "
      "linear { gain_k_per_count: 0.04 offset_k: 0 } }\n";
  const std::string image = "cloud: \"cloud.pcd\" sweep_utime: 1700000000000000 image { camera: ";
  (*seeds)["colour"] = image + "\"rgb\" file: \"colour.png\" }";
  (*seeds)["large"] = image + "\"rgb\" file: \"large.png\" }";
  (*seeds)["sixteen"] = image + "\"rgb\" file: \"thermal.png\" }";
  (*seeds)["three"] = image + "\"thermal\" file: \"colour.png\" }";
  (*seeds)["format"] = image + "\"rgb\" file: \"rgb.png\" pixel_format: BGR8 }";
  (*seeds)["whose"] = image + "\"nobody\" file: \"rgb.png\" }";
  (*seeds)["which"] = image + "\"rgb\" }";
  (*seeds)["late"] = image + "\"rgb\" file: \"rgb.png\" utime: 1600000000000000 }";
  (*seeds)["emissivity"] = image + "\"thermal\" file: \"thermal.png\" emissivity: 3 }";
  (*seeds)["no_cloud"] = "image { camera: \"rgb\" file: \"rgb.png\" }";
  (*seeds)["no_image"] = "cloud: \"cloud.pcd\"";
  (*seeds)["never"] = "cloud: \"cloud.pcd\" sweep_utime: 9000000000000000000";
  const auto further = [&](const std::string& fields) {
    return std::string(kSmallView) + "further_cloud { " + fields + " }\n";
  };
  const std::string second = "lidar: \"second\" file: ";
  (*seeds)["second"] = further(second + "\"second.pcd\"") +
                       "map_from_lidar { quaternion_wxyz: [1, 0, 0, 0] translation_m: [1, 2, 3] }";
  (*seeds)["second_twice"] =
      further(second + "\"second.pcd\" } further_cloud { " + second + "\"second.pcd\"");
  (*seeds)["same_points"] = further(second + "\"cloud.pcd\"");
  (*seeds)["no_file"] = further("lidar: \"second\"");
  (*seeds)["broken_name"] = further(second + "\"a\\n.pcd\"");
  (*seeds)["whose_cloud"] = further("lidar: \"third\" file: \"second.pcd\"");
  (*seeds)["script"] =
      "name: \"s\"\nrig: \"rig.textproto\"\nstep { next_pose {} timeout_s: 5 }\nstep { sweep {} "
      "}\nstep { capture { heldout: true picked_camera: \"thermal\" } }\n"
      "step { wait { seconds: 1.5 } }\nstep { solve {} }\nstep { evaluate {} }\nstep { save {} }\n";
  (*seeds)["whose_pick"] =
      "rig: \"rig.textproto\"\nstep { sweep {} }\nstep { capture { picked_camera: \"thermo\" } }\n";
  (*seeds)["empty_step"] = "rig: \"rig.textproto\"\nstep { }\n";
  (*seeds)["negative"] = "rig: \"rig.textproto\"\nstep { sweep {} timeout_s: -1 }\n";
  (*seeds)["wait_nan"] = "rig: \"rig.textproto\"\nstep { wait { seconds: nan } }\n";
  (*seeds)["no_sweep"] = "rig: \"rig.textproto\"\nstep { capture {} }\n";
  (*seeds)["no_capture"] = "rig: \"rig.textproto\"\nstep { solve {} }\n";
  (*seeds)["no_solve"] =
      "rig: \"rig.textproto\" step { sweep {} } step { capture {} } "
      "step { evaluate {} }\n";
}

void AddLenses(Inputs* seeds) {
  (*seeds)["opencv"] =
      "\x01%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\ncamera_matrix: !!opencv-matrix\n"
      "   rows: 3\n   cols: 3\n   dt: d\n   data: [ 500., 0., 320.5, 0., 501.5,\n       240.25, "
      "0., "
      "0., 1. ]\ndistortion_coefficients: !!opencv-matrix\n   rows: 5\n   cols: 1\n   dt: d\n"
      "   data: [ -1.5e-01, 2.5e-02, 1.0e-03, -2.e-03, 0.125 ]\n";
  (*seeds)["ros"] =
      "\x01header:\n  stamp: {sec: 12, nanosec: 5}\nheight: 480\nwidth: 640\ndistortion_model: "
      "plumb_bob\nd:\n- 0.1\n- 0.2\n- 0.3\n- 0.4\n- 0.5\nk: [500.0, 0.0, 320.5, 0.0, 501.5, "
      "240.25, 0.0, 0.0, 1.0]\nbinning_x: 0\nroi: {x_offset: 0, y_offset: 0}\n---\n";
  (*seeds)["kalibr"] =
      "\x02"
      "cam0:\n  camera_model: pinhole\n  distortion_coeffs: [-0.1, 0.2, 0.001, -0.002]\n"
      "  distortion_model: radtan\n  intrinsics: [500.0, 501.5, 320.5, 240.25]\n  resolution: "
      "[640, 480]\n  rostopic: /rgb/image_raw\ncam1:\n  T_cn_cnm1:\n  - [1.0, 0.0, 0.0, 0.1]\n"
      "  camera_model: pinhole\n  distortion_coeffs: [-0.01, 0.02, -0.03, 0.04]\n"
      "  distortion_model: equidistant\n  intrinsics: [300.0, 301.0, 160.0, 128.0]\n"
      "  resolution: [320, 256]\n  rostopic: /thermal/image_raw\n";
  (*seeds)["fisheye"] =
      "\x21K: [500, 0, 320, 0, 500, 240, 0, 0, 1]\nD: [0.1, 0.2, 0.3, 0.4]\nwidth: 640\n";
  (*seeds)["entry"] = "\x0a" + (*seeds)["kalibr"].substr(1);
  (*seeds)["second"] = "\x06" + (*seeds)["kalibr"].substr(1);
  (*seeds)["anchors"] =
      "\x01"
      "a: &a [1, 2]\nb: *a\nc: \"text \\n\"\nd: 'x'\ne: |\n  lines\n";
}

constexpr char kPcdHead[] = "# .PCD v0.7\nVERSION 0.7\n";

// As PCL writes it: LZF of the fields one after the other.
std::string Compressed() {
  std::string columns;
  for (int i = 0; i < 60; ++i) columns += std::string("\0\0\x80\x3f", 4);
  std::string packed(200, '\0');
  packed.resize(lzf_compress(columns.data(), static_cast<unsigned>(columns.size()), packed.data(),
                             static_cast<unsigned>(packed.size())));
  const auto size = [](std::size_t value) {
    std::string bytes;
    for (int i = 0; i < 4; ++i) bytes += static_cast<char>(value >> (8 * i));
    return bytes;
  };
  return std::string(kPcdHead) +
         "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 20\nHEIGHT 1\nPOINTS 20\nDATA "
         "binary_compressed\n" +
         size(packed.size()) + size(columns.size()) + packed;
}

std::string LittleEndian(std::initializer_list<float> values) {
  std::string bytes(values.size() * sizeof(float), '\0');
  std::memcpy(bytes.data(), std::data(values), bytes.size());
  return bytes;
}

// `points` of a sweep whose times are `first` and so on, in steps of `step`.
std::string TimedSweep(const std::string& field, const std::string& type, int points, double first,
                       double step) {
  const std::string count = std::to_string(points);
  std::string text = std::string(kPcdHead) + "FIELDS x y z " + field +
                     "\nSIZE 4 4 4 8\nTYPE F F F " + type + "\nWIDTH " + count +
                     "\nHEIGHT 1\nPOINTS " + count + "\nDATA ascii\n";
  for (int i = 0; i < points; ++i) {
    const double time = first + i * step;
    text += "1 2 " + std::to_string(i) + " " +
            (type == "F" ? std::to_string(time) : std::to_string(static_cast<std::int64_t>(time))) +
            "\n";
  }
  return text;
}

// Drivers count from the sweep's start or from 1970, in whatever unit.
void AddTimedSweeps(Inputs* seeds) {
  for (const double unit : {1.0, 1e3, 1e6, 1e9}) {
    const std::string per_second = std::to_string(static_cast<int>(unit));
    for (const std::string type : {"F", "U"}) {
      const std::string end = type + "_" + per_second + ".pcd";
      (*seeds)["since_start_" + end] = TimedSweep("time", type, 100, 0, 0.001 * unit);
      (*seeds)["since_1970_" + end] =
          TimedSweep("timestamp", type, 100, 1.7e9 * unit, 0.001 * unit);
    }
  }
  (*seeds)["one_time.pcd"] = TimedSweep("t", "U", 100, 5, 0);
  (*seeds)["no_sweep.pcd"] = TimedSweep("offset_time", "F", 100, 0, 1e13);
  (*seeds)["few_since_1970.pcd"] = TimedSweep("time_stamp", "F", 3, 1.7e18, 1e6);
  (*seeds)["few_late.pcd"] = TimedSweep("time", "F", 3, 5e12, 1e6);
  (*seeds)["kitti"] = LittleEndian({1, 2, 3, 0.5, -1, -2, -3, 0.25, 4, 5, 6, 0});
  (*seeds)["nuscenes"] = LittleEndian({1, 2, 3, 40, 0, -1, -2, -3, 80, 1});
  (*seeds)["either"] = LittleEndian({1, 2, 3, 4, 1, 2, 3, 4, 1, 2, 3, 4, 1, 2, 3, 4, 1, 2, 3, 4});
  (*seeds)["no_intensity"] = LittleEndian({1, 2, 3, -4});
}

void AddClouds(Inputs* seeds) {
  AddTimedSweeps(seeds);
  const std::string head = kPcdHead;
  Cloud cloud = test::MakeCloud();
  (*seeds)["sweep.pcd"] =
      Written([&](const std::filesystem::path& path) { WritePcd(path, cloud); });
  const RgbdtCloud fused = test::MakeRgbdtCloud(4, 3);
  (*seeds)["fused.pcd"] =
      Written([&](const std::filesystem::path& path) { WritePcd(path, fused); });
  (*seeds)["fused.ply"] =
      Written([&](const std::filesystem::path& path) { WritePly(path, fused); });
  MapCloud map;
  map.frame = "map";
  map.voxel_m = 0.1;
  map.points = {{1, 2, 3}, {4, 5, 6}};
  map.rgb = {{1, 2, 3}, {4, 5, 6}};
  map.temperature_k = {300, 301};
  map.count = {1, 2};
  map.last_seen = {test::kNow, test::kNow};
  (*seeds)["map.ply"] = Written([&](const std::filesystem::path& path) { WriteMapPly(path, map); });
  (*seeds)["compressed.pcd"] = Compressed();
  (*seeds)["ascii.pcd"] = head +
                          "FIELDS x y z intensity ring t rgb\nSIZE 4 4 4 4 2 4 4\nTYPE F F F F U U "
                          "F\nCOUNT 1 1 1 1 1 1 1\nWIDTH 2\nHEIGHT 2\nVIEWPOINT 0 0 0 1 0 0 0\n"
                          "POINTS 4\nDATA ascii\n1 2 3 200 5 1000 4.2e-39\nnan nan nan 0 1 2000 "
                          "0\n1 1 1 3 2 3000 255\n0 0 0 0 0 0 0\n";
  (*seeds)["lines.pcd"] =
      head +
      "FIELDS x y z line beam utime\nSIZE 8 8 8 4 4 8\nTYPE F F F I I I\nWIDTH "
      "4\nHEIGHT 1\nPOINTS 4\nDATA ascii\n1 2 3 5 0 1700000000000000\n1 2 3 5 1 "
      "1700000000000001\n1 2 3 6 0 1700000000000002\n1 2 3 6 1 1700000000000003\n";
  const std::string ply = "ply\nformat ascii 1.0\ncomment anybody's\nelement vertex 2\n";
  (*seeds)["rings.pcd"] =
      head +
      "FIELDS x y z ring\nSIZE 4 4 4 2\nTYPE F F F U\nWIDTH 2\nHEIGHT 3\nPOINTS 6\nDATA "
      "ascii\n1 2 3 0\n1 2 3 2\n1 2 3 1\n1 2 4 0\n1 2 4 2\n1 2 4 1\n";
  (*seeds)["ascii.ply"] =
      ply +
      "property float x\nproperty double y\nproperty float z\nproperty uchar "
      "r\nproperty uchar g\nproperty uchar b\nproperty float timestamp\nelement "
      "face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "1 2 3 4 5 6 0.5\n1 2 3 4 5 6 0.25\n3 0 1 1\n";
  (*seeds)["real.ply"] = ply +
                         "property float x\nproperty float y\nproperty float z\nproperty float "
                         "red\nproperty float green\nproperty float blue\nend_header\n"
                         "1 2 3 0.5 1 0\n1 2 3 nan 0.1 0.2\n";
}

// Level ground of cells that are seen, a wall, and what hangs over it.
void AddGround(Inputs* seeds) {
  MapCloud map;
  map.frame = "map";
  map.voxel_m = 0.1;
  const auto add = [&](double x, double y, double z) {
    map.points.emplace_back(x, y, z);
    map.rgb.push_back({1, 2, 3});
    map.temperature_k.push_back(290);
    map.count.push_back(3);
    map.last_seen.push_back(test::kNow);
  };
  for (int i = 0; i < 12; ++i) {
    for (int k = 0; k < 12; ++k) add(0.2 * i, 0.2 * k, 0.01 * (i % 2));
    for (int k = 0; k < 4; ++k) add(2.5, 0.2 * i, 0.2 * k);
  }
  add(1, 1, 5);
  (*seeds)["map"] = Written([&](const std::filesystem::path& path) { WriteMapPly(path, map); });
  (*seeds)["cloud"] = std::string(kPcdHead) +
                      "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 5\nHEIGHT 1\nPOINTS 5\nDATA "
                      "ascii\n0 0 0\n0.1 0 0\n0 0.1 0\n0.1 0.1 0\nnan nan nan\n";
}

void AddImages(Inputs* seeds) {
  cv::Mat grey(12, 16, CV_8UC1), colour(12, 16, CV_8UC3), counts(12, 16, CV_16UC1);
  cv::RNG random(1);
  random.fill(grey, cv::RNG::UNIFORM, 0, 256);
  random.fill(colour, cv::RNG::UNIFORM, 0, 256);
  random.fill(counts, cv::RNG::UNIFORM, 0, 65536);
  for (const std::string extension : {".png", ".jpg", ".tif", ".bmp", ".pgm", ".ppm", ".webp"}) {
    for (const auto& [name, pixels] :
         {std::pair<std::string, cv::Mat>{"grey", grey}, {"colour", colour}, {"counts", counts}}) {
      if (name == "counts" && extension != ".png" && extension != ".tif") continue;
      if (extension == (name == "grey" ? ".ppm" : ".pgm")) continue;
      std::vector<unsigned char> bytes;
      cv::imencode(extension, pixels, bytes);
      (*seeds)[name + extension] =
          std::string(extension == ".png" ? "\x01" : std::string(1, '\0')) +
          std::string(bytes.begin(), bytes.end());
    }
  }
  std::vector<unsigned char> bytes;
  cv::Mat with_alpha(4, 5, CV_8UC4, cv::Scalar(1, 2, 3, 4));
  cv::imencode(".png", with_alpha, bytes);
  (*seeds)["alpha.png"] = "\x01" + std::string(bytes.begin(), bytes.end());
  cv::imencode(".jpg", colour, bytes, {cv::IMWRITE_JPEG_PROGRESSIVE, 1});
  const std::string jpeg(bytes.begin(), bytes.end()), begin = std::string(1, '\0') + "\xFF\xD8";
  (*seeds)["progressive.jpg"] = std::string(1, '\0') + jpeg;
  const std::string big(
      "\xFF\xE1\0\x22"
      "Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06"
      "\0\0\0\0\0\0",
      36),
      little(
          "\xFF\xE1\0\x2E"
          "Exif\0\0II*\0\x08\0\0\0\x02\0\0\x01\x03\0\x01\0\0\0\x10\0\0\0"
          "\x12\x01\x03\0\x01\0\0\0\x01\0\0\0\0\0\0\0",
          48);
  (*seeds)["exif_big.jpg"] = begin + big + jpeg.substr(2);
  (*seeds)["exif_little.jpg"] = begin + little + jpeg.substr(2);
  (*seeds)["exif_second.jpg"] = begin + std::string("\xFF\xE0\0\x04\0\0", 6) + big + jpeg.substr(2);
}

void AddNames(Inputs* seeds) {
  const std::string either(1, '\0');
  (*seeds)["same"] = either + "a.png\nb.png\n\na.pcd\nb.pcd.bin\nc.pcd\n";
  (*seeds)["numbers"] = either + "rgb_007_8.png\nrgb_12_8.png\nx\n\n0007.pcd\n0012.pcd\n000.pcd\n";
  (*seeds)["many_numbers"] = either + "1_5_3.png\n2_6_3.png\n3_6_3\n\n7-1.pcd\n8-2.pcd\n";
  (*seeds)["seconds"] =
      either +
      "1700000000.25.png\n1700000001_5.png\n1700000002_250000.png\n\n1700000000.pcd\n"
      "1700000001.3.pcd\n0003_1700000002240.pcd\n";
  (*seeds)["units"] =
      either +
      "1700000000123.png\n\n1700000000123456.pcd\n1700000000123456789.pcd\n9999999999.pcd\n";
  (*seeds)["dates"] =
      either +
      "2023-05-14-10-15-23.png\n20230514_101524.250.png\n20230514101525999.png\n\n"
      "2023-05-14T10_15_23.pcd\n20230514-101524-250000.pcd\n2023-13-14-10-15-23.pcd\n"
      "20230514101523123456789012.pcd\n2023-5-14.pcd\n";
  (*seeds)["far"] = either + "1700000000.png\n\n1800000000.pcd\n";
  (*seeds)["none"] = either + "a.png\n\nb.pcd\n";
  (*seeds)["in_order"] =
      "\x01"
      "a.png\nb.png\n\nc.pcd\nd.pcd\n";
  (*seeds)["not_in_order"] =
      "\x01"
      "a.png\nb.png\n\nc.pcd\n";
}

}  // namespace

void AddFileSeeds(Seeds* seeds) {
  AddRigs(&(*seeds)["rig_text"]);
  AddCalibrations(&(*seeds)["calibration_text"]);
  AddReports(&(*seeds)["report_json"]);
  AddSessions(&(*seeds)["session_text"]);
  AddLenses(&(*seeds)["lens_file"]);
  AddNames(&(*seeds)["names"]);
  AddClouds(&(*seeds)["cloud_file"]);
  AddGround(&(*seeds)["terrain"]);
  AddImages(&(*seeds)["image"]);
}

}  // namespace rgbdt::fuzz
