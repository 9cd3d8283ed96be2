#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "services/bus/internal/datagram.h"
#include "services/bus/internal/partial_message.h"

namespace rgbdt {

/// Makes messages of datagrams. Whatever these say, a message that comes out is whole: each of its
/// bytes was sent, once. What is held is bounded: one message a sender, the newest; no larger than
/// a message may be; 64 MiB and 256 senders in all, of which the one quiet for longest gives way.
class Reassembly {
 public:
  using Sender = std::pair<std::uint32_t, std::uint16_t>;  ///< address and port
  using IsWanted = std::function<bool(const std::string& channel)>;

  /// Messages on channels that nobody wants are passed over.
  explicit Reassembly(IsWanted is_wanted) : is_wanted_(std::move(is_wanted)) {}

  /// The message that the datagram completes. A fragment 0 begins a message; fragments of one whose
  /// beginning did not come are passed over, repeated ones too. Where a fragment contradicts those
  /// before it `why` says how, and it is dropped.
  std::optional<WholeMessage> Add(const Sender& sender, const Datagram& datagram, const char** why);

  std::size_t bytes_held() const { return bytes_held_; }
  std::size_t senders_held() const { return partial_.size(); }

 private:
  struct Partial {
    std::uint32_t seq;
    PartialMessage message;
    std::uint64_t touched;
  };
  using Partials = std::map<Sender, Partial>;

  /// The one that the fragment belongs to, begun where it is a first one.
  Partials::iterator Find(const Sender& sender, const Datagram& fragment, const char** why);
  Partials::iterator Begin(const Sender& sender, const Datagram& fragment, const char** why);
  void Erase(Partials::iterator partial);
  void MakeRoom(std::size_t bytes);

  IsWanted is_wanted_;
  Partials partial_;
  std::size_t bytes_held_ = 0;
  std::uint64_t now_ = 0;  // counts datagrams
};

}  // namespace rgbdt
