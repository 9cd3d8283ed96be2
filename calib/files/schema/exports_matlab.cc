#include "calib/files/atomic_file.h"
#include "calib/files/schema/exports.h"
#include "calib/files/schema/internal/export_parts.h"
#include "calib/files/schema/proto_convert.h"

namespace rgbdt {
namespace {

using exports::Exported;
using exports::List;

constexpr char kMatlabHelp[] =
    "gives the calibration for MATLAB.\n"
    "point_in_camera = camera_from_lidar * point_in_lidar: points are homogeneous columns, the\n"
    "matrix stands in front, in metres, as rigidtform3d takes it. With c = cameras(1):\n"
    "  lidar_to_camera = rigidtform3d(c.camera_from_lidar);  for projectLidarPointsOnImage\n"
    "  camera_to_lidar = invert(lidar_to_camera);            for fuseCameraToLidar\n"
    "  intrinsics = cameraIntrinsics(c.focal_length, c.principal_point, c.image_size, ...\n"
    "    'RadialDistortion', c.radial, 'TangentialDistortion', c.tangential);  of a pinhole lens\n"
    "MATLAB counts pixels from 1: principal_point is 1 more than OpenCV's.";

std::string MatlabComment(const std::string& text) {
  std::string comment = "% ";
  for (const char c : text) comment += c == '\n' ? std::string("\n% ") : std::string(1, c);
  return comment + "\n";
}

// Names come from a file: a quote is doubled, and a line stays one.
std::string MatlabText(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) {
    if (c == '\'') quoted += c;
    quoted += static_cast<unsigned char>(c) < ' ' ? '?' : c;
  }
  return quoted + "'";
}

std::string MatlabRow(const double* values, int count) { return "[" + List(values, count) + "]"; }

std::string MatlabLens(const std::string& camera, const Lens& lens) {
  const std::array<double, 8>& d = lens.distortion;  // k1 k2 p1 p2 k3 k4 k5 k6
  if (lens.model == Lens::Model::kFisheye) {
    return "% Kannala and Brandt's k1 k2 k3 k4, no matter of cameraIntrinsics.\n" + camera +
           ".fisheye = " + MatlabRow(d.data(), 4) + ";\n";
  }
  const double radial[] = {d[0], d[1], d[4]};
  std::string text;
  if (exports::HasTerms(lens, 5)) {
    text =
        "% cameraIntrinsics holds three radial terms; this lens has more, so what stands here is "
        "cut off.\n% All of OpenCV's k1 k2 p1 p2 k3 k4 k5 k6: " +
        List(d.data(), 8) + "\n";
  }
  return text + camera + ".radial = " + MatlabRow(radial, 3) + ";\n" + camera +
         ".tangential = " + MatlabRow(d.data() + 2, 2) + ";\n";
}

std::string MatlabCamera(const Exported& exported, std::size_t number) {
  const std::string camera = "cameras(" + std::to_string(number) + ")";
  const Lens& lens = exported.spec.lens;
  const double focal_length[] = {lens.fx, lens.fy};
  const double principal_point[] = {lens.cx + 1, lens.cy + 1};
  const Eigen::Matrix4d pose = exports::MatrixOf(exported.calibration.camera_from_lidar);
  const std::string warning = exports::StatusWarning(exported);
  std::string text = "\n" + (warning.empty() ? "" : MatlabComment(warning)) + camera +
                     ".name = " + MatlabText(exported.spec.name) + ";\n" + camera +
                     ".camera_from_lidar = [ ...\n";
  for (int row = 0; row < 4; ++row) {
    const Eigen::RowVector4d numbers = pose.row(row);
    text += "  " + List(numbers.data(), 4) + (row < 3 ? "; ...\n" : "];\n");
  }
  return text + camera + ".image_size = [" + std::to_string(exported.spec.height) + " " +
         std::to_string(exported.spec.width) + "];  % rows, columns\n" + camera +
         ".focal_length = " + MatlabRow(focal_length, 2) + ";\n" + camera +
         ".principal_point = " + MatlabRow(principal_point, 2) + ";\n" + MatlabLens(camera, lens);
}

}  // namespace

void ExportMatlab(const std::filesystem::path& path, const Rig& rig,
                  const Calibration& calibration) {
  const std::string call = "cameras = " + path.stem().string() + "()";
  std::string text = "function " + call + "\n" + MatlabComment(call + " " + kMatlabHelp) +
                     MatlabComment(exports::kFrames);
  std::size_t number = 0;
  for (const Exported& camera : exports::Match(rig, calibration)) {
    text += MatlabCamera(camera, ++number);
  }
  WriteFileAtomically(path, text + "end\n");
}

}  // namespace rgbdt
