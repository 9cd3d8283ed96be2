// The same recording read by PCL's grabbers. PCL's frame is Velodyne's (y forward, x right, azimuth
// clockwise from y); and it gives all lasers of a firing the azimuth at which the first one fires,
// so what the head turns in between is taken back before comparing.
#include <gtest/gtest.h>
#include <pcl/io/hdl_grabber.h>
#include <pcl/io/vlp_grabber.h>

#include <cmath>
#include <condition_variable>
#include <filesystem>
#include <map>
#include <mutex>

#include "services/drivers/packets/packet_source.h"
#include "services/drivers/velodyne/velodyne_packets.h"
#include "tests/hardware/device_harness.h"
#include "tests/hardware/velodyne_encoder.h"
#include "tests/numbers.h"

#ifdef __SANITIZE_ADDRESS__
// PCL's grabbers never close their recording nor free what lies in their queue when they stop.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:pcl::HDLGrabber\nleak:libpcap\n";
}
#endif

namespace rgbdt {
namespace {

namespace fs = std::filesystem;
using Model = VelodyneDevice::Model;
using PclCloud = pcl::PointCloud<pcl::PointXYZI>;

VelodyneEncoder ModelEncoder(Model model) {
  VelodyneEncoder encoder;
  encoder.model = static_cast<VelodyneEncoder::Model>(static_cast<int>(model) - 1);
  encoder.block_turn = model == Model::kVlp16 ? 40 : 20;
  encoder.scene.distance = [](double elevation, double azimuth) {
    return azimuth > 100 && azimuth < 120 ? 0
                                          : 5 + 2 * std::cos(azimuth * kDegree) + 0.01 * elevation;
  };
  encoder.scene.reflectivity = [](double, double azimuth) {
    return static_cast<int>(azimuth / 2) % 200;
  };
  return encoder;
}

std::string Record(const VelodyneEncoder& encoder, int packets) {
  PcapWriter writer;
  writer.Begin();
  for (int i = 0; i < packets; ++i) {
    writer.Add(kJune2015 + std::llround((i + 1) * encoder.PacketDuration_us()), encoder.Packet(i));
  }
  std::string name = (fs::temp_directory_path() / "rgbdt_pcl_XXXXXX").string();
  close(mkstemp(name.data()));
  writer.Save(name);
  return name;
}

// The third whole sweep that a grabber gives.
PclCloud::ConstPtr ByPcl(pcl::HDLGrabber* grabber) {
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<PclCloud::ConstPtr> sweeps;
  std::function<void(const PclCloud::ConstPtr&)> take = [&](const PclCloud::ConstPtr& sweep) {
    const std::lock_guard<std::mutex> lock(mutex);
    sweeps.push_back(sweep);
    changed.notify_all();
  };
  const boost::signals2::connection connection = grabber->registerCallback(take);
  grabber->start();
  PclCloud::ConstPtr third;
  {
    std::unique_lock<std::mutex> lock(mutex);
    changed.wait_for(lock, std::chrono::seconds(60), [&] { return sweeps.size() >= 3; });
    if (sweeps.size() >= 3) third = sweeps[2];
  }
  grabber->stop();
  connection.disconnect();
  return third;
}

Cloud ByDriver(Model model, const std::string& file) {
  VelodyneDevice device;
  device.model = model;
  device.pcap = file;
  PacketSource source(device);
  DeviceThread thread([&](DeviceThread& self) { source.Serve(self); });
  Collected collected;
  EXPECT_TRUE(Collect(
      &thread, &collected, [&](const Collected&) { return thread.ended(); }, 60));
  Cloud sweep;
  for (const CloudChunk& chunk : collected.All<CloudChunk>()) {
    const Cloud& c = chunk.cloud;
    sweep.points.insert(sweep.points.end(), c.points.begin(), c.points.end());
    sweep.intensity.insert(sweep.intensity.end(), c.intensity.begin(), c.intensity.end());
    sweep.ring.insert(sweep.ring.end(), c.ring.begin(), c.ring.end());
    if (chunk.sweep_end) break;
  }
  return sweep;
}

// Points by ring and by the head's azimuth [0.01 degrees].
using ByPlace = std::map<std::pair<int, int>, Eigen::Vector4d>;

std::pair<int, int> PlaceOf(const velodyne::Sensor& sensor, const Eigen::Vector3d& p) {
  const double elevation = std::asin(p.z() / p.norm()) / kDegree;
  std::size_t nearest = 0;
  for (std::size_t i = 1; i < sensor.elevation_deg.size(); ++i) {
    if (std::abs(sensor.elevation_deg[i] - elevation) <
        std::abs(sensor.elevation_deg[nearest] - elevation)) {
      nearest = i;
    }
  }
  const double azimuth = std::atan2(-p.y(), p.x()) / kDegree;
  return {sensor.ring[nearest], (static_cast<int>(std::lround(azimuth * 5)) * 20 + 36000) % 36000};
}

void Compare(Model model, pcl::HDLGrabber* grabber, const std::string& file) {
  const velodyne::Sensor& sensor = velodyne::SensorOf(model);
  const PclCloud::ConstPtr theirs = ByPcl(grabber);
  ASSERT_NE(theirs, nullptr);
  const Cloud ours = ByDriver(model, file);
  ByPlace by_place;
  for (std::size_t i = 0; i < ours.points.size(); ++i) {
    if (!ours.IsHit(i)) continue;
    int laser = 0;
    while (sensor.ring[static_cast<std::size_t>(laser)] != ours.ring[i]) ++laser;
    const double turned = 0.2 * sensor.LaserTime_us(laser) / sensor.column_us * kDegree;
    const Eigen::Vector3d p =
        Eigen::AngleAxisd(turned, Eigen::Vector3d::UnitZ()) * ours.points[i].cast<double>();
    by_place[PlaceOf(sensor, p)] << p, ours.intensity[i] * 255.0;
  }
  EXPECT_EQ(by_place.size(), theirs->size());
  double worst = 0;
  for (const pcl::PointXYZI& t : *theirs) {
    const Eigen::Vector3d p(t.y, -t.x, t.z);
    const auto found = by_place.find(PlaceOf(sensor, p));
    ASSERT_NE(found, by_place.end());
    worst = std::max(worst, (found->second.head<3>() - p).norm());
    ASSERT_NEAR(found->second.w(), t.intensity, 0.01);
  }
  ::testing::Test::RecordProperty("worst_mm", std::to_string(1000 * worst));
  EXPECT_LT(worst, 0.001);
  fs::remove(file);
}

TEST(VelodyneAgainstPcl, Vlp16) {
  const std::string file = Record(ModelEncoder(Model::kVlp16), 5 * 75);
  pcl::VLPGrabber grabber(file);
  Compare(Model::kVlp16, &grabber, file);
}

TEST(VelodyneAgainstPcl, Hdl32e) {
  const std::string file = Record(ModelEncoder(Model::kHdl32e), 5 * 150);
  pcl::HDLGrabber grabber("", file);
  Compare(Model::kHdl32e, &grabber, file);
}

}  // namespace
}  // namespace rgbdt
