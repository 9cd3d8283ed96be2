#include <bzlib.h>
#include <lz4frame.h>
#include <sqlite3.h>
#include <zlib.h>
#include <zstd.h>

#include <stdexcept>

#include "calib/files/image_files.h"
#include "tests/fuzz/seeds/seeds.h"
#include "tests/unit/bags/bag_bytes.h"
#include "tests/unit/import/ros_bytes.h"

namespace rgbdt::fuzz {
namespace {

using test::RosBytes;
using Inputs = std::map<std::string, std::string>;

struct RosMessage {
  std::string name, topic, type;  // ROS 1's
  std::string bytes;
};

std::string ImageBytes(BagEncoding encoding, bool big, const std::string& format,
                       std::uint32_t step) {
  RosBytes bytes(encoding, big);
  bytes.Header(1'700'000'000, 5, "/cam").Add(2U).Add(4U).Text(format).Add(std::uint8_t{1});
  return bytes.Add(step).Blob(std::string(2 * step, 'p')).Bytes();
}

std::string CompressedBytes(BagEncoding encoding, bool big) {
  RosBytes bytes(encoding, big);
  bytes.Header(1'700'000'000, 5, "/cam").Text("bayer_rggb8; png compressed ");
  return bytes.Blob(EncodePng(cv::Mat(4, 4, CV_8UC1, 9))).Bytes();
}

std::string InfoBytes(BagEncoding encoding, bool big) {
  RosBytes bytes(encoding, big);
  bytes.Header(1, 0, "cam").Add(480U).Add(640U).Text("plumb_bob").Add(4U);
  for (const double d : {0.5, -0.25, 0.0, 0.0}) bytes.Add(d);
  for (const double k : {500.0, 0.0, 320.0, 0.0, 501.0, 240.0, 0.0, 0.0, 1.0}) bytes.Add(k);
  for (int i = 0; i < 9 + 12; ++i) bytes.Add(1.0);
  return bytes.Add(0U).Add(0U).Add(0U).Add(0U).Add(0U).Add(0U).Add(std::uint8_t{0}).Bytes();
}

std::string CloudBytes(BagEncoding encoding, bool big, std::uint32_t height) {
  struct Field {
    const char* name;
    std::uint32_t offset;
    std::uint8_t type;
  };
  constexpr Field kFields[] = {{"x", 0, 7},     {"y", 4, 7},  {"z", 8, 7},
                               {"ring", 12, 4}, {"t", 16, 6}, {"intensity", 20, 2}};
  constexpr std::uint32_t kStep = 24, kWidth = 2;
  RosBytes bytes(encoding, big);
  bytes.Header(1'700'000'000, 0, "lidar").Add(height).Add(kWidth).Add(6U);
  for (const Field& field : kFields) {
    bytes.Text(field.name).Add(field.offset).Add(field.type).Add(1U);
  }
  bytes.Add(std::uint8_t{0}).Add(kStep).Add(kStep * kWidth);
  return bytes.Blob(std::string(std::size_t{kStep} * kWidth * height, '?'))
      .Add(std::uint8_t{1})
      .Bytes();
}

std::string TransformBytes(BagEncoding encoding, bool big) {
  RosBytes bytes(encoding, big);
  bytes.Add(1U).Header(0, 0, "/base").Text("lidar").Add(1.0).Add(2.0).Add(3.0);
  return bytes.Add(0.0).Add(0.0).Add(1.0).Add(0.0).Bytes();
}

std::vector<RosMessage> MessagesOf(BagEncoding encoding, bool big = false) {
  const std::string image = "sensor_msgs/Image";
  return {
      {"image", "/rgb/image_raw", image, ImageBytes(encoding, big, "bgr8", 12)},
      {"packed", "/left/compressed", "sensor_msgs/CompressedImage", CompressedBytes(encoding, big)},
      {"info", "/rgb/camera_info", "sensor_msgs/CameraInfo", InfoBytes(encoding, big)},
      {"cloud", "/points", "sensor_msgs/PointCloud2", CloudBytes(encoding, big, 3)},
      {"transform", "/tf_static", "tf2_msgs/TFMessage", TransformBytes(encoding, big)}};
}

void AddRosMessages(Inputs* seeds) {
  for (const auto& [encoding, big] : {std::pair<BagEncoding, bool>{BagEncoding::kRos1, false},
                                      {BagEncoding::kCdr, false},
                                      {BagEncoding::kCdr, true}}) {
    const char layout = encoding == BagEncoding::kCdr ? '\1' : '\0';
    const std::string end = std::to_string(layout) + (big ? "_big" : "");
    const auto add = [&](const std::string& name, char kind, const std::string& bytes) {
      (*seeds)[name + end] = std::string{kind, layout} + bytes;
    };
    char kind = 0;
    for (const RosMessage& message : MessagesOf(encoding, big)) {
      add(message.name, kind++, message.bytes);
    }
    for (const char* format : {"mono16", "rgba8", "yuv422", "bayer_grbg8", "8UC1", "rgb8"}) {
      add(format, 0, ImageBytes(encoding, big, format, 16));
    }
    add("line", 3, CloudBytes(encoding, big, 1));
  }
}

std::string Zstd(const std::string& bytes) {
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  packed.resize(ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), 3));
  return packed;
}

std::string Lz4(const std::string& bytes) {
  std::string packed(LZ4F_compressFrameBound(bytes.size(), nullptr), '\0');
  packed.resize(
      LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), nullptr));
  return packed;
}

std::string Bz2(std::string bytes) {
  std::string packed(bytes.size() + 1000, '\0');
  auto size = static_cast<unsigned>(packed.size());
  BZ2_bzBuffToBuffCompress(packed.data(), &size, bytes.data(), static_cast<unsigned>(bytes.size()),
                           1, 0, 0);
  packed.resize(size);
  return packed;
}

std::string McapRecords(const std::string& layout) {
  const bool cdr = layout == "cdr";
  std::string records;
  std::uint16_t id = 0;
  for (const RosMessage& message : MessagesOf(cdr ? BagEncoding::kCdr : BagEncoding::kRos1)) {
    ++id;
    records += test::McapRecord(
        3, test::Little(id) + test::Text(message.type) + test::Text("ros2msg") + test::Text(""));
    records += test::McapRecord(4, test::Little(id) + test::Little(id) + test::Text(message.topic) +
                                       test::Text(layout) + test::Little(std::uint32_t{0}));
    records += test::McapMessage(id, 1'700'000'000'000'000'000, message.bytes);
  }
  return records;
}

std::uint32_t Crc(const std::string& bytes) {
  return static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const unsigned char*>(bytes.data()),
                                          static_cast<unsigned>(bytes.size())));
}

std::string Ros1Records() {
  std::string records;
  std::uint32_t id = 0;
  for (const RosMessage& message : MessagesOf(BagEncoding::kRos1)) {
    const std::string connection = test::Ros1Field("conn", test::Little(++id));
    records += test::Ros1Record(
        test::Ros1Field("op", "\x07") + connection + test::Ros1Field("topic", message.topic),
        test::Ros1Field("topic", message.topic) + test::Ros1Field("type", message.type));
    records +=
        test::Ros1Record(test::Ros1Field("op", "\x02") + connection +
                             test::Ros1Field("time", test::Little(std::uint32_t{1'700'000'000}) +
                                                         test::Little(std::uint32_t{5})),
                         message.bytes);
  }
  return records;
}

void AddBags(Inputs* seeds) {
  const std::string mcap = test::kMcapMagic, cdr = McapRecords("cdr");
  (*seeds)["cdr.mcap"] = mcap + cdr + test::McapEnd();
  (*seeds)["ros1.mcap"] = mcap + McapRecords("ros1") + test::McapEnd();
  (*seeds)["plain.mcap"] = mcap + test::McapChunk("", cdr, cdr.size(), Crc(cdr));
  (*seeds)["zstd.mcap"] = mcap + test::McapChunk("zstd", Zstd(cdr), cdr.size(), Crc(cdr));
  (*seeds)["lz4.mcap"] = mcap + test::McapChunk("lz4", Lz4(cdr), cdr.size()) + test::McapEnd();
  (*seeds)["what.mcap"] = mcap + test::McapChunk("snappy", cdr, cdr.size()) + test::McapEnd();
  (*seeds)["bomb.mcap"] = mcap + test::McapChunk("zstd", Zstd(cdr), std::uint64_t{1} << 40);
  (*seeds)["cut.mcap"] = (mcap + cdr).substr(0, 700);
  const std::string records = Ros1Records();
  const auto chunk = [&](const std::string& compression, const std::string& packed) {
    return test::kRos1Magic +
           test::Ros1Chunk(compression, packed, static_cast<std::uint32_t>(records.size()));
  };
  (*seeds)["records.bag"] = test::kRos1Magic + records;
  (*seeds)["none.bag"] = chunk("none", records);
  (*seeds)["lz4.bag"] = chunk("lz4", Lz4(records));
  (*seeds)["bz2.bag"] = chunk("bz2", Bz2(records));
  (*seeds)["what.bag"] = chunk("zip", records);
  (*seeds)["cut.bag"] = chunk("none", records).substr(0, 500);
  (*seeds)["old.bag"] = "#ROSBAG V1.2\n";
  (*seeds)["packed"] = Zstd(mcap + cdr);
  (*seeds)["other"] = "PK\x03\x04";
}

void Execute(sqlite3* database, const std::string& script) {
  if (sqlite3_exec(database, script.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) {
    throw std::runtime_error(sqlite3_errmsg(database));
  }
}

std::string Hexadecimal(const std::string& bytes) {
  std::string text = "x'";
  for (const char c : bytes) {
    constexpr char kDigits[] = "0123456789abcdef";
    text += kDigits[static_cast<unsigned char>(c) >> 4];
    text += kDigits[c & 15];
  }
  return text + "'";
}

// Small pages, so that a bag of some kilobytes has several.
std::string SqliteBag(const std::string& rows, bool packed) {
  return Written([&](const std::filesystem::path& path) {
    sqlite3* database = nullptr;
    sqlite3_open(path.c_str(), &database);
    const std::unique_ptr<sqlite3, int (*)(sqlite3*)> owner(database, sqlite3_close);
    Execute(database,
            "PRAGMA page_size = 512; CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type "
            "TEXT, serialization_format TEXT); CREATE TABLE messages(id INTEGER PRIMARY KEY, "
            "topic_id INTEGER, timestamp INTEGER, data BLOB);");
    int id = 0;
    for (const RosMessage& message : MessagesOf(BagEncoding::kCdr)) {
      const std::string number = std::to_string(++id);
      std::string type = message.type;
      type.insert(type.find('/'), "/msg");
      Execute(database, "INSERT INTO topics VALUES(" + number + ", '" + message.topic + "', '" +
                            type + "', 'cdr'); INSERT INTO messages VALUES(" + number + ", " +
                            number + ", 1700000000000000000, " +
                            Hexadecimal(packed ? Zstd(message.bytes) : message.bytes) + ");");
    }
    Execute(database, rows);
  });
}

void AddSqliteBags(Inputs* seeds) {
  (*seeds)["plain"] = SqliteBag("INSERT INTO topics VALUES(9, '/x', 'x/X', 'json');", false);
  (*seeds)["packed"] = SqliteBag("", true);
  (*seeds)["whose"] = SqliteBag("INSERT INTO messages VALUES(20, 77, 0, 'x');", false);
  (*seeds)["no_size"] =
      SqliteBag("INSERT INTO messages VALUES(20, 1, 0, x'28b52ffd0000010000');", false);
  (*seeds)["no_tables"] = SqliteBag("DROP TABLE topics;", false);
}

std::string LivoxBytes(std::uint32_t seconds) {
  RosBytes bytes(BagEncoding::kCdr);
  bytes.Header(seconds, 0, "livox_frame").Add(std::uint64_t{seconds} * 1'000'000'000);
  bytes.Add(2U).Add(0U).Add(2U);  // points, LIDAR and padding, points
  for (int i = 0; i < 2; ++i) {
    bytes.Add(i * 1'000'000).Add(1.0F + static_cast<float>(i)).Add(0.5F).Add(0.5F);
    bytes.Add(std::uint8_t{51}).Add(std::uint8_t{0}).Add(std::uint8_t{1});
  }
  return bytes.Bytes();
}

// Of a Livox's own messages, one at each of these times.
std::string LivoxBag(std::initializer_list<std::uint32_t> seconds) {
  const std::uint16_t id = 1;
  std::string bag = test::kMcapMagic;
  bag += test::McapRecord(3, test::Little(id) + test::Text("livox_ros_driver2/msg/CustomMsg") +
                                 test::Text("ros2msg") + test::Text(""));
  bag += test::McapRecord(4, test::Little(id) + test::Little(id) + test::Text("/livox/lidar") +
                                 test::Text("cdr") + test::Little(std::uint32_t{0}));
  for (const std::uint32_t second : seconds) bag += test::McapMessage(id, 1, LivoxBytes(second));
  return bag + test::McapEnd();
}

// A byte for what is to be made of it, and the bag.
void AddBagImports(Inputs* seeds) {
  const std::map<std::string, std::string> bags = {
      {"cdr", test::kMcapMagic + McapRecords("cdr") + test::McapEnd()},
      {"ros1", test::kRos1Magic + Ros1Records()},
      {"livox", LivoxBag({1'700'000'000, 1'700'000'001})},
      {"times", LivoxBag({1, 4'000'000'000})}};
  for (const auto& [name, bag] : bags) {
    for (char makes = 0; makes < 3; ++makes) {
      (*seeds)[name + std::to_string(makes)] = makes + bag;
    }
  }
}

}  // namespace

void AddBagSeeds(Seeds* seeds) {
  AddRosMessages(&(*seeds)["ros_message"]);
  AddBags(&(*seeds)["bag"]);
  AddSqliteBags(&(*seeds)["bag_sqlite"]);
  AddBagImports(&(*seeds)["bag_import"]);
}

}  // namespace rgbdt::fuzz
