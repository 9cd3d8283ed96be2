// Lines and encoder readings to clouds, one line after the other: by the assembler's node, all that
// it does; and as a user would by PCL or Eigen.
#include <pcl/common/transforms.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <cmath>
#include <memory>
#include <stdexcept>
#include <vector>

#include "calib/scan_assembly/encoder_track.h"
#include "calib/scan_assembly/line_to_cloud.h"
#include "services/nodes/assembler_node.h"
#include "tests/bench/measure.h"
#include "tests/bench/stages.h"
#include "tests/bench/turning_scanner.h"
#include "tests/numbers.h"

namespace rgbdt::bench {
namespace {

constexpr int kReadingsPerLine = TurningScanner::kLinePeriod / TurningScanner::kReadingPeriod;

// The scanner's messages without end, in the order in which they are sent: a sweep's lines are
// made once and sent again with a new time.
class LineStream {
 public:
  LineStream() {
    for (int n = 0; n < TurningScanner::kSweepLines; ++n) lines_.emplace_back(scanner_.Line(n));
  }

  EncoderReading FirstReading() const { return scanner_.Reading(0); }

  // The next line's readings but for the last; the line; its last reading.
  template <typename Take>
  void Next(const Take& take) {
    for (int k = 1; k < kReadingsPerLine; ++k) take(Reading(k));
    Message& message = lines_[static_cast<std::size_t>(number_ % TurningScanner::kSweepLines)];
    auto& line = std::get<LineScan>(message);
    line.utime = kJune2015 + number_ * TurningScanner::kLinePeriod;
    line.seq = number_;
    take(message);
    take(Reading(kReadingsPerLine));
    ++number_;
  }

 private:
  Message Reading(int k) const { return scanner_.Reading(number_ * kReadingsPerLine + k); }

  TurningScanner scanner_{kJune2015};
  Messages lines_;
  std::int64_t number_ = 0;
};

// Takes a line and its readings.
using TakeMessage = std::function<void(const Message&)>;

std::function<void()> ForLines(std::int64_t points, const TakeMessage& take) {
  const auto stream = std::make_shared<LineStream>();
  take(stream->FirstReading());
  const std::int64_t lines = points / TurningScanner::kBeams;
  return [=] {
    for (std::int64_t n = 0; n < lines; ++n) stream->Next(take);
  };
}

std::function<void()> ByNode(std::int64_t points) {
  const auto node = std::make_shared<AssemblerNode>();
  node->Handle(MakeBenchRig().text);
  return ForLines(points, [node](const Message& message) {
    Messages out = node->Handle(message);
    benchmark::DoNotOptimize(out);
  });
}

// Keeps the track that lines are put on; what is done with a line comes when its angles are known.
template <typename LineWork>
std::function<void()> OnTrack(std::int64_t points, const LineWork& work) {
  const auto track = std::make_shared<EncoderTrack>();
  const auto waiting = std::make_shared<const LineScan*>(nullptr);
  return ForLines(points, [=](const Message& message) {
    if (const auto* line = std::get_if<LineScan>(&message)) *waiting = line;
    const auto* reading = std::get_if<EncoderReading>(&message);
    if (reading == nullptr) return;
    track->Add(*reading);
    if (*waiting == nullptr) return;
    work(*track, **waiting);
    track->ForgetBefore((*waiting)->utime);
    *waiting = nullptr;
  });
}

// Each beam by itself, at its own angle: the formula as it stands in line_to_cloud.h.
std::function<void()> ByEigen(std::int64_t points) {
  const TurnedScanner scanner = *MakeBenchRig().rig.lidar.turned_scanner;
  const Eigen::Isometry3d motor_from_scanner =
      Eigen::Translation3d(scanner.motor_from_scanner.translation) *
      scanner.motor_from_scanner.rotation;
  return OnTrack(points, [=](const EncoderTrack& track, const LineScan& line) {
    std::vector<Eigen::Vector3f> cloud;
    for (std::size_t i = 0; i < line.range.size(); ++i) {
      const double after = static_cast<double>(i) * line.beam_period_s;
      const auto angle =
          track.AngleAt(scanner, line.utime + FromSeconds(after), Assembler::kMaxGap);
      const double a = line.first_angle_rad + static_cast<double>(i) * line.angle_step_rad;
      const double r = static_cast<double>(line.range[i]);
      const Eigen::Vector3d in_scanner(r * std::cos(a), 0, r * std::sin(a));
      cloud.emplace_back((Eigen::AngleAxisd(angle.value(), Eigen::Vector3d::UnitZ()) *
                          (motor_from_scanner * in_scanner))
                             .cast<float>());
    }
    benchmark::DoNotOptimize(cloud);
  });
}

// A line is put into the scan plane and turned as a whole, by the motor's angle in its middle:
// quicker than it is right.
std::function<void()> ByPcl(std::int64_t points) {
  const TurnedScanner scanner = *MakeBenchRig().rig.lidar.turned_scanner;
  const Eigen::Isometry3d motor_from_scanner =
      Eigen::Translation3d(scanner.motor_from_scanner.translation) *
      scanner.motor_from_scanner.rotation;
  std::vector<float> cosines, sines;
  const LineScan like = TurningScanner(kJune2015).Line(0);
  for (int i = 0; i < TurningScanner::kBeams; ++i) {
    const double a = like.first_angle_rad + i * like.angle_step_rad;
    cosines.push_back(static_cast<float>(std::cos(a)));
    sines.push_back(static_cast<float>(std::sin(a)));
  }
  return OnTrack(points, [=](const EncoderTrack& track, const LineScan& line) {
    pcl::PointCloud<pcl::PointXYZI> flat, cloud;
    flat.resize(line.range.size());
    flat.is_dense = false;
    for (std::size_t i = 0; i < line.range.size(); ++i) {
      flat[i].x = line.range[i] * cosines[i];
      flat[i].y = 0;
      flat[i].z = line.range[i] * sines[i];
      flat[i].intensity = line.intensity[i];
    }
    const auto angle =
        track.AngleAt(scanner, line.utime + TurningScanner::kLinePeriod / 2, Assembler::kMaxGap);
    const Eigen::Isometry3d turned =
        Eigen::AngleAxisd(angle.value(), Eigen::Vector3d::UnitZ()) * motor_from_scanner;
    pcl::transformPointCloud(flat, cloud, turned.matrix().cast<float>());
    benchmark::DoNotOptimize(cloud);
  });
}

}  // namespace

void RegisterAssemble(std::int64_t most) {
  for (const std::int64_t size : Decades(most)) {
    const auto add = [&](const char* who, auto work) {
      Register({"assemble", who, size, "points"}, [=] { return work(size); });
    };
    add("rgbdt", ByNode);
    add("Eigen, each beam", ByEigen);
    add("pcl::transformPointCloud, each line", ByPcl);
  }
}

}  // namespace rgbdt::bench
