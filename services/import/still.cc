#include "services/import/still.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "calib/camera/pixels.h"
#include "calib/detect/image/checkerboard.h"
#include "calib/model/errors.h"
#include "calib/model/view_detection.h"
#include "services/import/import_bag.h"

namespace rgbdt {
namespace {

constexpr Utime kLookEvery = kMicrosecondsPerSecond;
constexpr Utime kLongestGap = 3 * kMicrosecondsPerSecond / 2;  // of looks that are compared

double Rms(const BoardLook& a, const BoardLook& b, bool half_turn) {
  const std::size_t n = a.corners.size();
  double sum = 0;
  std::size_t both = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector2d& other = b.corners[half_turn ? n - 1 - i : i];
    if (!IsSeen(a.corners[i]) || !IsSeen(other)) continue;
    sum += (a.corners[i] - other).squaredNorm();
    ++both;
  }
  return 2 * both < n ? std::numeric_limits<double>::infinity()
                      : std::sqrt(sum / static_cast<double>(both));
}

class Watch {
 public:
  Watch(BagReader* bag, const TopicChoice::Camera& camera, const CameraSpec& spec,
        const Target& board)
      : bag_(bag), camera_(camera), spec_(spec), board_(board) {}

  void Look(std::size_t index) {
    std::optional<BoardLook> look = LookAt(index);
    const bool stands = look && last_ && StoodStill(*last_, last_index_, *look, index);
    if (stands) {
      stand_.push_back(*look);
    } else {
      EndStand();
      if (look) stand_ = {*look};
    }
    last_ = std::move(look);
    last_index_ = index;
  }

  // The looks in the middle of stands, and their times.
  void EndStand() {
    if (stand_.size() >= 2) {
      stands_.push_back(stand_[stand_.size() / 2]);
      stands_.back().utime = (stand_.front().utime + stand_.back().utime) / 2;
    }
    stand_.clear();
  }

  const std::vector<BoardLook>& stands() const { return stands_; }
  StillMoments found;

 private:
  std::optional<BoardLook> LookAt(std::size_t index) {
    const Stamped& stamped = camera_.images->stamped[index];
    ++found.looks;
    try {
      const Image image = ReadImage(bag_, camera_, spec_, stamped);
      CheckerboardResult result = FindCheckerboard(ToGrey(image), board_, SaturatedFrom(image));
      if (result.board) {
        ++found.found;
        return BoardLook{stamped.utime, std::move(result.board->corners)};
      }
      found.why = result.why;
    } catch (const InputError& error) {
      found.why = error.what();
    }
    return std::nullopt;
  }

  bool StoodStill(const BoardLook& a, std::size_t a_index, const BoardLook& b,
                  std::size_t b_index) {
    if (b.utime - a.utime > kLongestGap || Moved(a, b) > kStillForSecondPx) return false;
    const std::size_t between = (a_index + b_index) / 2;
    if (between == a_index) return true;
    const std::optional<BoardLook> look = LookAt(between);
    return look && Moved(a, *look) <= kStillForSecondPx;
  }

  BagReader* bag_;
  const TopicChoice::Camera& camera_;
  const CameraSpec& spec_;
  const Target& board_;
  std::optional<BoardLook> last_;
  std::size_t last_index_ = 0;
  std::vector<BoardLook> stand_, stands_;
};

}  // namespace

double Moved(const BoardLook& a, const BoardLook& b) {
  if (a.corners.size() != b.corners.size()) return std::numeric_limits<double>::infinity();
  return std::min(Rms(a, b, false), Rms(a, b, true));
}

std::vector<std::size_t> SpreadOver(const std::vector<BoardLook>& looks, int image_width,
                                    std::size_t views) {
  const double least_px = 0.005 * image_width;
  std::vector<std::size_t> chosen;
  std::vector<double> apart(looks.size(), std::numeric_limits<double>::infinity());
  std::size_t next = 0;
  while (chosen.size() < std::min(views, looks.size()) && apart[next] > least_px) {
    chosen.push_back(next);
    for (std::size_t i = 0; i < looks.size(); ++i) {
      apart[i] = std::min(apart[i], i == next ? 0 : Moved(looks[i], looks[next]));
    }
    next = static_cast<std::size_t>(std::max_element(apart.begin(), apart.end()) - apart.begin());
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

StillMoments FindStillMoments(BagReader* bag, const TopicChoice::Camera& camera,
                              const CameraSpec& spec, const Target& board, std::size_t views,
                              const std::function<void(double)>& progress) {
  Watch watch(bag, camera, spec, board);
  const std::vector<Stamped>& stamped = camera.images->stamped;
  Utime next = stamped.front().utime;
  for (std::size_t i = 0; i < stamped.size(); ++i) {
    if (stamped[i].utime < next) continue;
    next = stamped[i].utime + kLookEvery;
    watch.Look(i);
    if (progress) progress(static_cast<double>(i + 1) / static_cast<double>(stamped.size()));
  }
  watch.EndStand();
  StillMoments still = std::move(watch.found);
  still.stands = watch.stands().size();
  if (still.stands == 0) return still;
  for (const std::size_t index : SpreadOver(watch.stands(), spec.width, views)) {
    still.times.push_back(watch.stands()[index].utime);
  }
  return still;
}

}  // namespace rgbdt
