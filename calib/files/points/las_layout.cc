#include "calib/files/points/internal/las_layout.h"

#include <algorithm>
#include <cstring>
#include <iterator>

#include "calib/model/version.h"

namespace rgbdt::las {
namespace {

constexpr std::uint16_t kHeaderBytes = 375;
constexpr std::uint16_t kDescriptorBytes = 192;  // of an extra dimension
constexpr std::uint16_t kFormat7Bytes = 36;
constexpr std::uint16_t kTextRecord = 3, kExtraBytesRecord = 4;
constexpr const char* kSpecification = "LASF_Spec";

void PutRecord(const Record& record, std::string* out) {
  Put<std::uint16_t>(0, out);
  PutText(record.user, 16, out);
  Put(record.id, out);
  Put(static_cast<std::uint16_t>(record.data.size()), out);
  PutText(record.description, 32, out);
  *out += record.data;
}

std::string DescriptorOf(const ExtraDimension& dimension) {
  std::string bytes;
  Put<std::uint16_t>(0, &bytes);
  Put(static_cast<std::uint8_t>(dimension.type), &bytes);
  Put<std::uint8_t>(0, &bytes);  // no scale, no offset, no value that stands for none
  PutText(dimension.name, 32, &bytes);
  bytes.resize(kDescriptorBytes - 32);
  PutText(dimension.description, 32, &bytes);
  return bytes;
}

std::string RecordsOf(const Layout& layout) {
  std::string descriptors, records;
  for (const Record& record : layout.first) PutRecord(record, &records);
  for (const ExtraDimension& dimension : layout.extra) descriptors += DescriptorOf(dimension);
  PutRecord({kSpecification, kExtraBytesRecord, "Extra Bytes Record", descriptors}, &records);
  // Its length has 16 bits, and it ends with a zero.
  PutRecord(
      {kSpecification, kTextRecord, "Text Area Description", layout.text.substr(0, 65534) + '\0'},
      &records);
  for (const Record& record : layout.last) PutRecord(record, &records);
  return records;
}

}  // namespace

std::size_t Layout::RecordBytes() const { return kFormat7Bytes + 4 * extra.size(); }

void PutText(const std::string& text, std::size_t size, std::string* out) {
  std::string field = text.substr(0, size);
  field.resize(size);
  *out += field;
}

std::string Head(const Layout& layout) {
  const std::string records = RecordsOf(layout);
  const std::uint16_t global_encoding = 1 | 16;  // adjusted standard GPS time; WKT, as 7 demands
  std::string out = "LASF";
  Put<std::uint16_t>(0, &out);  // file source
  Put(global_encoding, &out);
  PutText("", 16, &out);  // project
  out += std::string("\x01\x04", 2);
  PutText("OTHER", 32, &out);
  PutText(std::string("rgbdt ") + Version(), 32, &out);
  Put<std::uint32_t>(0, &out);  // no day and year: the same cloud gives the same bytes
  Put(kHeaderBytes, &out);
  Put(static_cast<std::uint32_t>(kHeaderBytes + records.size()), &out);
  Put(static_cast<std::uint32_t>(2 + layout.first.size() + layout.last.size()), &out);  // records
  Put<std::uint8_t>(layout.compressed ? 7 | 0x80 : 7, &out);
  Put(static_cast<std::uint16_t>(layout.RecordBytes()), &out);
  PutText("", 4 + 5 * 4, &out);  // counts of LAS 1.2, which format 7 does without
  for (int axis = 0; axis < 3; ++axis) Put(layout.step_m, &out);
  for (int axis = 0; axis < 3; ++axis) Put(0.0, &out);  // offsets
  for (int axis = 0; axis < 3; ++axis) {
    Put(layout.most[axis], &out);
    Put(layout.least[axis], &out);
  }
  PutText("", 8, &out);  // no waveforms
  Put(layout.extended_at, &out);
  Put<std::uint32_t>(layout.extended_at > 0 ? 1 : 0, &out);
  Put(layout.points, &out);
  Put(layout.points, &out);   // first returns: all
  PutText("", 14 * 8, &out);  // others
  return out + records;
}

double GpsTime(Utime utime) {
  // The days from which on UTC is one second more behind GPS (IERS Bulletin C), as seconds of UTC
  // since 1970.
  static constexpr std::int64_t leaps[] = {
      362793600, 394329600,  425865600,  489024000,  567993600,  631152000,
      662688000, 709948800,  741484800,  773020800,  820454400,  867715200,
      915148800, 1136073600, 1230768000, 1341100800, 1435708800, 1483228800};
  constexpr std::int64_t epoch = 315964800;  // 6 January 1980
  constexpr std::int64_t adjusted = 1'000'000'000;
  const std::int64_t second = utime / 1'000'000;
  const auto passed = std::upper_bound(std::begin(leaps), std::end(leaps), second);
  const std::int64_t shift = std::distance(std::begin(leaps), passed) - epoch - adjusted;
  return static_cast<double>(utime + shift * 1'000'000) * 1e-6;
}

}  // namespace rgbdt::las
