#pragma once

// What the tests of calib/files share: a folder that goes away, and a rig, view and report with
// every field set to something.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <opencv2/core.hpp>
#include <string>

#include "calib/model/calibration.h"
#include "calib/model/errors.h"
#include "calib/model/map_cloud.h"
#include "calib/model/rgbdt_cloud.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"

namespace rgbdt::test {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr Utime kNow = 1'700'000'000'123'457;  // odd: a float would not hold it

/// A folder of its own, removed at the end.
class TempDir {
 public:
  TempDir() {
    std::string pattern = (std::filesystem::temp_directory_path() / "rgbdt-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("mkdtemp failed");
    path_ = pattern;
  }
  TempDir(const TempDir&) = delete;
  TempDir& operator=(const TempDir&) = delete;
  ~TempDir() { std::filesystem::remove_all(path_); }

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Without the syncing that makes thousands of writes slow.
inline void WriteQuickly(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

/// The message of the InputError that `run` throws; "" with a failure where it throws none.
template <typename Run>
std::string ErrorOf(Run run) {
  try {
    run();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos)
        << "more than one line: " << error.what();
    return error.what();
  }
  ADD_FAILURE() << "no InputError";
  return {};
}

/// Runs `parse` on every beginning of `bytes` (at most `most`, evenly spread): it must return or
/// throw InputError, nothing else.
template <typename Parse>
void ParseTruncations(const std::string& bytes, Parse parse, std::size_t most = 400) {
  const std::size_t step = std::max<std::size_t>(1, bytes.size() / most);
  for (std::size_t size = 0; size < bytes.size(); size += step) {
    try {
      parse(bytes.substr(0, size));
    } catch (const InputError&) {
    }
  }
}

/// The same on copies with single bytes changed.
template <typename Parse>
void ParseDamaged(const std::string& bytes, Parse parse, std::size_t most = 400) {
  const std::size_t step = std::max<std::size_t>(1, bytes.size() / most);
  for (std::size_t at = 0; at < bytes.size(); at += step) {
    for (const int change : {0x01, 0x80, 0xFF}) {
      std::string damaged = bytes;
      damaged[at] = static_cast<char>(damaged[at] ^ change);
      try {
        parse(damaged);
      } catch (const InputError&) {
      }
    }
  }
}

Rigid3 MakePose(double angle, const Eigen::Vector3d& translation);
Rig MakeRig();
Cloud MakeCloud();
View MakeView();
RangeErrors MakeRangeErrors();
Report MakeReport();
RgbdtCloud MakeRgbdtCloud(int columns = 60, int rows = 40);
MapCloud MakeMap();  ///< two voxels

void ExpectSame(const Rigid3& a, const Rigid3& b);
void ExpectSame(const Cloud& a, const Cloud& b);

}  // namespace rgbdt::test
