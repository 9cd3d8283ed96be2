#include "calib/present/frames/internal/content_json.h"

#include "calib/present/layout/frame.h"

namespace rgbdt {
namespace {

using nlohmann::json;

json TablesJson(const std::vector<Table>& tables) {
  json out = json::array();
  for (const Table& table : tables) out.push_back(TableJson(table));
  return out;
}

json CameraJson(const CameraContent& camera) {
  return {{"camera", camera.camera}, {"tables", TablesJson(camera.tables)}};
}

}  // namespace

json VerdictJson(const Verdict& verdict) {
  return {{"grade", NameOf(verdict.grade)},
          {"headline", verdict.headline},
          {"reasons", verdict.reasons}};
}

json PosesJson(const std::vector<NamedPose>& poses) {
  json out = json::array();
  for (const NamedPose& pose : poses) {
    out.push_back(
        {{"name", pose.name}, {"sentence", pose.sentence}, {"matrix", MatrixOf(pose.pose)}});
  }
  return out;
}

json TableJson(const Table& table) {
  json rows = json::array();
  for (const Row& row : table.rows) {
    json cells = json::array();
    for (const Cell& cell : row) {
      cells.push_back({{"text", cell.text}, {"mark", NameOf(cell.mark)}});
    }
    rows.push_back(cells);
  }
  return {{"title", table.title}, {"notes", table.notes}, {"head", table.head}, {"rows", rows}};
}

json ContentJson(const ReportContent& content) {
  json cameras = json::array();
  for (const CameraContent& camera : content.cameras) cameras.push_back(CameraJson(camera));
  return {{"intro", content.intro}, {"cameras", cameras}, {"tables", TablesJson(content.tables)}};
}

}  // namespace rgbdt
