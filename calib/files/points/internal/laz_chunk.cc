#include "calib/files/points/internal/laz_chunk.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "calib/files/points/internal/laz_gps_times.h"
#include "calib/files/points/internal/laz_integers.h"

namespace rgbdt::laz {
namespace {

template <typename T>
T Field(const char* record, std::size_t at) {
  T value;
  std::memcpy(&value, record + at, sizeof value);
  return value;
}

// The bytes of one kind of field. Where it never changes it is left out: no bytes at all.
struct Layer {
  ArithmeticEncoder encoder;
  bool changes = false;

  std::string Bytes() { return changes ? encoder.Finish() : std::string(); }
};

// The median of the last five or so: an outlier leaves on the side that it is on.
class RunningMedian {
 public:
  std::int32_t Get() const { return sorted_[2]; }
  void Add(std::int32_t value) {
    const std::int32_t median = Get();
    const bool largest = drop_largest_;
    sorted_[largest ? 4 : 0] = value;
    drop_largest_ = largest ? value < median : value <= median;
    std::sort(sorted_.begin(), sorted_.end());
  }

 private:
  std::array<std::int32_t, 5> sorted_{};
  bool drop_largest_ = true;
};

std::uint32_t Even(std::uint32_t number, std::uint32_t most) {
  return std::min(number, most) & ~1U;
}

// Contexts of the format that are always the same for return 1 of 1.
constexpr std::uint32_t kSingle = 1;        // integers' contexts: 1 return
constexpr std::uint32_t kFirstAndLast = 3;  // of intensity and of what changes

// x, y and z. Which fields change (here: none but the time) stands before x.
class Positions {
 public:
  explicit Positions(const char* first) : last_z_(Field<std::int32_t>(first, 8)) {
    xy_.changes = z_.changes = true;  // always there
  }

  void Encode(const char* record, const char* before, bool new_time) {
    xy_.encoder.Encode(new_time ? 1U << 4 : 0, &changes_[new_time_before_ ? 1 : 0]);
    new_time_before_ = new_time;
    const std::uint32_t dx = EncodeAlong(0, kSingle, record, before, new_time);
    const std::uint32_t dy = EncodeAlong(1, Even(dx, 20) | kSingle, record, before, new_time);
    const auto z = Field<std::int32_t>(record, 8);
    dz_.Encode(last_z_, z, Even((dx + dy) / 2, 18) | kSingle, &z_.encoder);
    last_z_ = z;
  }
  std::string Xy() { return xy_.Bytes(); }
  std::string Z() { return z_.Bytes(); }

 private:
  // Gives the bits that it took.
  std::uint32_t EncodeAlong(std::size_t axis, std::uint32_t context, const char* record,
                            const char* before, bool new_time) {
    const auto step =
        static_cast<std::int32_t>(Field<std::uint32_t>(record, 4 * axis) -
                                  Field<std::uint32_t>(before, 4 * axis));  // may wrap around
    RunningMedian& median = medians_[axis][new_time ? 1 : 0];
    IntegerModel& model = axis == 0 ? dx_ : dy_;
    model.Encode(median.Get(), step, context, &xy_.encoder);
    median.Add(step);
    return model.Width();
  }

  Layer xy_, z_;
  std::int32_t last_z_;
  bool new_time_before_ = false;
  std::array<SymbolModel, 2> changes_{SymbolModel(128), SymbolModel(128)};
  IntegerModel dx_{32, 2}, dy_{32, 22}, dz_{32, 20};
  std::array<std::array<RunningMedian, 2>, 2> medians_;
};

// Predicted by the last one whose time changed, or did not, as well.
class Intensities {
 public:
  explicit Intensities(const char* first) { last_.fill(Field<std::uint16_t>(first, kIntensityAt)); }

  void Encode(const char* record, const char* before, bool new_time) {
    const auto intensity = Field<std::uint16_t>(record, kIntensityAt);
    if (intensity != Field<std::uint16_t>(before, kIntensityAt)) layer_.changes = true;
    std::uint16_t& last = last_[new_time ? 1 : 0];
    model_.Encode(last, intensity, kFirstAndLast, &layer_.encoder);
    last = intensity;
  }
  std::string Bytes() { return layer_.Bytes(); }

 private:
  Layer layer_;
  IntegerModel model_{16, 4};
  std::array<std::uint16_t, 2> last_;
};

class Times {
 public:
  explicit Times(const char* first) : times_(Field<std::int64_t>(first, kGpsTimeAt)) {}

  // Whether it is not the time before.
  bool Encode(const char* record, const char* before) {
    const auto time = Field<std::int64_t>(record, kGpsTimeAt);
    if (time == Field<std::int64_t>(before, kGpsTimeAt)) return false;
    layer_.changes = true;
    times_.Encode(time, &layer_.encoder);
    return true;
  }
  std::string Bytes() { return layer_.Bytes(); }

 private:
  Layer layer_;
  GpsTimes times_;
};

// Which of the six bytes changed and whether the colour is grey; then these bytes' differences,
// green and blue predicted by those before them.
class Colours {
 public:
  void Encode(const char* record, const char* before) {
    const Halves now = HalvesOf(record), last = HalvesOf(before);
    std::uint32_t changed = 0;
    for (std::size_t i = 0; i < now.size(); ++i) changed |= (now[i] != last[i] ? 1U : 0U) << i;
    const bool grey = now[0] == now[2] && now[0] == now[4] && now[1] == now[3] && now[1] == now[5];
    if (changed != 0) layer_.changes = true;
    if (!grey) changed |= 1U << 6;
    layer_.encoder.Encode(changed, &changed_);
    for (std::size_t half : {0, 1}) EncodeByte(half, now, last, last[half]);
    if (grey) return;
    for (std::size_t half : {0, 1}) {
      const std::size_t r = half, g = 2 + half, b = 4 + half;
      const int red = now[r] - last[r], green = now[g] - last[g];
      EncodeByte(g, now, last, std::clamp(last[g] + red, 0, 255));
      EncodeByte(b, now, last, std::clamp(last[b] + (red + green) / 2, 0, 255));
    }
  }
  std::string Bytes() { return layer_.Bytes(); }

 private:
  using Halves = std::array<int, 6>;  // red low, red high, green low, ...

  static Halves HalvesOf(const char* record) {
    Halves bytes{};
    for (std::size_t i = 0; i < 6; ++i) bytes[i] = Field<std::uint8_t>(record, kColourAt + i);
    return bytes;
  }
  void EncodeByte(std::size_t i, const Halves& now, const Halves& last, int predicted) {
    if (now[i] == last[i]) return;
    layer_.encoder.Encode(static_cast<std::uint8_t>(now[i] - predicted), &models_[i]);
  }

  Layer layer_;
  SymbolModel changed_{128};
  std::vector<SymbolModel> models_ = std::vector<SymbolModel>(6, SymbolModel(256));
};

// An extra byte, by itself.
class ExtraByte {
 public:
  explicit ExtraByte(std::size_t at) : at_(at) {}

  void Encode(const char* record, const char* before) {
    const auto step = static_cast<std::uint8_t>(record[at_] - before[at_]);
    if (step != 0) layer_.changes = true;
    layer_.encoder.Encode(step, &model_);
  }
  std::string Bytes() { return layer_.Bytes(); }

 private:
  std::size_t at_;
  Layer layer_;
  SymbolModel model_{256};
};

// In the order of the format; empty: class, flags, scan angle, user's byte, source.
std::vector<std::string> Layers(Positions* positions, Intensities* intensities, Times* times,
                                Colours* colours, std::vector<ExtraByte>* extra) {
  std::vector<std::string> layers = {
      positions->Xy(), positions->Z(),  {}, {}, intensities->Bytes(), {}, {}, {},
      times->Bytes(),  colours->Bytes()};
  for (ExtraByte& byte : *extra) layers.push_back(byte.Bytes());
  return layers;
}

void RequireConstant(const char* record, const char* first) {
  if (record[kFlagsAt] == 0x11 &&
      std::memcmp(record + kFlagsAt, first + kFlagsAt, kGpsTimeAt - kFlagsAt) == 0) {
    return;
  }
  throw std::invalid_argument("LAZ: a point that is not return 1 of 1, or flags that change");
}

void PutNumber(std::size_t number, std::string* out) {
  const auto value = static_cast<std::uint32_t>(number);
  out->append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace

std::string EncodeChunk(std::string_view records, std::size_t record_bytes) {
  const std::size_t points = records.size() / record_bytes;
  const char* const first = records.data();
  RequireConstant(first, first);
  Positions positions(first);
  Intensities intensities(first);
  Times times(first);
  Colours colours;
  std::vector<ExtraByte> extra;
  for (std::size_t at = kExtraAt; at < record_bytes; ++at) extra.emplace_back(at);
  for (std::size_t i = 1; i < points; ++i) {
    const char* const record = first + i * record_bytes;
    const char* const before = record - record_bytes;
    RequireConstant(record, first);
    const bool new_time = times.Encode(record, before);
    positions.Encode(record, before, new_time);
    intensities.Encode(record, before, new_time);
    colours.Encode(record, before);
    for (ExtraByte& byte : extra) byte.Encode(record, before);
  }
  const std::vector<std::string> layers =
      Layers(&positions, &intensities, &times, &colours, &extra);
  std::string out(records.substr(0, record_bytes));
  PutNumber(points, &out);
  for (const std::string& layer : layers) PutNumber(layer.size(), &out);
  for (const std::string& layer : layers) out += layer;
  return out;
}

}  // namespace rgbdt::laz
