#include "calib/present/report/report_content.h"

#include <array>
#include <ctime>

#include "calib/model/method.h"
#include "calib/present/report/internal/fit_tables.h"
#include "calib/present/report/internal/lidar_tables.h"
#include "calib/present/report/internal/uncertainty_tables.h"
#include "calib/present/report/words.h"

namespace rgbdt {
namespace {

std::string Intro(const Report& report) {
  std::string intro = "Method: " + report.method + ". Rig: " + report.rig_hash + ".";
  if (IsDate(report.utime)) intro += " Newest image: " + TimeText(report.utime) + ".";
  return intro;
}

// x, y, z
std::string Coordinates(const Eigen::Vector3d& point, int decimals) {
  return "x " + Number(point.x(), decimals) + ", y " + Number(point.y(), decimals) + ", z " +
         Number(point.z(), decimals) + " m";
}

void AddIfAny(Table table, std::vector<Table>* tables) {
  if (!table.empty()) tables->push_back(std::move(table));
}

// What says most of a calibration first.
CameraContent ContentOf(const CameraReport& camera, const Report& report) {
  const FitFigure figure =
      report.method == kPaperMethod ? FitFigure::kDistanceTransform : FitFigure::kSigmas;
  CameraContent content{
      camera.calibration.camera, Judge(camera, report.next_view), BothWays(camera.calibration), {}};
  for (Table& table :
       std::array{ProjectionTable(camera), FitTable(camera, figure), PartsTable(camera),
                  PoseSigmaTable(camera), ViewsTable(camera, figure), FoldsTable(camera),
                  StartsTable(camera, figure), NuisanceTable(camera), LidarTable(camera),
                  SolveTable(camera)}) {
    AddIfAny(std::move(table), &content.tables);
  }
  return content;
}

}  // namespace

std::vector<NamedPose> BothWays(const CameraCalibration& calibration) {
  const Rigid3& camera_from_lidar = calibration.camera_from_lidar;
  const Rigid3 lidar_from_camera = camera_from_lidar.Inverse();
  return {
      {"camera_from_lidar",
       "Takes a point of the LIDAR frame (x forward, y left, z up) into the frame of camera " +
           calibration.camera +
           " (x right, y down, z forward); metres. point_in_camera = camera_from_lidar · "
           "point_in_lidar",
       camera_from_lidar},
      {"lidar_from_camera",
       "The inverse: the camera's pose in the LIDAR frame (what ROS wants). The camera's centre "
       "is at " +
           Coordinates(lidar_from_camera.translation, 4) +
           ". point_in_lidar = lidar_from_camera · point_in_camera",
       lidar_from_camera}};
}

ReportContent ContentOf(const Report& report) {
  ReportContent content;
  content.intro = Intro(report);
  for (const CameraReport& camera : report.cameras) {
    content.cameras.push_back(ContentOf(camera, report));
  }
  AddIfAny(DetectionTable(report), &content.tables);
  AddIfAny(ClosureTable(report), &content.tables);
  AddIfAny(FurtherLidarsTable(report), &content.tables);
  AddIfAny(FurtherNuisanceTable(report), &content.tables);
  if (const NextView* next = NextViewOf(report)) content.next_view = WordsOf(*next);
  return content;
}

NextViewWords WordsOf(const NextView& next) {
  return {next.words,
          "The board's centre is then at " + Coordinates(next.lidar_from_target.translation, 1) +
              " in the LIDAR's frame. Where camera " + next.camera +
              " is worst, the projection uncertainty (1 sigma) is expected to improve from " +
              Number(next.sigma_before_px, 2) + " to " + Number(next.sigma_after_px, 2) + " px."};
}

}  // namespace rgbdt
