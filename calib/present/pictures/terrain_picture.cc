#include "calib/present/pictures/terrain_picture.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "calib/model/text.h"

namespace rgbdt {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;
constexpr int kLargest = 900, kSmallest = 240;  // [px] of a map's longer and shorter side
constexpr int kLeft = 72, kTop = 52, kRight = 28, kBottom = 58, kBar = 92;
constexpr int kLegendEntries = 7, kEntryWidth = 200, kEntryHeight = 26;  // [px]
const cv::Scalar kInk(45, 45, 45), kPaper(255, 255, 255), kFaint(190, 190, 190);
const cv::Vec3b kUnknown(226, 226, 226), kObstacle(52, 58, 205);
const cv::Vec3b kFlat(150, 225, 160), kSteep(35, 95, 20), kOverhead(200, 120, 60);

void Text(const std::string& text, cv::Point at, cv::Mat* picture, double size = 0.5) {
  cv::putText(*picture, text, at, cv::FONT_HERSHEY_SIMPLEX, size, kInk, 1, cv::LINE_AA);
}

// Centred on a point, in paper's colour round the ink, so that it reads on any ground.
void Label(const std::string& text, cv::Point centre, cv::Mat* picture) {
  int base = 0;
  const cv::Size size = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, 0.6, 2, &base);
  const cv::Point at(centre.x - size.width / 2, centre.y + size.height / 2);
  cv::putText(*picture, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.6, kPaper, 5, cv::LINE_AA);
  cv::putText(*picture, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.6, kInk, 2, cv::LINE_AA);
}

cv::Vec3b Mix(const cv::Vec3b& a, const cv::Vec3b& b, double share) {
  cv::Vec3b mixed;
  for (int c = 0; c < 3; ++c) mixed[c] = cv::saturate_cast<uchar>(a[c] + share * (b[c] - a[c]));
  return mixed;
}

cv::Vec3b GreenOf(double slope_rad, const TerrainOptions& options) {
  return Mix(kFlat, kSteep, std::clamp(slope_rad / options.max_slope_rad, 0.0, 1.0));
}

/// The part of the grid that is drawn, and how large.
struct View {
  const TerrainGrid* grid;
  cv::Rect cells;  // columns and rows
  int scale;       // [px] a cell

  cv::Size size() const { return cells.size() * scale; }
  cv::Point2d Pixel(double x_m, double y_m) const {
    const double column = (x_m - grid->origin.x()) / grid->cell_m - cells.x;
    const double row = (y_m - grid->origin.y()) / grid->cell_m - cells.y;
    return {kLeft + column * scale, kTop + (cells.height - row) * scale};
  }
  double low_x() const { return grid->origin.x() + cells.x * grid->cell_m; }
  double low_y() const { return grid->origin.y() + cells.y * grid->cell_m; }
  double high_x() const { return low_x() + cells.width * grid->cell_m; }
  double high_y() const { return low_y() + cells.height * grid->cell_m; }
};

// What is known and a margin; all where nothing is.
View ViewOf(const TerrainGrid& grid) {
  cv::Rect known;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      if (grid.state[grid.Index(column, row)] == CellState::kUnknown) continue;
      known |= cv::Rect(column, row, 1, 1);
    }
  }
  const cv::Rect all(0, 0, grid.columns, grid.rows);
  const cv::Rect wider(known.x - 3, known.y - 3, known.width + 6, known.height + 6);
  const cv::Rect cells = known.empty() ? all : wider & all;
  const int longer = std::max(cells.width, cells.height);
  return {&grid, cells, std::clamp(kLargest / longer, 1, 24)};
}

template <typename ColourOf>
void DrawCells(const View& view, ColourOf colour_of, cv::Mat* picture) {
  for (int row = 0; row < view.cells.height; ++row) {
    for (int column = 0; column < view.cells.width; ++column) {
      const std::size_t cell = view.grid->Index(view.cells.x + column, view.cells.y + row);
      const cv::Vec3b c = colour_of(cell);
      const cv::Rect square(kLeft + column * view.scale,
                            kTop + (view.cells.height - 1 - row) * view.scale, view.scale,
                            view.scale);
      (*picture)(square).setTo(cv::Scalar(c[0], c[1], c[2]));
    }
  }
}

// 1, 2 or 5 times a power of ten: some eight ticks along the longer axis.
double TickStep(double length_m) {
  const double power = std::pow(10, std::floor(std::log10(length_m / 8)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (step * power * 9 >= length_m) return step * power;
  }
  return 10 * power;
}

void DrawAxes(const View& view, cv::Mat* picture) {
  const cv::Rect frame({kLeft, kTop}, view.size());
  const double step =
      TickStep(std::max(view.high_x() - view.low_x(), view.high_y() - view.low_y()));
  const int decimals = step < 0.1 ? 2 : step < 1 ? 1 : 0;
  const auto label = [&](double value) {  // no "-0"
    return Fixed(std::abs(value) < step / 2 ? 0 : value, decimals);
  };
  for (double x = std::ceil(view.low_x() / step) * step; x <= view.high_x(); x += step) {
    const cv::Point at = view.Pixel(x, view.low_y());
    cv::line(*picture, at, {at.x, at.y + 6}, kInk);
    Text(label(x), {at.x - 8, at.y + 23}, picture);
  }
  for (double y = std::ceil(view.low_y() / step) * step; y <= view.high_y(); y += step) {
    const cv::Point at = view.Pixel(view.low_x(), y);
    cv::line(*picture, {at.x - 6, at.y}, at, kInk);
    Text(label(y), {at.x - 44, at.y + 5}, picture);
  }
  cv::rectangle(*picture, frame, kInk);
  Text("x [m]", {kLeft + frame.width / 2 - 20, frame.br().y + 46}, picture);
  Text("y [m]", {8, kTop - 12}, picture);
}

void DrawSensor(const View& view, const std::string& frame, cv::Mat* picture) {
  if (frame != "lidar") return;
  const cv::Point at = view.Pixel(0, 0);
  if (!cv::Rect({kLeft, kTop}, view.size()).contains(at)) return;
  cv::drawMarker(*picture, at, kInk, cv::MARKER_TRIANGLE_UP, 14, 2, cv::LINE_AA);
  Text("LIDAR", {at.x + 12, at.y + 5}, picture);
}

void DrawSites(const View& view, const std::vector<LandingSite>& sites, cv::Mat* picture) {
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const cv::Point centre = view.Pixel(sites[i].centre.x(), sites[i].centre.y());
    const int radius =
        static_cast<int>(std::lround(sites[i].radius_m / view.grid->cell_m * view.scale));
    cv::circle(*picture, centre, radius, kPaper, 4, cv::LINE_AA);
    cv::circle(*picture, centre, radius, kInk, 2, cv::LINE_AA);
    Label(std::to_string(i + 1), centre, picture);
  }
}

// Cells under something that hangs above the vehicle: a dot in the middle.
void DrawOverhead(const View& view, cv::Mat* picture) {
  for (int row = 0; row < view.cells.height; ++row) {
    for (int column = 0; column < view.cells.width; ++column) {
      const std::size_t cell = view.grid->Index(view.cells.x + column, view.cells.y + row);
      if (!view.grid->overhead[cell]) continue;
      const Eigen::Vector2d middle = view.grid->Centre(cell);
      cv::circle(*picture, view.Pixel(middle.x(), middle.y()), std::max(1, view.scale / 5),
                 cv::Scalar(kOverhead[0], kOverhead[1], kOverhead[2]), cv::FILLED, cv::LINE_AA);
    }
  }
}

int EntriesPerRow(int width) { return std::max(1, (width - kLeft / 2) / kEntryWidth); }

cv::Mat Blank(const View& view, int more_width) {
  const int width = kLeft + std::max(view.size().width, kSmallest) + kRight + more_width;
  const int per_row = EntriesPerRow(width - more_width);
  const int legend = (kLegendEntries + per_row - 1) / per_row * kEntryHeight + 16;
  return {kTop + view.size().height + kBottom + legend, width, CV_8UC3, kPaper};
}

void DrawLegend(const View& view, const TerrainOptions& options, cv::Mat* picture) {
  constexpr int kSwatch = 16;
  int index = 0;
  const auto at = [&] {
    const int per_row = EntriesPerRow(picture->cols);
    const cv::Point place(
        kLeft / 2 + (index % per_row) * kEntryWidth,
        kTop + view.size().height + kBottom + 8 + (index / per_row) * kEntryHeight);
    ++index;
    return place;
  };
  const auto entry = [&](const cv::Vec3b& colour, const std::string& text) {
    const cv::Point place = at();
    const cv::Rect swatch(place, cv::Size(kSwatch, kSwatch));
    cv::rectangle(*picture, swatch, cv::Scalar(colour[0], colour[1], colour[2]), cv::FILLED);
    Text(text, {place.x + kSwatch + 8, place.y + 13}, picture, 0.45);
  };
  entry(GreenOf(0, options), "traversable, level");
  entry(GreenOf(options.max_slope_rad, options),
        "traversable, " + Format("%.0f deg", options.max_slope_rad / kDegree));
  entry(Mix(kFlat, kUnknown, 0.6), "between such cells");
  entry(kObstacle, "obstacle");
  entry(kUnknown, "unknown");
  entry(kOverhead, "dot: overhang above");
  const cv::Point circle = at();
  cv::circle(*picture, {circle.x + 8, circle.y + 8}, 8, kInk, 2, cv::LINE_AA);
  Text("landing site, by rank", {circle.x + 24, circle.y + 13}, picture, 0.45);
}

cv::Mat StatePanel(const Terrain& terrain, const TerrainOptions& options, const View& view,
                   const std::string& frame) {
  const TerrainGrid& grid = terrain.grid;
  cv::Mat picture = Blank(view, 0);
  const auto colour_of = [&](std::size_t cell) {
    if (grid.state[cell] == CellState::kUnknown) return kUnknown;
    if (grid.state[cell] == CellState::kObstacle) return kObstacle;
    if (grid.interpolated[cell]) return Mix(kFlat, kUnknown, 0.6);
    return GreenOf(double{grid.slope_rad[cell]}, options);
  };
  DrawCells(view, colour_of, &picture);
  DrawOverhead(view, &picture);
  DrawSites(view, terrain.sites, &picture);
  DrawSensor(view, frame, &picture);
  DrawAxes(view, &picture);
  Text("terrain, frame " + frame + ", cells of " + Format("%.2g m", grid.cell_m), {kLeft, 30},
       &picture, 0.6);
  DrawLegend(view, options, &picture);
  return picture;
}

/// Which temperature [K] is which colour.
struct TemperatureScale {
  double low, high;
  cv::Mat_<cv::Vec3b> table;

  cv::Vec3b Colour(double kelvin) const {
    return table(
        static_cast<int>(std::lround(std::clamp((kelvin - low) / (high - low), 0.0, 1.0) * 255)));
  }
};

// From the 2nd to the 98th percentile, half a kelvin at least: noise is not blown up.
TemperatureScale ScaleOf(std::vector<float> values) {
  std::sort(values.begin(), values.end());
  TemperatureScale scale{double{values[values.size() / 50]},
                         double{values[values.size() - 1 - values.size() / 50]},
                         {}};
  scale.high = std::max(scale.high, scale.low + 0.5);
  cv::Mat_<uchar> grey(1, 256);
  for (int i = 0; i < 256; ++i) grey(i) = static_cast<uchar>(i);
  cv::applyColorMap(grey, scale.table, cv::COLORMAP_INFERNO);
  return scale;
}

void DrawBar(const TemperatureScale& scale, const View& view, cv::Mat* picture) {
  const int left = picture->cols - kBar + 4, height = view.size().height;
  for (int y = 0; y < height; ++y) {
    const cv::Vec3b c = scale.Colour(scale.high - (scale.high - scale.low) * y / height);
    cv::line(*picture, {left, kTop + y}, {left + 18, kTop + y}, cv::Scalar(c[0], c[1], c[2]));
  }
  for (int tick = 0; tick <= 4; ++tick) {
    const double kelvin = scale.low + (scale.high - scale.low) * tick / 4;
    const int y = kTop + height - height * tick / 4;
    Text(Fixed(kelvin - 273.15, 1), {left + 26, y + 5}, picture, 0.45);
  }
  Text("[C]", {left, kTop - 12}, picture, 0.45);
}

cv::Mat TemperaturePanel(const Terrain& terrain, const View& view, const std::string& frame,
                         const TemperatureScale& scale) {
  const TerrainGrid& grid = terrain.grid;
  cv::Mat picture = Blank(view, kBar);
  DrawCells(
      view,
      [&](std::size_t cell) {
        const float kelvin = grid.temperature_k[cell];
        return std::isfinite(kelvin) ? scale.Colour(double{kelvin}) : kUnknown;
      },
      &picture);
  DrawSites(view, terrain.sites, &picture);
  DrawSensor(view, frame, &picture);
  DrawAxes(view, &picture);
  DrawBar(scale, view, &picture);
  Text("temperature", {kLeft, 30}, &picture, 0.6);
  return picture;
}

}  // namespace

cv::Mat TerrainPicture(const Terrain& terrain, const TerrainOptions& options,
                       const std::string& frame) {
  const View view = ViewOf(terrain.grid);
  cv::Mat picture = StatePanel(terrain, options, view, frame);
  std::vector<float> warm;
  for (const float kelvin : terrain.grid.temperature_k) {
    if (std::isfinite(kelvin)) warm.push_back(kelvin);
  }
  if (warm.empty()) return picture;
  cv::hconcat(picture, TemperaturePanel(terrain, view, frame, ScaleOf(std::move(warm))), picture);
  return picture;
}

}  // namespace rgbdt
