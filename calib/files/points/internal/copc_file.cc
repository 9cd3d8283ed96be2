#include <algorithm>
#include <cstring>
#include <iterator>
#include <limits>
#include <utility>

#include "calib/files/points/internal/laz_chunk.h"
#include "calib/files/points/internal/laz_file.h"
#include "calib/files/points/internal/octree.h"
#include "calib/model/errors.h"

namespace rgbdt::laz {
namespace {

using las::Put;

constexpr std::size_t kInfoBytes = 160, kExtendedHeaderBytes = 60;

std::vector<std::array<std::int32_t, 3>> PlacesOf(const std::string& records, std::size_t stride) {
  std::vector<std::array<std::int32_t, 3>> places(records.size() / stride);
  for (std::size_t i = 0; i < places.size(); ++i) {
    std::memcpy(places[i].data(), records.data() + i * stride, sizeof places[i]);
  }
  return places;
}

Chunks CompressNodes(const Octree& octree, const std::string& records, std::size_t stride) {
  Chunks chunks;
  chunks.same_size = false;
  for (const Octree::Node& node : octree.nodes) {
    std::string own;
    own.reserve(node.points.size() * stride);
    for (const std::uint32_t point : node.points) own.append(records, point * stride, stride);
    chunks.bytes.push_back(EncodeChunk(own, stride));
    chunks.points.push_back(static_cast<std::uint32_t>(node.points.size()));
    if (chunks.bytes.back().size() > std::numeric_limits<std::int32_t>::max()) {
      throw InputError("COPC holds no more than 2 GiB of points in one place; LAZ does");
    }
  }
  return chunks;
}

std::pair<double, double> TimesOf(const std::string& records, std::size_t stride) {
  std::pair<double, double> times(std::numeric_limits<double>::infinity(),
                                  -std::numeric_limits<double>::infinity());
  for (std::size_t at = kGpsTimeAt; at < records.size(); at += stride) {
    double time;
    std::memcpy(&time, records.data() + at, sizeof time);
    times = {std::min(times.first, time), std::max(times.second, time)};
  }
  return times;
}

// "info VLR" of the specification.
las::Record InfoRecord(const Octree& octree, double step_m, std::pair<double, double> times,
                       std::uint64_t hierarchy_at) {
  las::Record record{"copc", 1, "COPC info VLR", {}};
  const double half = 0.5 * static_cast<double>(octree.side);
  for (const std::int64_t least : octree.least) {
    Put((static_cast<double>(least) + half) * step_m, &record.data);
  }
  Put(half * step_m, &record.data);
  Put(2 * half * step_m / static_cast<double>(kCellsAlong), &record.data);
  Put(hierarchy_at, &record.data);
  Put(std::uint64_t{32} * octree.nodes.size(), &record.data);
  Put(times.first, &record.data);
  Put(times.second, &record.data);
  record.data.resize(kInfoBytes);
  return record;
}

// "hierarchy VLR" of the specification, as one page: an extended record behind the points.
std::string HierarchyRecord(const Octree& octree, const Chunks& chunks, std::uint64_t first_chunk) {
  std::string out;
  Put<std::uint16_t>(0, &out);
  las::PutText("copc", 16, &out);
  Put<std::uint16_t>(1000, &out);
  Put(std::uint64_t{32} * octree.nodes.size(), &out);
  las::PutText("EPT hierarchy", 32, &out);
  std::uint64_t at = first_chunk;
  for (std::size_t i = 0; i < octree.nodes.size(); ++i) {
    Put(octree.nodes[i].level, &out);
    for (const std::uint32_t along : octree.nodes[i].at) Put(along, &out);
    Put(at, &out);
    Put(static_cast<std::uint32_t>(chunks.bytes[i].size()), &out);
    Put(chunks.points[i], &out);
    at += chunks.bytes[i].size();
  }
  return out;
}

}  // namespace

Parts CopcFile(const las::Layout& plain, const std::string& records) {
  const std::size_t stride = plain.RecordBytes();
  const Octree octree = MakeOctree(PlacesOf(records, stride));
  Chunks chunks = CompressNodes(octree, records, stride);
  std::string table = ChunkTable(chunks);
  las::Layout layout = plain;
  layout.compressed = true;
  layout.last.push_back(LaszipRecord(stride, false));
  layout.first.push_back(InfoRecord(octree, layout.step_m, {}, 0));  // for its length
  const std::uint64_t first_chunk = LazHead(layout, chunks).size();
  layout.extended_at = first_chunk + table.size();
  for (const std::string& chunk : chunks.bytes) layout.extended_at += chunk.size();
  layout.first[0] = InfoRecord(octree, layout.step_m, TimesOf(records, stride),
                               layout.extended_at + kExtendedHeaderBytes);
  Parts parts = {LazHead(layout, chunks)};
  std::string hierarchy = HierarchyRecord(octree, chunks, first_chunk);
  std::move(chunks.bytes.begin(), chunks.bytes.end(), std::back_inserter(parts));
  parts.push_back(std::move(table));
  parts.push_back(std::move(hierarchy));
  return parts;
}

}  // namespace rgbdt::laz
