#include "calib/files/points/internal/fused_comments.h"

#include <charconv>
#include <cmath>

#include "calib/files/points/internal/record_table.h"
#include "calib/model/errors.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

using Words = std::vector<std::string_view>;

constexpr std::size_t kMaxCameras = 32;  // bits of `valid`

// One word in one line, whatever a camera is called.
std::string Word(std::string name) {
  for (char& c : name) {
    if (static_cast<unsigned char>(c) <= ' ' || c == 0x7f) c = '?';
  }
  return name.empty() ? "?" : name;
}

std::string PoseComment(const Rigid3& map_from_lidar, Utime frame_utime) {
  const Eigen::Quaterniond& q = map_from_lidar.rotation;
  std::string text = "rgbdt map_from_lidar quaternion_wxyz";
  for (const double value : {q.w(), q.x(), q.y(), q.z()}) text += " " + Exact(value);
  text += " translation_m";
  for (const double value : map_from_lidar.translation) text += " " + Exact(value);
  return text + " frame_utime " + std::to_string(frame_utime);
}

class Reader {
 public:
  Reader(const std::string& comment, const std::string& where, RgbdtCloud* cloud)
      : comment_(comment), where_(where), cloud_(*cloud) {}

  void Take() {
    const Words words = records::Words(comment_);
    if (words.size() < 2 || words[0] != "rgbdt") return;
    if (words[1] == "sweep_utime") {
      cloud_.sweep_utime = Time(At(words, 2));
    } else if (words[1] == "sweep_end") {
      cloud_.sweep_end = Time(At(words, 2)) != 0;
    } else if (words[1] == "whole_sweep") {
      cloud_.whole_sweep = Time(At(words, 2)) != 0;
    } else if (words[1] == "valid_bit") {
      TakeCamera(words);
    } else if (words[1] == "map_from_lidar") {
      TakePose(words);
    }  // a later version may say more
  }

 private:
  void TakeCamera(const Words& words) {
    if (Time(At(words, 2)) != static_cast<Utime>(cloud_.cameras.size()) ||
        cloud_.cameras.size() >= kMaxCameras) {
      Fail("bit " + std::to_string(cloud_.cameras.size()) + ", and 32 cameras at most");
    }
    if (At(words, 3) != "camera" || At(words, 5) != "calibration_utime") {
      Fail("camera NAME calibration_utime TIME");
    }
    cloud_.cameras.emplace_back(words[4]);
    cloud_.calibration_utime.push_back(Time(At(words, 6)));
  }

  void TakePose(const Words& words) {
    if (At(words, 2) != "quaternion_wxyz" || At(words, 7) != "translation_m" ||
        At(words, 11) != "frame_utime") {
      Fail("quaternion_wxyz W X Y Z translation_m X Y Z frame_utime TIME");
    }
    Rigid3 pose{{Number(words[3]), Number(words[4]), Number(words[5]), Number(words[6])},
                {Number(words[8]), Number(words[9]), Number(words[10])}};
    const double squared = pose.rotation.squaredNorm();
    if (!(std::abs(squared - 1) < 2e-3)) Fail("a unit quaternion");
    // What was normalised to rounding stays as it is, to the bit.
    if (!(std::abs(squared - 1) < 1e-14)) pose.rotation.normalize();
    cloud_.map_from_lidar = pose;
    cloud_.frame_utime = Time(At(words, 12));
  }

  std::string_view At(const Words& words, std::size_t index) const {
    if (index >= words.size()) Fail("more words");
    return words[index];
  }
  Utime Time(std::string_view word) const {
    constexpr Utime kMost = 4'000'000'000'000'000'000;  // points' times are added to it
    Utime value = 0;
    if (!records::ParseNumber(word, &value) || value < 0 || value > kMost) {
      Fail("a whole number from 0 to " + std::to_string(kMost));
    }
    return value;
  }
  double Number(std::string_view word) const {
    double value = 0;
    if (!records::ParseNumber(word, &value) || !std::isfinite(value)) Fail("finite numbers");
    return value;
  }
  [[noreturn]] void Fail(const std::string& expected) const {
    throw InputError(where_ + ": comment \"" + comment_.substr(0, 200) + "\"; expected " +
                     expected);
  }

  const std::string& comment_;
  const std::string& where_;
  RgbdtCloud& cloud_;
};

}  // namespace

std::vector<std::string> FusedComments(const RgbdtCloud& cloud) {
  std::vector<std::string> comments = {
      "LIDAR frame: x forward, y left, z up [m]; utime [us, UTC]; temperature, temperature_sigma "
      "[K]; NaN: unknown",
      "rgbdt sweep_utime " + std::to_string(cloud.sweep_utime),
      std::string("rgbdt sweep_end ") + (cloud.sweep_end ? "1" : "0"),
      std::string("rgbdt whole_sweep ") + (cloud.whole_sweep ? "1" : "0")};
  for (std::size_t i = 0; i < cloud.cameras.size(); ++i) {
    comments.push_back("rgbdt valid_bit " + std::to_string(i) + " camera " +
                       Word(cloud.cameras[i]) + " calibration_utime " +
                       std::to_string(cloud.calibration_utime[i]));
  }
  if (cloud.map_from_lidar) {
    comments.push_back(PoseComment(*cloud.map_from_lidar, cloud.frame_utime));
  }
  return comments;
}

void ReadFusedComments(const std::vector<std::string>& comments, const std::string& where,
                       RgbdtCloud* cloud) {
  for (const std::string& comment : comments) Reader(comment, where, cloud).Take();
}

}  // namespace rgbdt
