#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "calib/model/time.h"

namespace rgbdt {

/// Writes an MCAP (mcap.dev/spec): messages in chunks packed by zstd, each with an index, and at
/// the end a summary, so a reader finds any time without reading the whole. It holds one chunk, and
/// of the chunks before it what their index takes, some 200 bytes each.
class McapWriter {
 public:
  /// `sink` takes the file's bytes, in order. `library`: who writes, e.g. "rgbdt 0.1.0".
  McapWriter(std::function<void(std::string_view)> sink, const std::string& library);

  /// A type of messages by its name ("foxglove.PointCloud"), how `data` describes it ("protobuf": a
  /// FileDescriptorSet), and that. Gives its number.
  std::uint16_t AddSchema(const std::string& name, const std::string& encoding,
                          const std::string& data);
  /// A topic of such messages, encoded as `encoding` says ("protobuf"). Gives its number. Throws
  /// InputError for more than 65535.
  std::uint16_t AddChannel(const std::string& topic, std::uint16_t schema,
                           const std::string& encoding);
  /// `log`: when it was recorded, `publish`: when it was sent [us]; neither is negative. Throws
  /// InputError for one that no reader of ours would take (kMostBagBytes).
  void Write(std::uint16_t channel, Utime log, Utime publish, std::string_view data);
  /// Writes what is left and the summary. Nothing is written after it.
  void Finish();

  std::uint64_t messages() const { return messages_; }

 private:
  struct Span {  // of log times [ns]
    std::uint64_t first = UINT64_MAX, last = 0;
    void Add(std::uint64_t ns);
  };

  void Put(std::string_view bytes);
  void FlushChunk();
  void AddToSummary(std::uint8_t opcode, const std::string& content);
  std::string Statistics() const;

  std::function<void(std::string_view)> sink_;
  std::uint64_t at_ = 0;
  std::uint32_t crc_ = 0;  // of all that was put
  std::string chunk_;      // its records, unpacked
  Span chunk_span_, span_;
  std::map<std::uint16_t, std::string> chunk_index_;  // by channel: (log time, offset) of each
  std::map<std::uint16_t, std::uint64_t> counts_;     // of messages, by channel
  std::map<std::uint8_t, std::string> summary_;       // records, by opcode
  std::uint64_t messages_ = 0;
  std::uint32_t chunks_ = 0;
  std::uint16_t schemas_ = 0;
};

}  // namespace rgbdt
