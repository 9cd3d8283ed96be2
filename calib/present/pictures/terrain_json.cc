#include "calib/present/pictures/terrain_json.h"

#include <cmath>

#include "calib/model/printable.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

std::string Number(double value, int decimals) {
  return std::isfinite(value) ? Fixed(value, decimals) : "null";
}

std::string Quoted(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : PrintableText(text)) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + "\"";
}

// "name": [a row of the grid a line]
template <typename Value>
std::string Array(const char* name, const TerrainGrid& grid, Value value) {
  std::string text = std::string("    \"") + name + "\": [";
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    if (cell > 0) text += ",";
    if (cell % static_cast<std::size_t>(grid.columns) == 0) text += "\n      ";
    text += value(cell);
  }
  return text + "\n    ]";
}

std::string Limits(const TerrainOptions& options) {
  return "  \"limits\": {\"max_slope_deg\": " + Number(options.max_slope_rad / kDegree, 2) +
         ", \"max_step_m\": " + Number(options.max_step_m, 3) +
         ", \"max_roughness_m\": " + Number(options.max_roughness_m, 3) +
         ", \"vehicle_width_m\": " + Number(options.vehicle_width_m, 3) +
         ", \"vehicle_height_m\": " + Number(options.vehicle_height_m, 3) +
         ", \"min_points\": " + std::to_string(options.min_points) +
         ",\n    \"site_radius_m\": " + Number(options.site_radius_m, 3) +
         ", \"site_max_slope_deg\": " + Number(options.site_max_slope_rad / kDegree, 2) +
         ", \"site_headroom_m\": " + Number(options.site_headroom_m, 2) + "},\n";
}

std::string Site(const LandingSite& site, std::size_t rank) {
  return "    {\"rank\": " + std::to_string(rank) + ", \"x_m\": " + Number(site.centre.x(), 3) +
         ", \"y_m\": " + Number(site.centre.y(), 3) + ", \"z_m\": " + Number(site.centre.z(), 3) +
         ", \"radius_m\": " + Number(site.radius_m, 3) +
         ", \"slope_deg\": " + Number(site.slope_rad / kDegree, 2) +
         ", \"roughness_mm\": " + Number(1000 * site.roughness_m, 1) +
         ", \"clearance_m\": " + Number(site.clearance_m, 3) +
         ", \"temperature_c\": " + Number(site.temperature_k - 273.15, 2) +
         ", \"score\": " + Number(site.score, 4) + "}";
}

std::string Sites(const std::vector<LandingSite>& sites) {
  std::string text = "  \"sites\": [";
  for (std::size_t i = 0; i < sites.size(); ++i) {
    text += (i == 0 ? "\n" : ",\n") + Site(sites[i], i + 1);
  }
  return text + (sites.empty() ? "],\n" : "\n  ],\n");
}

std::string Grid(const TerrainGrid& grid) {
  const auto measure = [&grid](const char* name, const std::vector<float>& values, double unit,
                               int decimals) {
    return Array(name, grid, [&values, unit, decimals](std::size_t cell) {
      return Number(double{values[cell]} / unit, decimals);
    });
  };
  const auto flags = [&grid](const char* name, const std::vector<std::uint8_t>& values) {
    return Array(name, grid, [&values](std::size_t cell) { return std::to_string(values[cell]); });
  };
  return "  \"grid\": {\n    \"cell_m\": " + Number(grid.cell_m, 4) +
         ", \"origin_x_m\": " + Number(grid.origin.x(), 4) +
         ", \"origin_y_m\": " + Number(grid.origin.y(), 4) +
         ", \"columns\": " + std::to_string(grid.columns) +
         ", \"rows\": " + std::to_string(grid.rows) +
         ",\n    \"order\": \"value of the cell at (column, row) is [row * columns + column]; "
         "columns along x, rows along y, from the origin, the lowest corner\",\n"
         "    \"states\": [\"unknown\", \"traversable\", \"obstacle\"],\n" +
         Array(
             "state", grid,
             [&](std::size_t cell) { return std::to_string(static_cast<int>(grid.state[cell])); }) +
         ",\n" + flags("interpolated", grid.interpolated) + ",\n" +
         flags("overhead", grid.overhead) + ",\n" +
         Array("points", grid, [&](std::size_t c) { return std::to_string(grid.points[c]); }) +
         ",\n" + measure("height_m", grid.height_m, 1, 3) + ",\n" +
         measure("slope_deg", grid.slope_rad, kDegree, 2) + ",\n" +
         measure("roughness_m", grid.roughness_m, 1, 4) + ",\n" +
         measure("step_m", grid.step_m, 1, 3) + ",\n" +
         measure("temperature_k", grid.temperature_k, 1, 2) + "\n  }\n";
}

}  // namespace

std::string TerrainJson(const Terrain& terrain, const TerrainOptions& options,
                        const std::string& frame, const std::string& input) {
  return "{\n  \"input\": " + Quoted(input) + ",\n  \"frame\": " + Quoted(frame) + ",\n" +
         Limits(options) + Sites(terrain.sites) + Grid(terrain.grid) + "}\n";
}

}  // namespace rgbdt
