#include "calib/files/points/internal/laz_file.h"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <string_view>
#include <utility>

#include "calib/files/points/internal/laz_chunk.h"
#include "calib/files/points/internal/laz_integers.h"

namespace rgbdt::laz {

using las::Put;

las::Record LaszipRecord(std::size_t record_bytes, bool same_size) {
  las::Record record{"laszip encoded", 22204, "laszip", {}};
  std::string* const out = &record.data;
  Put<std::uint16_t>(3, out);  // layers and chunks
  Put<std::uint16_t>(0, out);  // arithmetic coder
  *out += std::string("\x03\x04", 2);
  Put<std::uint16_t>(3, out);  // LASzip 3.4.3, whose format this is
  Put<std::uint32_t>(0, out);  // options
  Put(same_size ? static_cast<std::uint32_t>(kChunkPoints) : 0xffffffffU, out);
  Put<std::int64_t>(-1, out);  // extended records within: none
  Put<std::int64_t>(-1, out);
  const auto extra = static_cast<std::uint16_t>(record_bytes - kExtraAt);
  Put<std::uint16_t>(extra > 0 ? 3 : 2, out);
  // Item, bytes, version: POINT14, RGB14, BYTE14.
  for (const std::uint16_t number : {10, 30, 3, 11, 6, 3}) Put(number, out);
  if (extra == 0) return record;
  Put<std::uint16_t>(14, out);
  Put(extra, out);
  Put<std::uint16_t>(3, out);
  return record;
}

std::string ChunkTable(const Chunks& chunks) {
  std::string out;
  Put<std::uint32_t>(0, &out);  // version
  Put(static_cast<std::uint32_t>(chunks.bytes.size()), &out);
  IntegerModel model(32, 2);
  ArithmeticEncoder encoder;
  std::uint32_t points = 0, bytes = 0;
  const auto encode = [&](std::uint32_t* last, std::size_t value, std::uint32_t context) {
    const auto now = static_cast<std::uint32_t>(value);
    model.Encode(static_cast<std::int32_t>(*last), static_cast<std::int32_t>(now), context,
                 &encoder);
    *last = now;
  };
  for (std::size_t i = 0; i < chunks.bytes.size(); ++i) {
    if (!chunks.same_size) encode(&points, chunks.points[i], 0);
    encode(&bytes, chunks.bytes[i].size(), 1);
  }
  return out + encoder.Finish();
}

std::string LazHead(const las::Layout& layout, const Chunks& chunks) {
  std::string out = las::Head(layout);
  const std::uint64_t begin = out.size() + sizeof(std::uint64_t);
  Put(std::accumulate(chunks.bytes.begin(), chunks.bytes.end(), begin,
                      [](std::uint64_t sum, const std::string& c) { return sum + c.size(); }),
      &out);
  return out;
}

Parts LazFile(const las::Layout& plain, const std::string& records) {
  las::Layout layout = plain;
  layout.compressed = true;
  layout.last.push_back(LaszipRecord(layout.RecordBytes(), true));
  const std::size_t stride = kChunkPoints * layout.RecordBytes();
  Chunks chunks;
  for (std::size_t at = 0; at < records.size(); at += stride) {
    chunks.bytes.push_back(
        EncodeChunk(std::string_view(records).substr(at, stride), layout.RecordBytes()));
  }
  Parts parts = {LazHead(layout, chunks)};
  std::string table = ChunkTable(chunks);
  std::move(chunks.bytes.begin(), chunks.bytes.end(), std::back_inserter(parts));
  parts.push_back(std::move(table));
  return parts;
}

}  // namespace rgbdt::laz
