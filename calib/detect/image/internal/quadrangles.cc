#include "calib/detect/image/internal/quadrangles.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "calib/camera/pixels.h"
#include "calib/model/rigid3.h"

namespace rgbdt {
namespace {

constexpr double kShrunkPx = 800;     // longer side of the shrunk image
constexpr int kLevels = 16;           // of grey values, and as many of their ranks
constexpr double kBendPx = 2.5;       // of the shrunk image: an outline's deviation from a line
constexpr double kLeastPiecePx = 12;  // of the shrunk image, as the next
constexpr double kLeastLinePx = 25;
constexpr double kLeastSize = 0.12;  // of an outline, of the image's shorter side
constexpr std::size_t kMostLines = 9;
constexpr std::size_t kMostQuadrangles = 20;

// A shrunk image and the way back.
struct Shrunk {
  cv::Mat grey;
  double scale = 1;

  Eigen::Vector2d Full(const Eigen::Vector2d& p) const { return (p.array() + 0.5) / scale - 0.5; }
  bool OnBorder(const cv::Point& p) const {
    return p.x < 2 || p.y < 2 || p.x > grey.cols - 3 || p.y > grey.rows - 3;
  }
};

double ScaleOf(const cv::Size& size) {
  return std::min(1.0, kShrunkPx / std::max(size.width, size.height));
}

Shrunk Shrink(const cv::Mat& grey) {
  Shrunk out;
  out.scale = ScaleOf(grey.size());
  cv::resize(grey, out.grey, {}, out.scale, out.scale, cv::INTER_AREA);
  cv::GaussianBlur(out.grey, out.grey, {}, 1.0);
  return out;
}

// Evenly spaced in value and in rank.
std::vector<float> LevelsOf(const cv::Mat& grey) {
  const float low = Percentile(grey, 0.02);
  const float high = Percentile(grey, 0.98);
  std::vector<float> levels;
  for (int i = 1; i <= kLevels; ++i) {
    const float share = static_cast<float>(i) / (kLevels + 1);
    levels.push_back(low + share * (high - low));
    levels.push_back(Percentile(grey, share));
  }
  return levels;
}

// A straight piece of an outline, in a plane before the camera where straight lines are straight.
struct Line {
  Eigen::Vector2d from, to;           // its ends on the fitted line
  std::array<Eigen::Vector2d, 2> px;  // the outline there, full image
  double length = 0;                  // [px] of the shrunk image, as `from` and `to`
};

// An outline seen in that plane, in shrunk pixels about its middle.
struct FlatOutline {
  Eigen::Matrix3d camera_from_flat;
  double focal = 1;
  std::vector<cv::Point2f> points;
  std::vector<Eigen::Vector2d> px;
  std::vector<bool> border;

  Eigen::Vector3d Direction(const Eigen::Vector2d& p) const {
    return (camera_from_flat * Eigen::Vector3d(p.x() / focal, p.y() / focal, 1)).normalized();
  }
};

std::optional<FlatOutline> Flatten(const Shrunk& shrunk, const Camera& camera,
                                   const std::vector<cv::Point>& outline) {
  FlatOutline flat;
  std::vector<Eigen::Vector3d> directions;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const cv::Point& p : outline) {
    const Eigen::Vector2d px = shrunk.Full({p.x, p.y});
    const auto direction = camera.Unproject(px);
    if (!direction) continue;
    directions.push_back(*direction);
    middle += *direction;
    flat.px.push_back(px);
    flat.border.push_back(shrunk.OnBorder(p));
  }
  if (!(middle.norm() > 1e-6)) return std::nullopt;
  flat.camera_from_flat = RotationBetween(Eigen::Vector3d::UnitZ(), middle).toRotationMatrix();
  flat.focal = shrunk.scale * 0.5 * (camera.lens().fx + camera.lens().fy);
  for (const Eigen::Vector3d& d : directions) {
    const Eigen::Vector3d f = flat.camera_from_flat.transpose() * d;
    if (f.z() < 0.2) return std::nullopt;  // too wide to be a board
    flat.points.emplace_back(static_cast<float>(flat.focal * f.x() / f.z()),
                             static_cast<float>(flat.focal * f.y() / f.z()));
  }
  return flat;
}

Eigen::Vector2d ToVector(const cv::Point2f& p) { return {p.x, p.y}; }

// The line through the outline from one place to another, their neighbourhood left out.
std::optional<Line> LineBetween(const FlatOutline& flat, std::size_t from, std::size_t count) {
  const std::size_t n = flat.points.size();
  const std::size_t leave = std::max<std::size_t>(2, count / 20);
  if (count < 2 * leave + 8) return std::nullopt;
  std::vector<cv::Point2f> inside;
  std::size_t border = 0;
  for (std::size_t i = leave; i + leave <= count; ++i) {
    const std::size_t k = (from + i) % n;
    border += flat.border[k] ? 1 : 0;
    inside.push_back(flat.points[k]);
  }
  if (10 * border > inside.size()) return std::nullopt;
  cv::Vec4f fit;
  cv::fitLine(inside, fit, cv::DIST_HUBER, 0, 0.01, 0.01);
  const Eigen::Vector2d along(fit[0], fit[1]);
  const Eigen::Vector2d at(fit[2], fit[3]);
  const auto onto = [&](const cv::Point2f& p) {
    return Eigen::Vector2d(at + along * along.dot(ToVector(p) - at));
  };
  Line line;
  line.from = onto(inside.front());
  line.to = onto(inside.back());
  line.px = {flat.px[(from + leave) % n], flat.px[(from + count - leave) % n]};
  line.length = (line.to - line.from).norm();
  if (line.length < kLeastPiecePx) return std::nullopt;
  return line;
}

// Whether a piece goes on where a longer line leaves off, or did before it began.
bool Continues(const Line& line, const Line& piece) {
  const Eigen::Vector2d along = (line.to - line.from).normalized();
  const auto across = [&](const Eigen::Vector2d& p) {
    const Eigen::Vector2d off = p - line.from;
    return std::abs(off.x() * along.y() - off.y() * along.x());
  };
  return along.dot(piece.to - piece.from) > 0 && across(piece.from) < kBendPx &&
         across(piece.to) < kBendPx;
}

// The line from the first end of both to the last one.
Line Joined(const Line& line, const Line& piece) {
  const Eigen::Vector2d along = (line.to - line.from).normalized();
  Line out = line;
  if (along.dot(piece.from - line.from) < 0) {
    out.from = piece.from;
    out.px[0] = piece.px[0];
  }
  if (along.dot(piece.to - line.to) > 0) {
    out.to = piece.to;
    out.px[1] = piece.px[1];
  }
  out.length += piece.length;
  return out;
}

// What stands before a side, or sticks to it, leaves pieces of one line: joined, at the place of
// the longest.
std::vector<Line> JoinPieces(const std::vector<Line>& pieces) {
  std::vector<std::size_t> order(pieces.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return pieces[a].length > pieces[b].length;
  });
  std::map<std::size_t, Line> lines;  // by the place of the longest piece
  for (const std::size_t i : order) {
    const auto longer = std::find_if(lines.begin(), lines.end(), [&](const auto& line) {
      return Continues(line.second, pieces[i]);
    });
    if (longer == lines.end()) {
      lines.emplace(i, pieces[i]);
    } else {
      longer->second = Joined(longer->second, pieces[i]);
    }
  }
  std::vector<Line> out;
  for (const auto& [place, line] : lines) {
    if (line.length >= kLeastLinePx) out.push_back(line);
  }
  return out;
}

// The straight lines of an outline in order round it, the longest ones.
std::vector<Line> LinesOf(const FlatOutline& flat) {
  std::vector<cv::Point2f> bends;
  cv::approxPolyDP(flat.points, bends, kBendPx, true);
  std::vector<std::size_t> at;  // the bends go round with the outline, from any of its points
  for (const cv::Point2f& bend : bends) {
    const std::size_t n = flat.points.size();
    const std::size_t from = at.empty() ? 0 : at.back() + 1;
    for (std::size_t i = 0; i < n; ++i) {
      if (flat.points[(from + i) % n] != bend) continue;
      at.push_back((from + i) % n);
      break;
    }
  }
  std::vector<Line> lines;
  for (std::size_t k = 0; k < at.size(); ++k) {
    const std::size_t next = at[(k + 1) % at.size()];
    const std::size_t n = flat.points.size();
    const auto line = LineBetween(flat, at[k], (next + n - at[k]) % n);
    if (line) lines.push_back(*line);
  }
  lines = JoinPieces(lines);
  if (lines.size() <= kMostLines) return lines;
  std::vector<double> lengths;
  for (const Line& line : lines) lengths.push_back(line.length);
  std::nth_element(lengths.begin(), lengths.begin() + kMostLines - 1, lengths.end(),
                   std::greater<>());
  const double least = lengths[kMostLines - 1];
  lines.erase(std::remove_if(lines.begin(), lines.end(),
                             [&](const Line& line) { return line.length < least; }),
              lines.end());
  return lines;
}

std::optional<Eigen::Vector2d> Meet(const Line& a, const Line& b) {
  const Eigen::Vector2d along = (a.to - a.from).normalized();
  const Eigen::Vector2d other = (b.to - b.from).normalized();
  const double sine = along.x() * other.y() - along.y() * other.x();
  if (std::abs(sine) < 0.15) return std::nullopt;
  const Eigen::Vector2d off = b.from - a.from;
  return a.from + (off.x() * other.y() - off.y() * other.x()) / sine * along;
}

// Four lines in order round an outline; nothing where they do not bound a convex quadrangle of
// which each is a side in part.
std::optional<Quadrangle> QuadrangleOf(const FlatOutline& flat, std::array<const Line*, 4> lines) {
  std::array<Eigen::Vector2d, 4> corners;  // where a line begins
  for (std::size_t i = 0; i < 4; ++i) {
    const auto corner = Meet(*lines[(i + 3) % 4], *lines[i]);
    if (!corner) return std::nullopt;
    corners[i] = *corner;
  }
  double turn = 0;
  Quadrangle out;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d side = corners[(i + 1) % 4] - corners[i];
    const Eigen::Vector2d next = corners[(i + 2) % 4] - corners[(i + 1) % 4];
    const double sine = side.x() * next.y() - side.y() * next.x();
    if (sine * turn < 0 || sine == 0) return std::nullopt;
    turn = sine;
    const double length = side.norm();
    const double from = side.dot(lines[i]->from - corners[i]) / length;
    const double to = side.dot(lines[i]->to - corners[i]) / length;
    const double slack = 0.04 * length + 2;
    if (from > to || from < -slack || to > length + slack || to - from < 0.2 * length) {
      return std::nullopt;
    }
    out.corners[i] = flat.Direction(corners[i]);
    out.seen[i] = lines[i]->px;
    out.seen_px += lines[i]->length;
  }
  if (turn > 0) return out;  // y is down: clockwise
  std::reverse(out.corners.begin() + 1, out.corners.end());
  std::reverse(out.seen.begin(), out.seen.end());
  for (auto& seen : out.seen) std::swap(seen[0], seen[1]);
  return out;
}

bool MoreIsSeen(const Quadrangle& a, const Quadrangle& b) { return a.seen_px > b.seen_px; }

// Of an outline, those of which most is seen: what sticks to a board has lines of its own.
std::vector<Quadrangle> QuadranglesOf(const FlatOutline& flat) {
  constexpr std::size_t kOfOne = 3;
  const std::vector<Line> lines = LinesOf(flat);
  std::vector<Quadrangle> found;
  const std::size_t n = lines.size();
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = a + 1; b < n; ++b) {
      for (std::size_t c = b + 1; c < n; ++c) {
        for (std::size_t d = c + 1; d < n; ++d) {
          const auto one = QuadrangleOf(flat, {&lines[a], &lines[b], &lines[c], &lines[d]});
          if (one) found.push_back(*one);
        }
      }
    }
  }
  std::stable_sort(found.begin(), found.end(), MoreIsSeen);
  if (found.size() > kOfOne) found.resize(kOfOne);
  return found;
}

// The same outline at two levels.
bool Same(const Quadrangle& a, const Quadrangle& b) {
  constexpr double kNear = 0.01;  // [rad]
  for (std::size_t turn = 0; turn < 4; ++turn) {
    double most = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      most = std::max(most, (a.corners[i] - b.corners[(i + turn) % 4]).norm());
    }
    if (most < kNear) return true;
  }
  return false;
}

void AddFrom(const Shrunk& shrunk, const Camera& camera, const cv::Mat& mask,
             std::vector<Quadrangle>* found) {
  std::vector<std::vector<cv::Point>> outlines;
  cv::findContours(mask, outlines, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
  const double least = kLeastSize * std::min(mask.cols, mask.rows);
  for (const std::vector<cv::Point>& outline : outlines) {
    if (static_cast<double>(outline.size()) < 3 * least) continue;
    const cv::Rect box = cv::boundingRect(outline);
    if (std::min(box.width, box.height) < least) continue;
    const auto flat = Flatten(shrunk, camera, outline);
    if (!flat) continue;
    const std::vector<Quadrangle> quadrangles = QuadranglesOf(*flat);
    found->insert(found->end(), quadrangles.begin(), quadrangles.end());
  }
}

}  // namespace

double QuadrangleSigmaPx(const cv::Mat& grey) { return 1.0 / ScaleOf(grey.size()); }

std::vector<Quadrangle> FindQuadrangles(const cv::Mat& plane, const Camera& camera) {
  const Shrunk shrunk = Shrink(plane);
  std::vector<Quadrangle> all;
  for (const float level : LevelsOf(shrunk.grey)) {
    AddFrom(shrunk, camera, shrunk.grey > level, &all);  // its holes are what is darker
  }
  std::stable_sort(all.begin(), all.end(), MoreIsSeen);
  std::vector<Quadrangle> kept;
  for (const Quadrangle& q : all) {
    if (kept.size() == kMostQuadrangles) break;
    if (std::none_of(kept.begin(), kept.end(), [&](const auto& k) { return Same(k, q); })) {
      kept.push_back(q);
    }
  }
  return kept;
}

}  // namespace rgbdt
