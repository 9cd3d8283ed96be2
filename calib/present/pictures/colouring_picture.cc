#include "calib/present/pictures/colouring_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calib/solve/colouring.h"

namespace rgbdt {
namespace {

// On a phone the picture is shrunk to a third: capitals of 29 px are 9 there, as in a 12 px font.
constexpr int kMapWidth = 520, kGap = 20, kTitleHeight = 106;
constexpr int kBarHeight = 34, kBarTextHeight = 66, kUnitWidth = 80;
constexpr int kCell = 4;    // of a map, in pixels: how finely sigma is worked out
constexpr int kTones = 64;  // enough for the eye, and a quarter of the bytes of a smooth ramp
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kDistanceText = 1.7, kText = 1.35, kLabelText = 1.15;
constexpr int kStroke = 3;
constexpr float kLeastPx = 1e-3F;  // below it all are alike: a logarithm needs some bound
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
const cv::Scalar kInk = cv::Scalar::all(30), kPaper = cv::Scalar::all(255);
const cv::Vec3b kUnseen = cv::Vec3b::all(200);

using Field = cv::Mat_<float>;  // sigma [px] at each pixel of a map; NaN: beyond the lens model

struct Scale {
  float low = 0, high = 0;  // [px]
  cv::Mat_<cv::Vec3b> table;

  // 0 to 1. What tells sigmas apart is their ratio.
  float Share(float value) const {
    return std::clamp(std::log(value / low) / std::log(high / low), 0.0F, 1.0F);
  }
  cv::Vec3b Colour(float value) const {
    return table(static_cast<int>(std::lround(std::floor(Share(value) * kTones) * 255 / kTones)));
  }
};

cv::Size MapSize(const CameraSpec& camera) {
  const double height = static_cast<double>(kMapWidth) * camera.height / camera.width;
  return {kMapWidth, std::clamp(static_cast<int>(std::lround(height)), 60, 2 * kMapWidth)};
}

float SigmaAt(const Camera& camera, const PoseAndLensCovariance& covariance,
              const Eigen::Vector2d& pixel, double distance_m) {
  const auto sigma = ColouringSigmaAt(camera, covariance, pixel, distance_m);
  if (!sigma || !std::isfinite(*sigma)) return kNan;
  return std::max(kLeastPx, static_cast<float>(*sigma));
}

Field SigmaField(const Camera& camera, const PoseAndLensCovariance& covariance, double distance_m,
                 cv::Size map) {
  Field coarse(map.height / kCell, map.width / kCell);
  for (int y = 0; y < coarse.rows; ++y) {
    for (int x = 0; x < coarse.cols; ++x) {
      coarse(y, x) = SigmaAt(camera, covariance,
                             {(x + 0.5) * camera.width() / coarse.cols - 0.5,
                              (y + 0.5) * camera.height() / coarse.rows - 0.5},
                             distance_m);
    }
  }
  Field field;
  cv::resize(coarse, field, map, 0, 0, cv::INTER_CUBIC);
  return field;
}

// From the least to the largest of all maps, and at least a factor of two: no trifle blown up.
// Nothing where no map has a number.
std::optional<Scale> ScaleFor(const std::vector<Field>& fields) {
  Scale scale{std::numeric_limits<float>::max(), 0, {}};
  for (const Field& field : fields) {
    for (const float value : field) {
      if (std::isnan(value)) continue;
      scale.low = std::max(kLeastPx, std::min(scale.low, value));
      scale.high = std::max(scale.high, value);
    }
  }
  if (scale.high == 0) return std::nullopt;
  const float wider = std::sqrt(std::max(1.0F, 2 * scale.low / scale.high));
  scale.low /= wider;
  scale.high *= wider;
  cv::Mat_<unsigned char> grey(1, 256);
  for (int i = 0; i < 256; ++i) grey(i) = static_cast<unsigned char>(i);
  cv::applyColorMap(grey, scale.table, cv::COLORMAP_VIRIDIS);
  return scale;
}

// Round numbers on the scale, the fewer a decade the more decades it spans.
std::vector<float> Levels(const Scale& scale) {
  const float ratio = scale.high / scale.low;
  const std::vector<float> steps = ratio > 1000 ? std::vector<float>{1}
                                   : ratio > 30 ? std::vector<float>{1, 3}
                                                : std::vector<float>{1, 1.5F, 2, 3, 5, 7};
  std::vector<float> levels;
  for (int decade = -3; decade <= 9; ++decade) {
    for (const float step : steps) {
      const auto level = static_cast<float>(step * std::pow(10, decade));
      if (level > scale.low && level < scale.high) levels.push_back(level);
    }
  }
  return levels;
}

cv::Mat Paint(const Field& field, const Scale& scale) {
  cv::Mat_<cv::Vec3b> map(field.size());
  for (int y = 0; y < field.rows; ++y) {
    for (int x = 0; x < field.cols; ++x) {
      map(y, x) = std::isnan(field(y, x)) ? kUnseen : scale.Colour(field(y, x));
    }
  }
  return map;
}

// How many pixels of the map a place is from the line where sigma is `level`, to first order.
Field DistanceToLevel(const Field& field, float level) {
  Field across, down, steepness;
  cv::Sobel(field, across, CV_32F, 1, 0, 3, 1.0 / 8);
  cv::Sobel(field, down, CV_32F, 0, 1, 3, 1.0 / 8);
  cv::magnitude(across, down, steepness);
  Field distance(field.size());
  for (int y = 0; y < field.rows; ++y) {
    for (int x = 0; x < field.cols; ++x) {
      // On level ground there is no line.
      distance(y, x) =
          steepness(y, x) > 1e-5F * level ? std::abs(field(y, x) - level) / steepness(y, x) : kNan;
    }
  }
  return distance;
}

void DrawLine(const Field& distance, cv::Mat* map) {
  constexpr float kHalfWidth = 1.2F;
  for (int y = 0; y < map->rows; ++y) {
    for (int x = 0; x < map->cols; ++x) {
      const float cover = kHalfWidth + 0.5F - distance(y, x);
      if (!(cover > 0)) continue;  // NaN, too
      cv::Vec3b& pixel = map->at<cv::Vec3b>(y, x);
      pixel = pixel + std::min(1.0F, cover) * (cv::Vec3b::all(255) - pixel);
    }
  }
}

// As in the table: two decimals, fewer where they mean nothing.
std::string Px(double value) {
  if (!std::isfinite(value)) return "-";
  return fmt::format("{:.{}f}", value, value >= 9.95 ? 0 : value >= 0.995 ? 1 : 2);
}

std::string LevelText(float level) { return fmt::format("{:g}", level); }

cv::Size SizeOf(const std::string& text, double size) {
  int base = 0;
  return cv::getTextSize(text, kFont, size, kStroke, &base);
}

void Write(const std::string& text, cv::Point at, double size, const cv::Scalar& colour,
           cv::Mat* picture) {
  cv::putText(*picture, text, at, kFont, size, colour, kStroke, cv::LINE_AA);
}

double Between(const cv::Rect& a, const cv::Rect& b) {
  const int dx = std::max({a.x - b.br().x, b.x - a.br().x, 0});
  const int dy = std::max({a.y - b.br().y, b.y - a.br().y, 0});
  return std::hypot(dx, dy);
}

// A box on the line, inside the map, as far from the others as can be. Nothing where none fits.
std::optional<cv::Rect> PlaceFor(cv::Size box, const Field& distance,
                                 const std::vector<cv::Rect>& taken) {
  constexpr int kMargin = 12;
  std::optional<cv::Rect> best;
  double best_room = kMargin;
  const cv::Size half = box / 2;
  for (int y = kMargin + half.height; y < distance.rows - kMargin - half.height; ++y) {
    for (int x = kMargin + half.width; x < distance.cols - kMargin - half.width; ++x) {
      if (!(distance(y, x) < 0.5F)) continue;
      const cv::Rect here(cv::Point(x - half.width, y - half.height), box);
      double room = distance.cols;
      for (const cv::Rect& other : taken) room = std::min(room, Between(here, other));
      if (room <= best_room) continue;
      best = here;
      best_room = room;
    }
  }
  return best;
}

// White on dark: legible on every colour.
void DrawLabel(const std::string& text, const cv::Rect& box, int pad, cv::Mat* map) {
  cv::rectangle(*map, box, kInk, cv::FILLED);
  Write(text, {box.x + pad, box.br().y - pad}, kLabelText, kPaper, map);
}

cv::Mat DrawMap(const Field& field, const Scale& scale) {
  constexpr int kPad = 7;
  cv::Mat map = Paint(field, scale);
  std::vector<Field> distances;
  const std::vector<float> levels = Levels(scale);
  for (const float level : levels) {
    distances.push_back(DistanceToLevel(field, level));
    DrawLine(distances.back(), &map);
  }
  std::vector<cv::Rect> taken;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const std::string text = LevelText(levels[i]);
    const cv::Size box = SizeOf(text, kLabelText) + cv::Size(2 * kPad, 2 * kPad);
    const auto place = PlaceFor(box, distances[i], taken);
    if (!place) continue;
    DrawLabel(text, *place, kPad, &map);
    taken.push_back(*place);
  }
  cv::rectangle(map, {0, 0}, {map.cols - 1, map.rows - 1}, kInk, 2);
  return map;
}

void DrawTicks(const Scale& scale, const cv::Rect& bar, cv::Mat* picture) {
  int free_from = 0;
  for (const float level : Levels(scale)) {
    const int x = bar.x + static_cast<int>(std::lround(scale.Share(level) * bar.width));
    cv::line(*picture, {x, bar.y}, {x, bar.br().y + 8}, kInk, 2);
    const int left = x - SizeOf(LevelText(level), kText).width / 2;
    if (left < free_from) continue;
    Write(LevelText(level), {left, bar.br().y + 50}, kText, kInk, picture);
    free_from = 2 * x - left + 16;
  }
}

void DrawBar(const Scale& scale, const cv::Rect& bar, cv::Mat* picture) {
  for (int x = 0; x < bar.width; ++x) {
    const cv::Vec3b c = scale.table(255 * x / (bar.width - 1));
    cv::line(*picture, {bar.x + x, bar.y}, {bar.x + x, bar.br().y}, cv::Scalar(c[0], c[1], c[2]));
  }
  cv::rectangle(*picture, bar, kInk, 2);
  DrawTicks(scale, bar, picture);
  Write("px", {bar.br().x + 14, bar.br().y - 6}, kText, kInk, picture);
}

void DrawTitle(const ColouringSigma& at, cv::Point corner, cv::Mat* picture) {
  constexpr int kSecondColumn = 175;
  const auto write = [&](const std::string& text, int x, int y, double size) {
    Write(text, corner + cv::Point(x, y), size, kInk, picture);
  };
  write(fmt::format("{:g} m", at.distance_m), 0, 68, kDistanceText);
  write("middle " + Px(at.centre_px) + " px", kSecondColumn, 40, kText);
  write("worst " + Px(at.worst_px) + " px", kSecondColumn, 88, kText);
}

cv::Mat Arrange(const std::vector<ColouringSigma>& sigmas, const std::vector<Field>& fields,
                const Scale& scale) {
  const cv::Size map = fields[0].size();
  const int step_x = map.width + kGap;
  const int step_y = kTitleHeight + map.height + kGap;
  cv::Mat picture(2 * step_y + kGap + kBarHeight + kBarTextHeight, 2 * step_x + kGap, CV_8UC3,
                  kPaper);
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const cv::Point corner(kGap + static_cast<int>(i % 2) * step_x,
                           static_cast<int>(i / 2) * step_y);
    DrawTitle(sigmas[i], corner, &picture);
    DrawMap(fields[i], scale).copyTo(picture(cv::Rect(corner + cv::Point(0, kTitleHeight), map)));
  }
  const int width = picture.cols - 2 * kGap - kUnitWidth;
  DrawBar(scale, {kGap, 2 * step_y + kGap / 2, width, kBarHeight}, &picture);
  return picture;
}

}  // namespace

cv::Mat ColouringPicture(const CameraSpec& spec, const CameraCalibration& calibration) {
  if (!calibration.covariance) return {};
  const Camera camera(calibration.WithSolvedLens(spec));
  const PoseAndLensCovariance covariance = calibration.PoseAndLens();
  const std::vector<ColouringSigma> sigmas = SigmaOf(spec, calibration).colouring;
  std::vector<Field> fields;
  fields.reserve(sigmas.size());
  for (const ColouringSigma& sigma : sigmas) {
    fields.push_back(SigmaField(camera, covariance, sigma.distance_m, MapSize(spec)));
  }
  const auto scale = ScaleFor(fields);
  return scale ? Arrange(sigmas, fields, *scale) : cv::Mat();
}

}  // namespace rgbdt
