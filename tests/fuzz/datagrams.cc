// What a receiver of the bus makes of datagrams: of several senders, short, fragments, or rubbish.
// Each is a byte (sender; whether the magic is put right, and to which) and a piece; or a byte that
// lets time go by.
#include "services/bus/internal/datagram.h"
#include "services/bus/internal/reassembly.h"
#include "services/bus/internal/repaired_streams.h"
#include "services/bus/internal/sent_messages.h"
#include "services/messages/limits.h"
#include "tests/fuzz/fuzz.h"

namespace rgbdt {
namespace {

constexpr unsigned kRaw = 0x80, kFragment = 0x40, kSender = 0x3f;
constexpr unsigned kLater = 0x3f;  // in place of a sender

std::string TakeDatagram(unsigned kind, fuzz::Input* input) {
  std::string bytes = input->Piece();
  if ((kind & kRaw) == 0) bytes.insert(0, (kind & kFragment) != 0 ? "LC03" : "LC02");
  return bytes;
}

// What was taken of it is the same message again.
template <typename T>
void CrossAgain(const T& message) {
  const Bytes bytes = Encode(message);
  const RepairMessage again = DecodeRepairMessage(bytes.data(), bytes.size());
  fuzz::Require(std::holds_alternative<T>(again) && Encode(std::get<T>(again)) == bytes,
                "a message of repairs that crosses again");
}

// As the receiver of a bus between machines does.
void TakeRepaired(const Reassembly::Sender& sender, const Datagram& datagram, Utime now,
                  RepairedStreams* streams) {
  const char* why = nullptr;
  if (datagram.is_fragment || datagram.channel != kRepairChannel) {
    streams->Add(sender, datagram, now, &why);
  } else {
    const RepairMessage message = DecodeRepairMessage(datagram.data, datagram.size);
    if (const auto* beat = std::get_if<Beat>(&message)) {
      CrossAgain(*beat);
      streams->OnBeat(sender, *beat, now, now);
    }
    if (const auto* request = std::get_if<RepairRequest>(&message)) {
      CrossAgain(*request);
      streams->OnRequest(*request, now);
      SentMessages sent;
      sent.Add("A", Bytes(5000, 1), now);
      sent.Repeat(request->parts, now);
    }
    if (const auto* repair = std::get_if<Repair>(&message)) {
      const auto lost = ParseDatagram(repair->datagram.data(), repair->datagram.size(), &why);
      if (lost) streams->AddRepair(sender, *lost, now, &why);
    }
  }
  fuzz::Require(streams->bytes_held() <= RepairedStreams::kMaxBytesHeld,
                "no more held than is promised");
  for (const RepairRequest& request : streams->Ask(now)) {
    fuzz::Require(Encode(request).size() <= SentMessage::kDatagramBytes, "a request of a datagram");
  }
  streams->Take();
  fuzz::Require(!streams->NextAsk() || streams->bytes_held() > 0,
                "what is missing takes memory, too, that is counted");
}

}  // namespace
}  // namespace rgbdt

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rgbdt;
  Reassembly reassembly([](const std::string& channel) { return channel[0] != 'X'; });
  RepairedStreams streams([](const std::string& channel) { return channel[0] != 'X'; });
  Utime now = 0;
  fuzz::Input input(data, size);
  while (!input.empty()) {
    const unsigned kind = input.Byte();
    if ((kind & kSender) == kLater) {
      now += RepairedStreams::kForgotten;
      continue;
    }
    const std::string bytes = TakeDatagram(kind, &input);
    const char* why = nullptr;
    const auto datagram = ParseDatagram(fuzz::Data(bytes), bytes.size(), &why);
    fuzz::Require(datagram.has_value() || why != nullptr, "a reason for what is refused");
    if (!datagram) continue;
    why = nullptr;
    const Reassembly::Sender sender(kind & kSender, 7667);
    TakeRepaired(sender, *datagram, now += 10'000, &streams);
    const auto whole = reassembly.Add(sender, *datagram, &why);
    if (whole && datagram->is_fragment) {
      fuzz::Require(whole->bytes.size() == datagram->message_bytes, "a message that is whole");
    }
    fuzz::Require(
        reassembly.bytes_held() <= std::size_t{64} << 20 && reassembly.senders_held() <= 256,
        "no more held than is promised");
  }
  const LinkReport report = streams.report();
  fuzz::Require(report.datagrams_lost >= 0 && report.messages_given_up >= 0 &&
                    report.datagrams_repaired >= 0 && report.worst.find('\n') == std::string::npos,
                "counts, and who lost most in one line");
  return 0;
}
