#include "services/bus/internal/ordered_stream.h"

#include <algorithm>
#include <utility>

namespace rgbdt {

OrderedStream::Slot* OrderedStream::At(std::uint32_t seq) {
  const std::uint32_t index = seq - next_;  // of one before it: beyond the end
  return index < slots_.size() ? &slots_[index] : nullptr;
}

// Those before `next` are known to have been sent.
void OrderedStream::Reach(std::uint32_t next, Utime now) {
  if (!IsAt(next, next_)) return;
  const std::uint32_t ahead = next - next_;
  if (ahead > kMaxAhead) {
    given_up_ += ahead - static_cast<std::uint32_t>(slots_.size());
    for (Slot& slot : slots_) GiveUp(&slot);
    Advance();
    next_ = next;
    return;
  }
  while (slots_.size() < ahead) {
    slots_.emplace_back();
    ++unsettled_;
    AskAt(now + kGrace, &slots_.back());
  }
}

void OrderedStream::AskAt(Utime when, Slot* slot) {
  slot->ask_at = when;
  earliest_ask_ = std::min(earliest_ask_, when);
}

bool OrderedStream::Add(const Datagram& datagram, Utime now, const char** why) {
  if (!IsAt(datagram.seq, next_)) return false;
  Reach(datagram.seq + 1, now);
  Slot* slot = At(datagram.seq);
  if (slot == nullptr || slot->settled) return false;
  AskAt(now + kGrace, slot);
  const bool taken =
      datagram.is_fragment ? AddFragment(datagram, slot, why) : AddWhole(datagram, slot);
  Advance();
  return taken;
}

bool OrderedStream::AddWhole(const Datagram& datagram, Slot* slot) {
  WholeMessage message{std::string(datagram.channel), {}};
  if (is_wanted_(message.channel)) {
    message.bytes.assign(datagram.data, datagram.data + datagram.size);
    Finish(std::move(message), slot);
  }
  Settle(slot);
  return true;
}

bool OrderedStream::AddFragment(const Datagram& fragment, Slot* slot, const char** why) {
  if (!slot->partial) {
    *why = PartialMessage::TooLarge(fragment);
    if (*why != nullptr) {
      Settle(slot);
      return false;
    }
    slot->partial.emplace(fragment);
    bytes_held_ += slot->partial->memory();
  } else if (!slot->partial->Fits(fragment)) {
    *why = "a fragment of a message of another size than those before it";
    return false;
  }
  if (!slot->partial->Add(fragment)) return false;
  slot->asked = 0;  // it makes progress
  if (fragment.number == 0 && !is_wanted_(*slot->partial->channel())) {
    Settle(slot);
  } else if (slot->partial->missing() == 0) {
    std::optional<WholeMessage> message = slot->partial->Take();
    if (!message) *why = "fragments that overlap, or leave a hole";
    Settle(slot);
    if (message) Finish(std::move(*message), slot);
  }
  return true;
}

void OrderedStream::Finish(WholeMessage message, Slot* slot) {
  bytes_held_ += message.bytes.size();
  slot->whole = std::move(message);
}

// Nothing more of it is needed.
void OrderedStream::Settle(Slot* slot) {
  if (slot->settled) return;
  slot->settled = true;
  if (--unsettled_ == 0) earliest_ask_ = kNever;
  if (slot->partial) bytes_held_ -= slot->partial->memory();
  slot->partial.reset();
}

void OrderedStream::GiveUp(Slot* slot) {
  if (slot->settled) return;
  ++given_up_;
  Settle(slot);
}

// What holds up nothing any more is ready to be taken, and no longer held.
void OrderedStream::Advance() {
  while (!slots_.empty() && slots_.front().settled) {
    if (slots_.front().whole) {
      bytes_held_ -= slots_.front().whole->bytes.size();
      ready_.push_back(std::move(*slots_.front().whole));
    }
    slots_.pop_front();
    ++next_;
  }
}

void OrderedStream::OnBeat(std::uint32_t oldest, std::uint32_t next, Utime now) {
  if (!IsAt(next, oldest)) return;
  Reach(oldest, now);
  for (std::size_t i = 0; IsAt(oldest, next_) && i < oldest - next_; ++i) GiveUp(&slots_[i]);
  Advance();
  Reach(next, now);
}

void OrderedStream::OnAskedByOthers(const std::vector<MissingParts>& parts, Utime now) {
  for (const MissingParts& part : parts) {
    Slot* slot = At(part.seq);
    if (slot != nullptr) slot->ask_at = std::max(slot->ask_at, now + kFirstPause);
  }
}

// The first one alone, until it says whether anybody wants the others.
std::vector<std::uint16_t> OrderedStream::Missing(const PartialMessage& message, std::size_t most) {
  if (!message.channel()) return {0};
  std::vector<std::uint16_t> missing;
  for (std::size_t k = 0; k < message.fragments() && missing.size() < most; ++k) {
    if (!message.Has(k)) missing.push_back(static_cast<std::uint16_t>(k));
  }
  return missing;
}

std::vector<MissingParts> OrderedStream::Ask(Utime now) {
  std::vector<MissingParts> parts;
  if (unsettled_ == 0 || earliest_ask_ > now) return parts;
  earliest_ask_ = kNever;
  std::size_t asked = 0;
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    Slot& slot = slots_[i];
    if (slot.settled) continue;
    if (slot.ask_at <= now && asked < kFragmentsAsked) {
      if (slot.asked == kMaxAsked) {
        GiveUp(&slot);
        continue;
      }
      slot.ask_at = now + std::min(kLongestPause, kFirstPause << slot.asked++);
      parts.push_back(
          PartsOf(slot, next_ + static_cast<std::uint32_t>(i), kFragmentsAsked - asked));
      asked += 1 + parts.back().fragments.size();
    }
    earliest_ask_ = std::min(earliest_ask_, slot.ask_at);
  }
  Advance();
  return parts;
}

MissingParts OrderedStream::PartsOf(const Slot& slot, std::uint32_t seq, std::size_t most) {
  MissingParts part;
  part.seq = seq;
  if (slot.partial) part.fragments = Missing(*slot.partial, most);
  return part;
}

std::optional<Utime> OrderedStream::NextAsk() const {
  if (unsettled_ == 0) return std::nullopt;
  return earliest_ask_;
}

std::vector<WholeMessage> OrderedStream::Take() { return std::exchange(ready_, {}); }

void OrderedStream::GiveUpOldest() {
  if (slots_.empty()) return;
  GiveUp(&slots_.front());
  Advance();
}

}  // namespace rgbdt
