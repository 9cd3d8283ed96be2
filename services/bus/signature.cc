#include "services/bus/signature.h"

#include <sodium.h>

#include <algorithm>
#include <cstdlib>
#include <iterator>

#include "calib/model/errors.h"
#include "calib/model/text.h"
#include "services/messages/limits.h"

namespace rgbdt {
namespace {

constexpr char kContext[] = "rgbdt signature 1";
constexpr int kRemembered = 64;

static_assert(crypto_aead_xchacha20poly1305_ietf_NPUBBYTES == kStampBytes);
static_assert(crypto_aead_xchacha20poly1305_ietf_ABYTES == sizeof(Signature::tag));

}  // namespace

void ChannelKeys::Tag(const std::string& channel, const std::uint8_t* message, std::size_t size,
                      std::uint8_t (&tag)[sizeof(Signature::tag)]) {
  const auto [entry, is_new] = of_channels_.try_emplace(channel);
  BusKey& key = entry->second;
  if (is_new) {
    const std::string name = kContext + channel;
    crypto_generichash(key.bytes.data(), key.bytes.size(),
                       reinterpret_cast<const std::uint8_t*>(name.data()), name.size(),
                       key_.bytes.data(), key_.bytes.size());
  }
  std::uint8_t no_text = 0;
  crypto_aead_xchacha20poly1305_ietf_encrypt_detached(&no_text, tag, nullptr, &no_text, 0, message,
                                                      size, nullptr, message + size,
                                                      key.bytes.data());
}

MessageSigner::MessageSigner(const BusKey& key) : keys_(key) {
  if (sodium_init() < 0) throw InputError("libsodium finds no random numbers");
  randombytes_buf(&sender_, sizeof sender_);
}

void MessageSigner::Sign(const std::string& channel, Utime now, Bytes* message) {
  Signature signature;
  signature.sender = sender_;
  signature.number = next_++;
  signature.utime = now;
  const std::size_t size = message->size();
  message->reserve(size + kSignatureBytes);
  AppendSignature(signature, message);
  keys_.Tag(channel, message->data(), size, signature.tag);
  std::copy(std::begin(signature.tag), std::end(signature.tag),
            message->begin() + static_cast<std::ptrdiff_t>(size + kStampBytes));
}

std::string SignatureCheck::WhyNot(const std::string& channel, const std::uint8_t* data,
                                   std::size_t size, Utime arrived) {
  const auto signature = SignatureOf(data, size);
  if (!signature) return "is not signed; was its sender started without --key?";
  const std::size_t message_bytes = size - kSignatureBytes;
  std::uint8_t tag[sizeof(Signature::tag)];
  keys_.Tag(channel, data, message_bytes, tag);
  if (sodium_memcmp(tag, signature->tag, sizeof tag) != 0) {
    return "is signed with another key, or was changed on its way";
  }
  const auto may_be = [](std::int64_t value) { return value >= 0 && value <= kMaxInteger; };
  if (!may_be(signature->number) || !may_be(signature->utime)) {
    return "is signed with a number or a time that cannot be";
  }
  const Utime age = arrived - signature->utime;
  if (std::abs(age) > kMostApart) {
    return Format("was signed %.0f s %s: a recording, or two machines' clocks differ",
                  std::abs(ToSeconds(age)), age > 0 ? "ago" : "ahead of this machine's clock");
  }
  return IsNew(*signature, arrived) ? "" : "came before: it was sent once more";
}

bool SignatureCheck::IsNew(const Signature& signature, Utime arrived) {
  ForgetThoseBefore(arrived - 2 * kMostApart);
  Sender& sender = senders_[signature.sender];
  const std::int64_t ahead = signature.number - sender.newest;
  if (ahead > 0) {
    sender.came = ahead < kRemembered ? sender.came << ahead | 1U : 1U;
    sender.newest = signature.number;
  } else {
    const std::uint64_t bit = -ahead < kRemembered ? std::uint64_t{1} << -ahead : 0;
    if (bit == 0 || (sender.came & bit) != 0) return false;
    sender.came |= bit;
  }
  sender.utime = std::max(sender.utime, signature.utime);
  return true;
}

// Whose newest is too old to be taken once more has nothing to be remembered for.
void SignatureCheck::ForgetThoseBefore(Utime utime) {
  if (std::abs(utime - forgotten_at_) < kMicrosecondsPerSecond) return;
  forgotten_at_ = utime;
  for (auto it = senders_.begin(); it != senders_.end();) {
    it = it->second.utime < utime ? senders_.erase(it) : std::next(it);
  }
}

}  // namespace rgbdt
