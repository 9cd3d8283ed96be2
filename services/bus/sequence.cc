#include "services/bus/sequence.h"

#include "calib/model/said_again.h"

namespace rgbdt {
namespace {

constexpr std::int64_t kWindow = 64;
constexpr std::int64_t kMaxLeap = 1'000'000;

// Bits 1 to `count`.
std::uint64_t Ones(std::int64_t count) {
  return count >= kWindow - 1 ? ~std::uint64_t{1} : ((std::uint64_t{1} << count) - 1) << 1;
}

}  // namespace

SequenceCounter::Step SequenceCounter::Add(std::int64_t seq) {
  if (seq == kSaidAgain) return {Kind::kSaidAgain, 0};
  if (newest_ < 0) {
    newest_ = seq;
    return {Kind::kFirst, 0};
  }
  const std::int64_t ahead = seq - newest_;
  if (ahead > kMaxLeap) return Restart(seq);
  if (ahead > 0) {
    missing_ = (ahead < kWindow ? missing_ << ahead : 0) | Ones(ahead - 1);
    newest_ = seq;
    return {ahead == 1 ? Kind::kNext : Kind::kGap, ahead - 1};
  }
  if (-ahead < kWindow && (missing_ >> -ahead & 1) != 0) {
    missing_ &= ~(std::uint64_t{1} << -ahead);
    return {Kind::kLate, -1};
  }
  if (-ahead >= kWindow || (seq == 0 && ahead < 0)) return Restart(seq);
  return {Kind::kDuplicate, 0};
}

SequenceCounter::Step SequenceCounter::Restart(std::int64_t seq) {
  const std::int64_t before = seq < kWindow ? seq : 0;
  newest_ = seq;
  missing_ = Ones(before);
  return {Kind::kRestart, before};
}

}  // namespace rgbdt
