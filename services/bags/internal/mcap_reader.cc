// MCAP (mcap.dev/spec): after 8 bytes of magic, records of opcode (1 byte), length (8) and content,
// little-endian. Read from front to back, so a file whose recorder was killed before it wrote the
// summary is read like any other; the summary says nothing that the data does not.

#include <zlib.h>

#include <map>
#include <optional>

#include "services/bags/internal/bag_file.h"
#include "services/bags/internal/fields.h"
#include "services/bags/internal/mcap_format.h"
#include "services/bags/internal/unpack.h"

namespace rgbdt::bags {
namespace {

constexpr std::int64_t kMagicBytes = 8;
constexpr std::size_t kHeadBytes = 9;  // opcode and length

BagEncoding EncodingOf(const std::string& name) {
  if (name == "cdr") return BagEncoding::kCdr;
  if (name == "ros1") return BagEncoding::kRos1;
  if (name == "protobuf") return BagEncoding::kProtobuf;
  return BagEncoding::kOther;
}

class McapReader : public BagReader {
 public:
  explicit McapReader(const std::filesystem::path& path)
      : file_(path), at_(kMagicBytes), budget_(file_.size()) {}

  bool Next(BagMessage* message) override {
    while (true) {
      try {
        if (NextInChunk(message)) return true;
        if (at_ >= file_.size() || done_) return false;
        if (TakeRecord(message)) return true;
      } catch (const DiskError&) {
        throw;
      } catch (const InputError& error) {
        // Of a damaged chunk the next ones are of use: where it ends is known.
        problems_.Add(Where() + ": " + error.what());
        in_chunk_ = chunk_.size();
      }
    }
  }

  BagMessage Read(const BagPlace& place) override {
    if (place.within < 0) {
      LoadRecord(place.at, &record_);
      BagMessage message = MessageOf(record_.data(), record_.size());
      message.place = place;
      return message;
    }
    if (chunk_at_ != place.at) {
      LoadRecord(place.at, &record_);
      UnpackChunk(place.at, nullptr);
    }
    const auto within = static_cast<std::size_t>(place.within);
    if (within > chunk_.size()) throw InputError(file_.path() + ": has changed while it was read");
    Fields fields(chunk_.data() + within, chunk_.size() - within);
    fields.Number<std::uint8_t>();
    const auto length = fields.Number<std::uint64_t>();
    BagMessage message = MessageOf(fields.Bytes(length), length);
    message.place = place;
    in_chunk_ = chunk_.size();
    return message;
  }

  void Rest() override {
    for (auto* held : {&record_, &chunk_}) *held = {};
    chunk_at_ = -1;
    in_chunk_ = 0;
  }
  const std::vector<BagTopic>& topics() const override { return topics_.topics(); }
  const std::vector<std::string>& problems() const override { return problems_.lines(); }
  std::int64_t position() const override { return std::min(at_, file_.size()); }
  std::int64_t size() const override { return file_.size(); }
  std::string format() const override { return "MCAP"; }

 private:
  std::string Where() const { return file_.path() + ", byte " + std::to_string(record_at_); }

  void EndAt(const std::string& why) {
    done_ = true;
    throw InputError(why + "; what lies before it is read");
  }

  // A record of the file: true for a message outside chunks.
  bool TakeRecord(BagMessage* message) {
    record_at_ = at_;
    std::uint8_t head[kHeadBytes];
    if (file_.Read(at_, head, kHeadBytes) < kHeadBytes) EndAt("is cut off within a record");
    const std::uint8_t opcode = head[0];
    if (opcode == 0) EndAt("is damaged: a record of opcode 0, which no record has");
    const auto length = LittleEndian<std::uint64_t>(head + 1);
    const std::int64_t begin = at_ + static_cast<std::int64_t>(kHeadBytes);
    if (length > static_cast<std::uint64_t>(file_.size() - begin)) {
      EndAt("is cut off, or damaged: a record of " + std::to_string(length) +
            " bytes begins here and " + std::to_string(file_.size() - begin) + " are there");
    }
    at_ = begin + static_cast<std::int64_t>(length);
    if (opcode == kDataEnd) {
      done_ = true;
      return false;
    }
    if (opcode < kSchema || opcode > kChunk) return false;  // indexes, attachments, later additions
    RequireSize(length);
    if (!file_.ReadAll(begin, length, &record_)) EndAt("has become shorter while it was read");
    if (opcode == kChunk) {
      UnpackChunk(record_at_, &budget_);
      in_chunk_ = 0;
      return false;
    }
    return Take(opcode, record_.data(), record_.size(), {0, record_at_, -1}, message);
  }

  bool NextInChunk(BagMessage* message) {
    while (in_chunk_ < chunk_.size()) {
      const BagPlace place{0, chunk_at_, static_cast<std::int64_t>(in_chunk_)};
      Fields fields(chunk_.data() + in_chunk_, chunk_.size() - in_chunk_);
      const auto opcode = fields.Number<std::uint8_t>();
      if (opcode == 0) throw InputError("a record in a chunk is of opcode 0, which no record has");
      const auto length = fields.Number<std::uint64_t>();
      const std::uint8_t* content = fields.Bytes(length);
      in_chunk_ = chunk_.size() - fields.left();
      try {
        if (Take(opcode, content, length, place, message)) return true;
      } catch (const InputError& error) {  // the next record's place is known
        if (++bad_in_chunk_ > kMostBadRecords) throw;
        problems_.Add(Where() + ": " + error.what());
      }
    }
    return false;
  }

  bool Take(std::uint8_t opcode, const std::uint8_t* content, std::size_t size,
            const BagPlace& place, BagMessage* message) {
    if (opcode == kSchema) TakeSchema(Fields(content, size));
    if (opcode == kChannel) TakeChannel(Fields(content, size));
    if (opcode != kMessage) return false;
    *message = MessageOf(content, size);
    message->place = place;
    return true;
  }

  void TakeSchema(Fields fields) {
    const auto id = fields.Number<std::uint16_t>();
    schemas_[id] = fields.Text();
  }

  void TakeChannel(Fields fields) {
    const auto id = fields.Number<std::uint16_t>();
    const std::string schema = schemas_[fields.Number<std::uint16_t>()];
    const std::string topic = fields.Text();
    channels_[id] = topics_.Add(topic, schema, EncodingOf(fields.Text()));
  }

  BagMessage MessageOf(const std::uint8_t* content, std::size_t size) const {
    Fields fields(content, size);
    const auto id = fields.Number<std::uint16_t>();
    const auto channel = channels_.find(id);
    if (channel == channels_.end()) {
      throw InputError("a message is of channel " + std::to_string(id) +
                       ", which no record describes");
    }
    BagMessage message;
    message.topic = channel->second;
    fields.Number<std::uint32_t>();  // sequence
    message.log_utime = FromNanoseconds(fields.Number<std::uint64_t>());
    fields.Number<std::uint64_t>();  // publish time
    message.size = fields.left();
    message.data = fields.Bytes(message.size);
    return message;
  }

  // Of the chunk in record_; what it costs is counted the first time.
  void UnpackChunk(std::int64_t at, UnpackBudget* budget) {
    chunk_at_ = -1;
    chunk_.clear();
    in_chunk_ = 0;
    Fields fields(record_.data(), record_.size());
    fields.Number<std::uint64_t>();  // first and last time
    fields.Number<std::uint64_t>();
    const auto unpacked = fields.Number<std::uint64_t>();
    const auto crc = fields.Number<std::uint32_t>();
    const std::string compression = fields.Text();
    const auto packed = fields.Number<std::uint64_t>();
    if (budget != nullptr) budget->Spend(unpacked);
    Unpack(compression, fields.Bytes(packed), packed, unpacked, &chunk_);
    if (crc != 0 && crc32_z(0, chunk_.data(), chunk_.size()) != crc) {
      chunk_.clear();
      throw InputError(
          "a chunk is damaged: its checksum is another one; its messages are left out");
    }
    chunk_at_ = at;
    bad_in_chunk_ = 0;
  }

  static void RequireSize(std::uint64_t length) {
    if (length <= kMostBagBytes) return;
    throw InputError("a record of " + std::to_string(length) + " bytes is left out; at most " +
                     std::to_string(kMostBagBytes) + " are read at once");
  }

  void LoadRecord(std::int64_t at, std::vector<std::uint8_t>* record) const {
    std::uint8_t head[kHeadBytes];
    const bool there = file_.Read(at, head, kHeadBytes) == kHeadBytes;
    const std::uint64_t length = there ? LittleEndian<std::uint64_t>(head + 1) : 0;
    RequireSize(length);
    if (!there || !file_.ReadAll(at + static_cast<std::int64_t>(kHeadBytes), length, record)) {
      throw InputError(file_.path() + ": has changed while it was read");
    }
  }

  BagFile file_;
  std::int64_t at_;             // of the next record
  std::int64_t record_at_ = 0;  // of the last one
  UnpackBudget budget_;
  bool done_ = false;
  std::vector<std::uint8_t> record_, chunk_;  // content of the last record; unpacked records
  std::int64_t chunk_at_ = -1;
  std::size_t in_chunk_ = 0, bad_in_chunk_ = 0;
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, std::size_t> channels_;  // to topics
  TopicList topics_;
  Problems problems_;
};

}  // namespace

std::unique_ptr<BagReader> OpenMcap(const std::filesystem::path& path) {
  return std::make_unique<McapReader>(path);
}

}  // namespace rgbdt::bags
