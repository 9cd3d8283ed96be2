#include "services/bus/internal/sent_messages.h"

#include <algorithm>
#include <utility>

namespace rgbdt {
namespace {

constexpr std::size_t kShortHeader = 8, kFragmentHeader = 20;
constexpr std::size_t kFragmentBytes = SentMessage::kDatagramBytes - kFragmentHeader;

void PutBigEndian(std::uint64_t value, int bytes, Bytes* to) {
  while (bytes-- > 0) to->push_back(static_cast<std::uint8_t>(value >> 8 * bytes));
}

void PutText(const std::string& text, Bytes* to) {
  to->insert(to->end(), text.begin(), text.end());
}

std::size_t CountDatagrams(const std::string& channel, std::size_t bytes) {
  const std::size_t named = channel.size() + 1 + bytes;
  if (kShortHeader + named <= SentMessage::kDatagramBytes) return 1;
  return (named + kFragmentBytes - 1) / kFragmentBytes;
}

}  // namespace

SentMessage::SentMessage(std::uint32_t seq, std::string channel, Bytes bytes)
    : seq_(seq),
      channel_(std::move(channel)),
      bytes_(std::move(bytes)),
      datagrams_(CountDatagrams(channel_, bytes_.size())) {}

bool SentMessage::Fits(const std::string& channel, std::size_t bytes) {
  return CountDatagrams(channel, bytes) <= 0xffff;
}

// The channel's name and its 0 count as the first fragment's.
std::size_t SentMessage::Begin(std::size_t number) const {
  if (number == 0) return 0;
  return std::min(bytes_.size(), number * kFragmentBytes - channel_.size() - 1);
}

Bytes SentMessage::Header(std::size_t number) const {
  Bytes header;
  header.reserve(kDatagramBytes);
  PutText(datagrams_ == 1 ? "LC02" : "LC03", &header);
  PutBigEndian(seq_, 4, &header);
  if (datagrams_ > 1) {
    PutBigEndian(bytes_.size(), 4, &header);
    PutBigEndian(Begin(number), 4, &header);
    PutBigEndian(number, 2, &header);
    PutBigEndian(datagrams_, 2, &header);
  }
  if (number == 0) {
    PutText(channel_, &header);
    header.push_back(0);
  }
  return header;
}

std::pair<const std::uint8_t*, std::size_t> SentMessage::Data(std::size_t number) const {
  const std::size_t begin = Begin(number);
  const std::size_t end = number + 1 == datagrams_ ? bytes_.size() : Begin(number + 1);
  return {bytes_.data() + begin, end - begin};
}

const SentMessage& SentMessages::Add(std::string channel, Bytes bytes, Utime now) {
  bytes_ += bytes.size();
  kept_.push_back({SentMessage(next_++, std::move(channel), std::move(bytes)), now, {}});
  Forget(now);
  return kept_.back().message;
}

// The newest stays: it is being sent.
void SentMessages::Forget(Utime now) {
  while (kept_.size() > 1 && (bytes_ > kMaxBytes || now - kept_.front().sent > kKept)) {
    bytes_ -= kept_.front().message.bytes();
    kept_.pop_front();
  }
}

std::vector<Bytes> SentMessages::Repeat(const std::vector<MissingParts>& parts, Utime now) {
  const Utime since = std::min(now - allowed_at_, kMicrosecondsPerSecond);
  allowance_ =
      std::min(kRepeatedAtOnce, allowance_ + since * kRepeatedPerSecond / kMicrosecondsPerSecond);
  allowed_at_ = now;
  std::vector<Bytes> datagrams;
  const auto repeat = [&](Kept* kept, std::size_t number) {
    if (number >= kept->message.datagrams() || allowance_ <= 0) return;
    const auto [when, is_first] = kept->repeated.try_emplace(number, now);
    if (!is_first && now - when->second < kPause) return;
    when->second = now;
    Bytes bytes = kept->message.Header(number);
    const auto [data, size] = kept->message.Data(number);
    bytes.insert(bytes.end(), data, data + size);
    allowance_ -= static_cast<std::int64_t>(bytes.size());
    datagrams.push_back(std::move(bytes));
  };
  for (const MissingParts& part : parts) {
    const std::uint32_t index = part.seq - oldest();  // what is no longer kept wraps to beyond
    if (index >= kept_.size()) continue;
    if (part.fragments.empty()) repeat(&kept_[index], 0);
    for (const std::uint16_t number : part.fragments) repeat(&kept_[index], number);
  }
  return datagrams;
}

}  // namespace rgbdt
