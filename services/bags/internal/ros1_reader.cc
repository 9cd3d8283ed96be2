// ROS 1's bags, version 2.0 (wiki.ros.org/Bags/Format/2.0): a line, then records of a header (32
// bits of length, fields "name=value", each behind its own length) and data (likewise). Read from
// front to back: a bag that was never closed (.bag.active) is read like any other, without its
// index.

#include <map>
#include <string_view>

#include "services/bags/internal/bag_file.h"
#include "services/bags/internal/fields.h"
#include "services/bags/internal/unpack.h"

namespace rgbdt::bags {
namespace {

enum Operation : std::uint8_t { kMessage = 0x02, kChunk = 0x05, kConnection = 0x07 };

constexpr std::int64_t kMagicBytes = 13;  // "#ROSBAG V2.0\n"
constexpr std::uint32_t kMostHeaderBytes = 1 << 20;

// A record's header: values by their names.
class Header {
 public:
  Header(const std::uint8_t* bytes, std::size_t size) {
    Fields fields(bytes, size);
    while (fields.left() > 0) {
      const std::string field = fields.Text();
      const std::size_t equals = field.find('=');
      if (equals == std::string::npos) throw InputError("a field of a record has no name");
      values_[field.substr(0, equals)] = field.substr(equals + 1);
    }
  }

  std::string Text(const std::string& name) const {
    const auto found = values_.find(name);
    if (found == values_.end()) throw InputError("a record has no field " + name);
    return found->second;
  }
  template <typename T>
  T Number(const std::string& name) const {
    const std::string text = Text(name);
    return Fields(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()).Number<T>();
  }

 private:
  std::map<std::string, std::string> values_;
};

struct Record {
  Header header;
  const std::uint8_t* data;
  std::size_t size;
};

Record TakeRecord(Fields* fields) {
  const auto header_size = fields->Number<std::uint32_t>();
  if (header_size == 0) throw InputError("a record has no header");
  const std::uint8_t* header = fields->Bytes(header_size);
  const auto size = fields->Number<std::uint32_t>();
  return {Header(header, header_size), fields->Bytes(size), size};
}

class Ros1Reader : public BagReader {
 public:
  explicit Ros1Reader(const std::filesystem::path& path)
      : file_(path), at_(kMagicBytes), budget_(file_.size()) {}

  bool Next(BagMessage* message) override {
    while (true) {
      try {
        if (NextInChunk(message)) return true;
        if (at_ >= file_.size() || done_) return false;
        if (TakeFileRecord(message)) return true;
      } catch (const DiskError&) {
        throw;
      } catch (const InputError& error) {
        problems_.Add(Where() + ": " + error.what());
        in_chunk_ = chunk_.size();
      }
    }
  }

  BagMessage Read(const BagPlace& place) override {
    if (place.within < 0 || chunk_at_ != place.at) Load(place.at);
    if (place.within >= 0 && chunk_at_ != place.at) {
      UnpackChunk(place.at, Header(header_.data(), header_.size()), nullptr);
    }
    Fields fields(chunk_.data(), chunk_.size());
    BagMessage message;
    if (place.within < 0) {
      message = MessageOf(Header(header_.data(), header_.size()), data_.data(), data_.size());
    } else {
      fields.Bytes(static_cast<std::uint64_t>(place.within));
      const Record record = TakeRecord(&fields);
      message = MessageOf(record.header, record.data, record.size);
      in_chunk_ = chunk_.size();
    }
    message.place = place;
    return message;
  }

  void Rest() override {
    for (auto* held : {&header_, &data_, &chunk_}) *held = {};
    chunk_at_ = -1;
    in_chunk_ = 0;
  }
  const std::vector<BagTopic>& topics() const override { return topics_.topics(); }
  const std::vector<std::string>& problems() const override { return problems_.lines(); }
  std::int64_t position() const override { return std::min(at_, file_.size()); }
  std::int64_t size() const override { return file_.size(); }
  std::string format() const override { return "ROS 1 bag"; }

 private:
  std::string Where() const { return file_.path() + ", byte " + std::to_string(record_at_); }

  [[noreturn]] void EndAt(const std::string& why) {
    done_ = true;
    throw InputError(why + "; what lies before it is read");
  }

  // The record at `from` into header_ and data_; where it ends.
  std::int64_t Load(std::int64_t from) {
    header_.clear();
    data_.clear();
    const std::uint32_t header_size = LengthAt(from, kMostHeaderBytes);
    if (header_size == 0) EndAt("is damaged: a record without a header");
    if (!file_.ReadAll(from + 4, header_size, &header_)) EndAt("is cut off within a record");
    const std::int64_t data_at = from + 8 + header_size;
    const std::uint32_t size = LengthAt(data_at - 4, UINT32_MAX);
    if (size > static_cast<std::uint64_t>(file_.size() - data_at)) {
      EndAt("is cut off, or damaged: a record of " + std::to_string(size) +
            " bytes begins here and " + std::to_string(file_.size() - data_at) + " are there");
    }
    if (size > kMostBagBytes) {
      at_ = data_at + size;
      throw InputError("a record of " + std::to_string(size) + " bytes is left out; at most " +
                       std::to_string(kMostBagBytes) + " are read at once");
    }
    if (!file_.ReadAll(data_at, size, &data_)) EndAt("has become shorter while it was read");
    return data_at + size;
  }

  std::uint32_t LengthAt(std::int64_t from, std::uint32_t most) {
    std::uint8_t bytes[4];
    if (file_.Read(from, bytes, 4) < 4) EndAt("is cut off within a record");
    const auto length = LittleEndian<std::uint32_t>(bytes);
    if (length > most) {
      EndAt("is damaged: a record's header of " + std::to_string(length) + " bytes");
    }
    return length;
  }

  bool TakeFileRecord(BagMessage* message) {
    record_at_ = at_;
    at_ = Load(at_);
    const Header header(header_.data(), header_.size());
    if (header.Number<std::uint8_t>("op") == kChunk) {
      UnpackChunk(record_at_, header, &budget_);
      return false;
    }
    return Take(header, data_.data(), data_.size(), {0, record_at_, -1}, message);
  }

  bool NextInChunk(BagMessage* message) {
    while (in_chunk_ < chunk_.size()) {
      const BagPlace place{0, chunk_at_, static_cast<std::int64_t>(in_chunk_)};
      Fields fields(chunk_.data() + in_chunk_, chunk_.size() - in_chunk_);
      const Record record = TakeRecord(&fields);
      in_chunk_ = chunk_.size() - fields.left();
      try {
        if (Take(record.header, record.data, record.size, place, message)) return true;
      } catch (const InputError& error) {  // the next record's place is known
        if (++bad_in_chunk_ > kMostBadRecords) throw;
        problems_.Add(Where() + ": " + error.what());
      }
    }
    return false;
  }

  bool Take(const Header& header, const std::uint8_t* data, std::size_t size, const BagPlace& place,
            BagMessage* message) {
    const auto operation = header.Number<std::uint8_t>("op");
    if (operation == kConnection) {
      connections_[header.Number<std::uint32_t>("conn")] =
          topics_.Add(header.Text("topic"), Header(data, size).Text("type"), BagEncoding::kRos1);
    }
    if (operation != kMessage) return false;
    *message = MessageOf(header, data, size);
    message->place = place;
    return true;
  }

  BagMessage MessageOf(const Header& header, const std::uint8_t* data, std::size_t size) const {
    const auto id = header.Number<std::uint32_t>("conn");
    const auto connection = connections_.find(id);
    if (connection == connections_.end()) {
      throw InputError("a message is of connection " + std::to_string(id) +
                       ", which no record describes");
    }
    const auto time = header.Number<std::uint64_t>("time");  // seconds, then nanoseconds
    BagMessage message;
    message.topic = connection->second;
    message.log_utime = static_cast<Utime>(time & 0xffffffff) * kMicrosecondsPerSecond +
                        static_cast<Utime>((time >> 32) / 1000);
    message.data = data;
    message.size = size;
    return message;
  }

  // What it costs is counted the first time.
  void UnpackChunk(std::int64_t at, const Header& header, UnpackBudget* budget) {
    chunk_at_ = -1;
    chunk_.clear();
    in_chunk_ = 0;
    const auto unpacked = header.Number<std::uint32_t>("size");
    if (budget != nullptr) budget->Spend(unpacked);
    Unpack(header.Text("compression"), data_.data(), data_.size(), unpacked, &chunk_);
    chunk_at_ = at;
    bad_in_chunk_ = 0;
  }

  BagFile file_;
  std::int64_t at_;             // of the next record
  std::int64_t record_at_ = 0;  // of the last one
  UnpackBudget budget_;
  bool done_ = false;
  std::vector<std::uint8_t> header_, data_, chunk_;  // of the last record; unpacked records
  std::int64_t chunk_at_ = -1;
  std::size_t in_chunk_ = 0, bad_in_chunk_ = 0;
  std::map<std::uint32_t, std::size_t> connections_;  // to topics
  TopicList topics_;
  Problems problems_;
};

}  // namespace

std::unique_ptr<BagReader> OpenRos1(const std::filesystem::path& path) {
  return std::make_unique<Ros1Reader>(path);
}

}  // namespace rgbdt::bags
