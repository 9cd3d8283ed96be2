#include "services/bags/mcap_writer.h"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <limits>

#include "calib/model/errors.h"
#include "services/bags/bag_reader.h"
#include "services/bags/internal/mcap_format.h"

namespace rgbdt {
namespace {

using bags::kChannel;
using bags::kChunk;
using bags::kChunkIndex;
using bags::kDataEnd;
using bags::kFooter;
using bags::kHeader;
using bags::kMessage;
using bags::kMessageIndex;
using bags::kSchema;
using bags::kStatistics;
using bags::kSummaryOffset;
using bags::McapOpcode;

constexpr char kMagic[] = "\x89MCAP0\r\n";
constexpr std::size_t kChunkBytes = std::size_t{4} << 20;  // unpacked, before one is closed
constexpr int kZstdLevel = 1;
constexpr std::uint64_t kNanosecondsPerMicrosecond = 1000;

template <typename T>
void Add(T value, std::string* to) {
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    to->push_back(static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * i)));
  }
}

void AddText(std::string_view text, std::string* to) {
  Add(static_cast<std::uint32_t>(text.size()), to);
  to->append(text);
}

std::string Record(McapOpcode opcode, std::string_view content) {
  std::string record;
  record.reserve(9 + content.size());
  record.push_back(static_cast<char>(opcode));
  Add(std::uint64_t{content.size()}, &record);
  return record.append(content);
}

std::uint32_t Crc(std::uint32_t before, std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(before, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

std::string Pack(const std::string& bytes) {
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size =
      ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), kZstdLevel);
  if (ZSTD_isError(size) != 0) throw InputError(std::string("zstd: ") + ZSTD_getErrorName(size));
  packed.resize(size);
  return packed;
}

}  // namespace

void McapWriter::Span::Add(std::uint64_t ns) {
  first = std::min(first, ns);
  last = std::max(last, ns);
}

McapWriter::McapWriter(std::function<void(std::string_view)> sink, const std::string& library)
    : sink_(std::move(sink)) {
  Put({kMagic, sizeof(kMagic) - 1});
  std::string header;
  AddText("", &header);  // no profile
  AddText(library, &header);
  Put(Record(kHeader, header));
}

void McapWriter::Put(std::string_view bytes) {
  sink_(bytes);
  at_ += bytes.size();
  crc_ = Crc(crc_, bytes);
}

void McapWriter::AddToSummary(std::uint8_t opcode, const std::string& content) {
  summary_[opcode] += Record(static_cast<McapOpcode>(opcode), content);
}

// Schemas and channels stand in the chunk before their messages, and in the summary once more.
std::uint16_t McapWriter::AddSchema(const std::string& name, const std::string& encoding,
                                    const std::string& data) {
  const std::uint16_t id = ++schemas_;
  std::string schema;
  Add(id, &schema);
  AddText(name, &schema);
  AddText(encoding, &schema);
  AddText(data, &schema);
  chunk_ += Record(kSchema, schema);
  AddToSummary(kSchema, schema);
  return id;
}

std::uint16_t McapWriter::AddChannel(const std::string& topic, std::uint16_t schema,
                                     const std::string& encoding) {
  if (counts_.size() >= std::numeric_limits<std::uint16_t>::max()) {
    throw InputError("more than " + std::to_string(counts_.size()) + " topics in one MCAP");
  }
  const auto id = static_cast<std::uint16_t>(counts_.size() + 1);
  counts_[id] = 0;
  std::string channel;
  Add(id, &channel);
  Add(schema, &channel);
  AddText(topic, &channel);
  AddText(encoding, &channel);
  Add(std::uint32_t{0}, &channel);  // no metadata
  chunk_ += Record(kChannel, channel);
  AddToSummary(kChannel, channel);
  return id;
}

void McapWriter::Write(std::uint16_t channel, Utime log, Utime publish, std::string_view data) {
  constexpr std::size_t kAround = 1 << 20;  // what else a chunk holds: fields, schemas, channels
  if (data.size() > kMostBagBytes - kAround) {
    throw InputError("a message of " + std::to_string(data.size()) + " bytes; at most " +
                     std::to_string(kMostBagBytes - kAround) + " are written");
  }
  if (!chunk_index_.empty() && chunk_.size() + data.size() > kChunkBytes) FlushChunk();
  const std::uint64_t ns = static_cast<std::uint64_t>(log) * kNanosecondsPerMicrosecond;
  std::string& index = chunk_index_[channel];
  Add(ns, &index);
  Add(std::uint64_t{chunk_.size()}, &index);
  std::string head;
  Add(channel, &head);
  Add(static_cast<std::uint32_t>(counts_.at(channel)), &head);  // counts up within the channel
  Add(ns, &head);
  Add(static_cast<std::uint64_t>(publish) * kNanosecondsPerMicrosecond, &head);
  chunk_.push_back(static_cast<char>(kMessage));
  Add(std::uint64_t{head.size() + data.size()}, &chunk_);
  chunk_.append(head).append(data);
  chunk_span_.Add(ns);
  span_.Add(ns);
  ++counts_[channel];
  ++messages_;
}

void McapWriter::FlushChunk() {
  if (chunk_.empty()) return;
  if (chunk_index_.empty()) chunk_span_ = {0, 0};  // schemas and channels alone
  const std::uint64_t chunk_at = at_;
  const std::string packed = Pack(chunk_);
  std::string chunk;
  Add(chunk_span_.first, &chunk);
  Add(chunk_span_.last, &chunk);
  Add(std::uint64_t{chunk_.size()}, &chunk);
  Add(Crc(0, chunk_), &chunk);
  AddText("zstd", &chunk);
  Add(std::uint64_t{packed.size()}, &chunk);
  Put(Record(kChunk, chunk + packed));
  const std::uint64_t chunk_bytes = at_ - chunk_at, index_at = at_;

  std::string places;  // of each channel's index
  for (const auto& [channel, entries] : chunk_index_) {
    Add(channel, &places);
    Add(at_, &places);
    std::string index;
    Add(channel, &index);
    AddText(entries, &index);
    Put(Record(kMessageIndex, index));
  }
  std::string index;
  Add(chunk_span_.first, &index);
  Add(chunk_span_.last, &index);
  Add(chunk_at, &index);
  Add(chunk_bytes, &index);
  AddText(places, &index);
  Add(at_ - index_at, &index);
  AddText("zstd", &index);
  Add(std::uint64_t{packed.size()}, &index);
  Add(std::uint64_t{chunk_.size()}, &index);
  AddToSummary(kChunkIndex, index);
  ++chunks_;
  chunk_.clear();
  chunk_index_.clear();
  chunk_span_ = {};
}

std::string McapWriter::Statistics() const {
  std::string statistics;
  Add(messages_, &statistics);
  Add(schemas_, &statistics);
  Add(static_cast<std::uint32_t>(counts_.size()), &statistics);
  Add(std::uint32_t{0}, &statistics);  // attachments
  Add(std::uint32_t{0}, &statistics);  // metadata
  Add(chunks_, &statistics);
  Add(messages_ == 0 ? 0 : span_.first, &statistics);
  Add(span_.last, &statistics);
  std::string counts;
  for (const auto& [channel, count] : counts_) {
    Add(channel, &counts);
    Add(count, &counts);
  }
  AddText(counts, &statistics);
  return statistics;
}

void McapWriter::Finish() {
  FlushChunk();
  std::string data_crc;
  Add(crc_, &data_crc);
  Put(Record(kDataEnd, data_crc));

  AddToSummary(kStatistics, Statistics());
  const std::uint64_t summary_at = at_;
  crc_ = 0;
  std::string offsets;
  for (const auto& [opcode, records] : summary_) {
    std::string offset(1, static_cast<char>(opcode));
    Add(at_, &offset);
    Add(std::uint64_t{records.size()}, &offset);
    offsets += Record(kSummaryOffset, offset);
    Put(records);
  }
  const std::uint64_t offsets_at = at_;
  Put(offsets);
  std::string footer;
  Add(summary_at, &footer);
  Add(offsets_at, &footer);
  Add(std::uint32_t{0}, &footer);
  std::string record = Record(kFooter, footer);
  record.resize(record.size() - sizeof(std::uint32_t));
  Add(Crc(crc_, record), &record);  // of the summary and of the footer so far
  Put(record);
  Put({kMagic, sizeof(kMagic) - 1});
}

}  // namespace rgbdt
