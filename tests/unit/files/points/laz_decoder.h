#pragma once

// A decoder of LAZ chunks for tests, from the format alone: nothing of it is shared with what
// encodes. Foreign readers decode the same files in tests/cli/export_las_test.sh.

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace rgbdt::test {

class LazDecoder {
 public:
  struct Symbols {
    explicit Symbols(std::uint32_t n) : counts(n, 1), until(n) {
      Renew();
      until = left = (n + 6) >> 1;
    }
    void Renew() {
      total += until;
      if (total > 32768) {
        total = 0;
        for (auto& count : counts) total += count = (count + 1) >> 1;
      }
      below.clear();
      std::uint32_t sum = 0;
      for (const auto count : counts) {
        below.push_back((0x80000000U / total * sum) >> 16);
        sum += count;
      }
      const auto n = static_cast<std::uint32_t>(counts.size());
      until = left = std::min(5 * until >> 2, (n + 6) << 3);
    }
    std::vector<std::uint32_t> counts, below;
    std::uint32_t total = 0, until, left = 0;
  };

  struct Bits {
    std::uint32_t zeros = 1, all = 2, share = 4096, until = 4, left = 4;
  };

  explicit LazDecoder(std::string bytes) : bytes_(std::move(bytes)) {
    for (int i = 0; i < 4; ++i) value_ = value_ << 8 | Next();
  }

  std::uint32_t Symbol(Symbols* model) {
    const std::uint32_t unit = length_ >> 15;
    const auto after = std::upper_bound(model->below.begin(), model->below.end(), value_ / unit);
    const auto symbol = static_cast<std::uint32_t>(after - model->below.begin()) - 1;
    const std::uint32_t low = model->below[symbol] * unit;
    Take(low, (after == model->below.end() ? length_ : *after * unit) - low);
    ++model->counts[symbol];
    if (--model->left == 0) model->Renew();
    return symbol;
  }

  bool Bit(Bits* model) {
    const std::uint32_t zeros = model->share * (length_ >> 13);
    const bool bit = value_ >= zeros;
    Take(bit ? zeros : 0, bit ? length_ - zeros : zeros);
    if (!bit) ++model->zeros;
    if (--model->left > 0) return bit;
    model->all += model->until;
    if (model->all > 8192) {
      model->all = (model->all + 1) >> 1;
      model->zeros = (model->zeros + 1) >> 1;
      if (model->zeros == model->all) ++model->all;
    }
    model->share = model->zeros * (0x80000000U / model->all) >> 18;
    model->until = model->left = std::min(5 * model->until >> 2, 64U);
    return bit;
  }

  std::uint32_t Raw(std::uint32_t bits) {
    if (bits > 19) {
      const std::uint32_t low = Raw(16);
      return Raw(bits - 16) << 16 | low;
    }
    const std::uint32_t unit = length_ >> bits, value = value_ / unit;
    Take(value * unit, unit);
    return value;
  }

 private:
  std::uint8_t Next() { return at_ < bytes_.size() ? static_cast<std::uint8_t>(bytes_[at_++]) : 0; }
  void Take(std::uint32_t low, std::uint32_t length) {
    value_ -= low;
    length_ = length;
    for (; length_ < 1U << 24; length_ <<= 8) value_ = value_ << 8 | Next();
  }

  std::string bytes_;
  std::size_t at_ = 0;
  std::uint32_t value_ = 0, length_ = 0xffffffff;
};

class LazIntegers {
 public:
  explicit LazIntegers(std::uint32_t bits = 32) : bits_(bits) {}

  std::int32_t Next(std::int32_t predicted, std::uint32_t context, LazDecoder* from) {
    width = from->Symbol(&Model(context, bits_ + 1));
    std::int64_t off = 0;
    if (width == 0) {
      off = from->Bit(&bit_) ? 1 : 0;
    } else if (width == 32) {
      off = -(std::int64_t{1} << 31);
    } else {
      off = from->Symbol(&Model(1000 + width, 1U << std::min(width, 8U)));
      if (width > 8) off = off << (width - 8) | from->Raw(width - 8);
      off += off >= 1 << (width - 1) ? 1 : 1 - (std::int64_t{1} << width);
    }
    const auto sum = static_cast<std::uint32_t>(predicted + off);
    return static_cast<std::int32_t>(bits_ == 16 ? sum & 0xffff : sum);
  }

  std::uint32_t width = 0;

 private:
  LazDecoder::Symbols& Model(std::uint32_t key, std::uint32_t symbols) {
    return models_.try_emplace(key, symbols).first->second;
  }

  std::uint32_t bits_;
  LazDecoder::Bits bit_;
  std::map<std::uint32_t, LazDecoder::Symbols> models_;
};

/// GPS times of a chunk.
class LazTimes {
 public:
  explicit LazTimes(std::int64_t first) { last_[0] = first; }

  std::int64_t Next(LazDecoder* from) {
    const std::int32_t step = step_[run_];
    const auto symbol = static_cast<std::int32_t>(from->Symbol(step == 0 ? &fresh_ : &multiples_));
    const std::int32_t whole = step == 0 ? 1 : 511;
    if (symbol == whole) return Whole(from);
    if (symbol > whole) {
      run_ = (run_ + symbol - whole) % 4;
      return Next(from);
    }
    if (step == 0) return Go(step_[run_] = integers_.Next(0, 0, from), false);
    const std::int32_t multiple = symbol <= 500 ? symbol : 500 - symbol;
    const int context = multiple == 0     ? 7
                        : multiple == -10 ? 6
                        : multiple < 0    ? 5
                        : multiple == 500 ? 4
                        : multiple >= 10  ? 3
                        : multiple > 1    ? 2
                                          : 1;
    if (multiple == 1) odd_[run_] = 0;
    seen.insert({multiple, 0}).first->second++;
    return Go(integers_.Next(static_cast<std::int32_t>(static_cast<std::uint32_t>(multiple) *
                                                       static_cast<std::uint32_t>(step)),
                             context, from),
              multiple == 0 || multiple == -10 || multiple == 500);
  }

  std::map<std::int32_t, int> seen;  ///< multiples, how often

 private:
  std::int64_t Go(std::int32_t step, bool odd) {
    if (odd && ++odd_[run_] > 3) {
      odd_[run_] = 0;
      step_[run_] = step;
    }
    return last_[run_] += step;
  }
  std::int64_t Whole(LazDecoder* from) {
    const auto high = static_cast<std::uint32_t>(
        integers_.Next(static_cast<std::int32_t>(last_[run_] >> 32), 8, from));
    const auto time = static_cast<std::int64_t>(std::uint64_t{high} << 32 | from->Raw(32));
    run_ = newest_ = (newest_ + 1) % 4;
    step_[run_] = odd_[run_] = 0;
    return last_[run_] = time;
  }

  std::array<std::int64_t, 4> last_{};
  std::array<std::int32_t, 4> step_{}, odd_{};
  std::int32_t run_ = 0, newest_ = 0;
  LazDecoder::Symbols fresh_{5}, multiples_{515};
  LazIntegers integers_;
};

/// A chunk of points of format 7 that are return 1 of 1, with extra bytes.
class LazChunkDecoder {
 public:
  LazChunkDecoder(const std::string& chunk, std::size_t record_bytes)
      : last_(chunk.substr(0, record_bytes)), times_(Get<std::int64_t>(22)) {
    std::memcpy(&points_, chunk.data() + record_bytes, 4);
    std::size_t sizes = record_bytes + 4, at = sizes + 4 * (10 + record_bytes - 36);
    for (; layers_.size() < 10 + record_bytes - 36; sizes += 4) {
      std::uint32_t size = 0;
      std::memcpy(&size, chunk.data() + sizes, 4);
      layers_.emplace_back(chunk.substr(at, size));
      there_.push_back(size > 0);
      at += size;
    }
    z_ = Get<std::int32_t>(8);
    intensity_.fill(Get<std::uint16_t>(12));
  }

  std::string Records() {
    std::string records = last_;
    for (std::uint32_t i = 1; i < points_; ++i) {
      const bool time = layers_[0].Symbol(&changes_[time_before_ ? 1 : 0]) == 16;
      NextPlace(time);
      if (there_[4]) {
        intensity_[time] =
            static_cast<std::uint16_t>(intensities_.Next(intensity_[time], 3, &layers_[4]));
        Set(12, intensity_[time]);
      }
      if (time) Set(22, times_.Next(&layers_[8]));
      time_before_ = time;
      if (there_[9]) NextColour();
      for (std::size_t b = 0; b + 36 < last_.size(); ++b) {
        if (there_[10 + b])
          last_[36 + b] += static_cast<char>(layers_[10 + b].Symbol(&Bytes(10 + b)));
      }
      records += last_;
    }
    return records;
  }

 private:
  template <typename T>
  T Get(std::size_t at) const {
    T value;
    std::memcpy(&value, last_.data() + at, sizeof value);
    return value;
  }
  template <typename T>
  void Set(std::size_t at, T value) {
    std::memcpy(last_.data() + at, &value, sizeof value);
  }
  LazDecoder::Symbols& Bytes(std::uint32_t key) {
    return bytes_.try_emplace(key, 256).first->second;
  }

  // The middle of the five; of the smallest and the largest, in turn, one leaves.
  std::int32_t Along(std::size_t axis, bool time, std::uint32_t context) {
    auto& [kept, high] = median_[2 * axis + (time ? 1 : 0)];
    const std::int32_t middle = kept[2];
    const std::int32_t step = differences_[axis].Next(middle, context, &layers_[0]);
    kept.erase(high ? kept.end() - 1 : kept.begin());
    kept.insert(std::upper_bound(kept.begin(), kept.end(), step), step);
    if (high && step >= middle)
      high = false;
    else if (!high && step <= middle)
      high = true;
    Set(4 * axis, Get<std::uint32_t>(4 * axis) + static_cast<std::uint32_t>(step));
    return static_cast<std::int32_t>(differences_[axis].width);
  }

  void NextPlace(bool time) {
    const std::int32_t x = Along(0, time, 1);
    const std::int32_t y = Along(1, time, static_cast<std::uint32_t>(std::min(x, 20) / 2 * 2 + 1));
    z_ = heights_.Next(z_, static_cast<std::uint32_t>(std::min((x + y) / 2, 18) / 2 * 2 + 1),
                       &layers_[1]);
    Set(8, z_);
  }

  void NextColour() {
    std::array<int, 6> c{}, d{};  // low and high bytes; by how much they differ
    for (std::size_t i = 0; i < 6; ++i) c[i] = Get<std::uint8_t>(30 + i);
    const std::array<int, 6> was = c;
    const std::uint32_t changed = layers_[9].Symbol(&colours_);
    const auto next = [&](std::size_t i, int predicted) {
      if ((changed >> i & 1) == 0) return;
      c[i] = (std::clamp(predicted, 0, 255) + static_cast<int>(layers_[9].Symbol(&Bytes(i)))) & 255;
      d[i] = c[i] - was[i];
    };
    next(0, c[0]);
    next(1, c[1]);
    if ((changed & 64) == 0) {
      c = {c[0], c[1], c[0], c[1], c[0], c[1]};
    } else {
      for (std::size_t half : {0, 1}) {
        next(2 + half, c[2 + half] + d[half]);
        next(4 + half, c[4 + half] + (d[half] + d[2 + half]) / 2);
      }
    }
    for (std::size_t i = 0; i < 6; ++i) Set(30 + i, static_cast<std::uint8_t>(c[i]));
  }

  std::string last_;
  LazTimes times_;
  std::uint32_t points_ = 0;
  std::vector<LazDecoder> layers_;
  std::vector<bool> there_;
  std::int32_t z_ = 0;
  std::array<std::uint16_t, 2> intensity_{};
  bool time_before_ = false;
  std::array<LazDecoder::Symbols, 2> changes_{LazDecoder::Symbols(128), LazDecoder::Symbols(128)};
  std::array<LazIntegers, 2> differences_;
  LazIntegers heights_, intensities_{16};
  std::map<std::size_t, std::pair<std::vector<std::int32_t>, bool>> median_ = {
      {0, {{0, 0, 0, 0, 0}, true}},
      {1, {{0, 0, 0, 0, 0}, true}},
      {2, {{0, 0, 0, 0, 0}, true}},
      {3, {{0, 0, 0, 0, 0}, true}}};
  LazDecoder::Symbols colours_{128};
  std::map<std::uint32_t, LazDecoder::Symbols> bytes_;
};

inline std::string DecodeLazChunk(const std::string& chunk, std::size_t record_bytes) {
  return LazChunkDecoder(chunk, record_bytes).Records();
}

}  // namespace rgbdt::test
