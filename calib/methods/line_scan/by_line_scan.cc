#include "calib/methods/line_scan/by_line_scan.h"

#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "calib/methods/plane/by_planes.h"
#include "calib/model/check.h"
#include "calib/model/linear_algebra.h"
#include "calib/model/text.h"
#include "calib/solve/calibrate_alone.h"

namespace rgbdt {
namespace {

// The sum over a line's points of q q^T, about the board's centre. A ring may be told apart
// further.
Eigen::Matrix4d ScatterOf(const CloudEdges& cloud, int line) {
  Eigen::Matrix4d scatter = Eigen::Matrix4d::Zero();
  for (const PointGroup& group : cloud.groups) {
    if (group.ring == line) scatter += group.scatter;
  }
  return scatter;
}

// Sine of a line's mean elevation on a board.
double SineOfElevation(const CloudEdges& cloud, const Eigen::Matrix4d& scatter) {
  const Eigen::Vector3d mean = cloud.centre + scatter.col(3).head<3>() / scatter(3, 3);
  return std::abs(mean.z()) / mean.norm();
}

LineOnBoard LineOf(const CameraView& view, int line) {
  const Rigid3& board = view.image->pose->sensor_from_target;
  LineOnBoard on;
  on.normal = board.rotation * Eigen::Vector3d::UnitZ();
  on.offset_m = on.normal.dot(board.translation);
  Eigen::Matrix4d from_centre = Eigen::Matrix4d::Identity();
  from_centre.topRightCorner<3, 1>() = view.cloud->centre;
  on.sums = from_centre * ScatterOf(*view.cloud, line) * from_centre.transpose();
  return on;
}

// Takes q = (p, 1) to P = (X, Z, 1) in the plane of least squares through points.
struct ScanPlane {
  Eigen::Matrix3d axes;  // columns: X, Z, and the normal, LIDAR frame; right-handed
  Eigen::Vector3d origin;

  explicit ScanPlane(const Eigen::Matrix4d& sums) {
    origin = sums.col(3).head<3>() / sums(3, 3);
    const Eigen::Matrix3d spread =
        sums.topLeftCorner<3, 3>() / sums(3, 3) - origin * origin.transpose();
    const Eigen::Matrix3d vectors = EigensystemOf(spread).vectors;
    axes.col(0) = vectors.col(2);
    axes.col(1) = vectors.col(1);
    axes.col(2) = vectors.col(2).cross(vectors.col(1));
  }

  Eigen::Matrix<double, 3, 4> Flat() const {
    Eigen::Matrix<double, 3, 4> flat = Eigen::Matrix<double, 3, 4>::Zero();
    flat.topLeftCorner<2, 3>() = axes.leftCols<2>().transpose();
    flat.topRightCorner<2, 1>() = -axes.leftCols<2>().transpose() * origin;
    flat(2, 3) = 1;
    return flat;
  }
};

double RmsOf(const std::vector<LineOnBoard>& lines, const Rigid3& camera_from_lidar) {
  double squares = 0;
  double points = 0;
  for (const LineOnBoard& line : lines) {
    Eigen::Vector4d x;
    x << camera_from_lidar.rotation.conjugate() * line.normal,
        line.normal.dot(camera_from_lidar.translation) - line.offset_m;
    squares += x.dot(line.sums * x);
    points += line.sums(3, 3);
  }
  return std::sqrt(std::max(0.0, squares) / points);
}

// Points to planes, from a start: the same least squares as SolvePlanes, of one line's points.
CameraCalibration Refine(const std::vector<const CameraView*>& used, int line,
                         const Rigid3& start) {
  std::vector<CameraView> of_line;
  of_line.reserve(used.size());
  for (const CameraView* view : used) {
    of_line.push_back(*view);
    of_line.back().cloud->raw_scatter = ScatterOf(*view->cloud, line);
  }
  std::vector<const CameraView*> pointers;
  pointers.reserve(of_line.size());
  for (const CameraView& view : of_line) pointers.push_back(&view);
  return SolvePlanes(pointers, start);
}

CameraCalibration NotSolved(const CameraViews& views, SolveStatus status, std::string why) {
  CameraCalibration calibration = views.report.calibration;
  calibration.status = status;
  calibration.detail = std::move(why);
  return calibration;
}

}  // namespace

void LineScanOptions::Check() const {
  const OptionCheck check("line scan");
  check.AtLeast(least_points, 2, "least_points");
  check.AtLeast(least_views, 5, "least_views");
  check.Positive(most_rms_m, "most_rms_m");
}

int LineThroughBoards(const std::vector<const CameraView*>& views, int least_points) {
  struct Line {
    int boards = 0;
    double elevation = 0;
  };
  std::map<int, Line> lines;
  for (const CameraView* view : views) {
    std::map<int, Eigen::Matrix4d> on_board;
    for (const PointGroup& group : view->cloud->groups) {
      auto& sum = on_board.try_emplace(group.ring, Eigen::Matrix4d::Zero()).first->second;
      sum += group.scatter;
    }
    for (const auto& [number, scatter] : on_board) {
      if (number < 0 || scatter(3, 3) < least_points) continue;
      ++lines[number].boards;
      lines[number].elevation += SineOfElevation(*view->cloud, scatter);
    }
  }
  int best = -1;
  for (const auto& [number, line] : lines) {
    const Line& other = lines[best < 0 ? number : best];
    if (best < 0 || line.boards > other.boards ||
        (line.boards == other.boards && line.elevation < other.elevation)) {
      best = number;
    }
  }
  return best;
}

std::optional<Rigid3> LinearStart(const std::vector<LineOnBoard>& lines) {
  using Matrix9d = Eigen::Matrix<double, 9, 9>;
  using Vector9d = Eigen::Matrix<double, 9, 1>;
  Eigen::Matrix4d all = Eigen::Matrix4d::Zero();
  for (const LineOnBoard& line : lines) all += line.sums;
  const ScanPlane plane(all);
  Matrix9d equations = Matrix9d::Zero();
  Vector9d right = Vector9d::Zero();
  for (const LineOnBoard& line : lines) {
    const Eigen::Matrix3d flat = plane.Flat() * line.sums * plane.Flat().transpose();
    for (int a = 0; a < 3; ++a) {  // H's columns, one below the other
      for (int b = 0; b < 3; ++b) {
        equations.block<3, 3>(3 * a, 3 * b) += flat(a, b) * line.normal * line.normal.transpose();
      }
      right.segment<3>(3 * a) += line.offset_m * flat(a, 2) * line.normal;
    }
  }
  const Vector9d values = EigensystemOf(equations).values;
  if (!(values[0] > 1e-9 * values[8])) return std::nullopt;
  const Vector9d h = SolveSymmetric(equations, right);
  Eigen::Matrix3d turned;  // the scan plane's axes in the camera
  turned.col(0) = h.segment<3>(0).normalized();
  turned.col(1) = h.segment<3>(3).normalized();
  turned.col(2) = turned.col(0).cross(turned.col(1));
  const Eigen::Matrix3d rotation = NearestOrthogonal(turned) * plane.axes.transpose();
  if (!rotation.allFinite()) return std::nullopt;
  return Rigid3{Eigen::Quaterniond(rotation).normalized(), h.tail<3>() - rotation * plane.origin};
}

CameraCalibration SolveLineScan(CameraViews* views, const LineScanOptions& options) {
  options.Check();
  const int line = LineThroughBoards(views->Used(), options.least_points);
  if (line < 0) {
    return NotSolved(*views, SolveStatus::kNotSolved, "no line of the scanner crosses a board");
  }
  for (CameraView& view : views->all) {
    if (!view.usable() || view.heldout) continue;
    if (ScatterOf(*view.cloud, line)(3, 3) < options.least_points) {
      view.Reject(
          Format("line %d of the scanner, which crosses most boards, does not cross this "
                 "one",
                 line));
    }
  }
  const std::vector<const CameraView*> used = views->Used();
  if (static_cast<int>(used.size()) < options.least_views) {
    return NotSolved(*views, SolveStatus::kNotSolved,
                     Format("line %d of the scanner crosses the board in %zu views; %d are needed",
                            line, used.size(), options.least_views));
  }
  std::vector<LineOnBoard> lines;
  lines.reserve(used.size());
  for (const CameraView* view : used) lines.push_back(LineOf(*view, line));
  const std::optional<Rigid3> start = LinearStart(lines);
  if (!start) {
    return NotSolved(*views, SolveStatus::kDegenerate,
                     "the boards' planes leave the linear start loose; tilt the board otherwise");
  }
  CameraCalibration found = Refine(used, line, *start);
  const double rms = RmsOf(lines, found.camera_from_lidar);
  if (found.converged() && rms > options.most_rms_m) {
    found.status = SolveStatus::kNotConverged;
    found.detail = Format("the line's points lie %.0f mm from the boards' planes (RMS)", 1e3 * rms);
    found.covariance.reset();
  }
  return found;
}

CalibratedCameras CalibrateByLineScan(const Target& target, const CalibrateOptions& options,
                                      std::vector<CameraViews> cameras) {
  return CalibrateAlone(
      target, options, std::move(cameras),
      [](CameraViews* views, const Rigid3& /*guess*/) { return SolveLineScan(views); });
}

}  // namespace rgbdt
