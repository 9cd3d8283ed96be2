#include "services/runtime/node_runner.h"

#include <algorithm>
#include <cstdlib>

#include "calib/model/said_again.h"
#include "services/messages/check.h"
#include "services/messages/codec.h"
#include "services/messages/limits.h"
#include "services/messages/status_counters.h"

namespace rgbdt {
namespace {

constexpr std::size_t kMaxProblemBytes = 1000;
// What strangers name themselves must not fill the memory or the status.
constexpr std::size_t kMaxKeys = 1000;
constexpr std::size_t kMaxChannelsNamed = 100;
// In ten seconds; of two senders at 1 Hz about ten, of one that is started anew one.
constexpr int kSharedFallBacks = 5;

// Whose numbers a message belongs to.
std::string SequenceOf(const Message& message) {
  std::string sender;
  if (const auto* status = std::get_if<Status>(&message)) sender = status->process;
  if (const auto* event = std::get_if<SessionEvent>(&message)) sender = event->source;
  if (const auto* pose = std::get_if<StampedPose>(&message)) sender = pose->source;
  return ChannelOf(message) + (sender.empty() ? "" : " " + sender);
}

// Not those on which each sender counts for itself, or persons speak.
bool HasOneSender(const std::string& channel, const std::string& sequence) {
  static const std::set<std::string> several = {"CORNER_SELECTION", "LEFT_OUT_VIEWS",
                                                "SESSION_REQUEST"};
  return channel == sequence && several.count(channel) == 0;
}

void AddLinks(const LinkReport& links, Status* status) {
  const auto add = [&](const std::string& name, std::int64_t value) {
    if (value != 0) status->counters.emplace_back(name, value);
  };
  add("datagrams lost", links.datagrams_lost);
  add("datagrams repaired", links.datagrams_repaired);
  add("messages given up", links.messages_given_up);
  add("ip fragments given up", links.ip_fragments_given_up);
  for (const ClockOffset& clock : links.clocks) {
    if (std::abs(clock.ahead) > kClockTolerance) {
      add(Printable(kClockCounter + clock.host, 100), clock.ahead / 1000);
    }
  }
}

void AddCounters(const std::string& what, const std::map<std::string, std::int64_t>& by_channel,
                 Status* status) {
  std::size_t named = 0;
  for (const auto& [channel, count] : by_channel) {
    if (count != 0 && named++ < kMaxChannelsNamed) {
      std::string name = what;
      name.append(" ").append(channel);
      status->counters.emplace_back(Printable(name, 100), count);
    }
  }
}

}  // namespace

NodeRunner::NodeRunner(Node* node, Bus* bus) : node_(node), bus_(bus) {
  node_->SetWarningHandler([this](const std::string& warning) { NameProblem(warning); });
  for (const std::string& channel : node_->Subscriptions()) {
    bus_->Subscribe(channel, [this](const std::string& name, const std::uint8_t* data,
                                    std::size_t size) { OnBytes(name, data, size); });
  }
}

void NodeRunner::OnBytes(const std::string& channel, const std::uint8_t* data, std::size_t size) {
  ++received_;
  Messages answers;
  Guard(channel, [&] {
    const Message message = Decode(channel, data, size);
    CountGap(channel, message);
    const auto* command = std::get_if<SessionCommand>(&message);
    if (command != nullptr && !commands_.IsNew(*command)) {
      if (const auto last_word = commands_.LastWord(command->command)) {
        answers.emplace_back(*last_word);
      }
      return;
    }
    try {
      answers = node_->Handle(message);
    } catch (...) {
      if (command != nullptr) commands_.Forget(*command);
      throw;
    }
    // Another process' health is not this one's time.
    if (!std::holds_alternative<Status>(message)) {
      newest_utime_ = std::max(newest_utime_, UtimeOf(message));
    }
  });
  Publish(std::move(answers));
}

void NodeRunner::CountGap(const std::string& channel, const Message& message) {
  const std::string key = SequenceOf(message);
  if (sequences_.size() >= kMaxKeys && sequences_.count(key) == 0) return;
  const SequenceCounter::Step step = sequences_[key].Add(SeqOf(message));
  if (step.gaps != 0) gaps_by_channel_[channel] += step.gaps;
  gaps_ += step.gaps;
  late_ += step.kind == SequenceCounter::Kind::kLate ? 1 : 0;
  duplicates_ += step.kind == SequenceCounter::Kind::kDuplicate ? 1 : 0;
  restarts_ += step.kind == SequenceCounter::Kind::kRestart ? 1 : 0;
  const bool fell_back = step.kind == SequenceCounter::Kind::kRestart ||
                         step.kind == SequenceCounter::Kind::kDuplicate;
  if (fell_back && HasOneSender(channel, key)) ++fallen_back_[channel];
}

void NodeRunner::Publish(Messages messages) {
  for (Message& message : messages) PublishOne(std::move(message));
}

// What cannot be encoded takes no number: nobody missed it. What the bus failed to send does.
void NodeRunner::PublishOne(Message message) {
  const std::string channel = ChannelOf(message);
  Guard("publishing " + channel, [&] {
    if (SeqOf(message) == kSaidAgain) {
      bus_->Publish(channel, Encode(message));
      return;
    }
    const std::string key = SequenceOf(message);
    SetSeq(next_seq_[key], &message);
    const Bytes bytes = Encode(message);
    ++next_seq_[key];
    bus_->Publish(channel, bytes);
    if (const auto* event = std::get_if<SessionEvent>(&message)) commands_.Remember(*event);
  });
}

void NodeRunner::Advance(Utime now) {
  Guard("advancing", [&] { Publish(node_->Advance(now)); });
  if (!status_.IsDue(now)) return;
  NameMalformed();
  if (links_.IsDue(now)) {
    NameLinks();
    NameSharedChannels();
  }
  NameUnsigned();
  Guard("status", [&] { PublishOne(GetStatus()); });
}

void NodeRunner::UseSpareTime(Utime now, bool messages_wait) {
  if (!spared_) spared_ = now;
  if (messages_wait && now - *spared_ < kLongestBusy) return;
  spared_ = now;
  Guard("spare time", [&] { Publish(node_->UseSpareTime(now)); });
}

Status NodeRunner::GetStatus() const {
  Status status = node_->GetStatus();
  status.process = node_->name();
  status.utime = newest_utime_;
  if (!last_problem_.empty()) status.last_problem = last_problem_;
  status.counters.emplace_back("received", received_);
  status.counters.emplace_back("dropped", dropped_);
  status.counters.emplace_back("gaps", gaps_);
  if (late_ != 0) status.counters.emplace_back("late", late_);
  if (duplicates_ != 0) status.counters.emplace_back("duplicates", duplicates_);
  if (restarts_ != 0) status.counters.emplace_back("restarts", restarts_);
  if (const std::int64_t count = bus_->malformed().count; count != 0) {
    status.counters.emplace_back("malformed", count);
  }
  AddLinks(bus_->links(), &status);
  if (const std::int64_t count = bus_->refused().count; count != 0) {
    status.counters.emplace_back("unsigned", count);
  }
  // What strangers say of their datagrams is counted, too: no more than a message may say.
  for (auto& [name, value] : status.counters) value = std::clamp(value, -kMaxInteger, kMaxInteger);
  AddCounters("dropped", dropped_by_channel_, &status);
  AddCounters("gaps", gaps_by_channel_, &status);
  return status;
}

void NodeRunner::Guard(const std::string& channel, const std::function<void()>& action) {
  try {
    action();
  } catch (const std::exception& e) {
    Drop(channel, e.what());
  } catch (...) {
    Drop(channel, "an exception of no known type");
  }
}

void NodeRunner::Drop(const std::string& channel, const std::string& what) {
  ++dropped_;
  if (dropped_by_channel_.size() < kMaxKeys || dropped_by_channel_.count(channel) != 0) {
    ++dropped_by_channel_[channel];
  }
  NameProblem(channel + ": " + what);
}

void NodeRunner::NameMalformed() {
  const Malformed malformed = bus_->malformed();
  if (malformed.count == malformed_named_) return;
  malformed_named_ = malformed.count;
  NameProblem("a malformed datagram from " + malformed.newest);
}

// Every ten seconds: what goes on is said again.
void NodeRunner::NameLinks() {
  const LinkReport links = bus_->links();
  if (links.datagrams_lost > lost_named_) {
    NameProblem("the network loses datagrams, most of host " + links.worst + "; " +
                std::to_string(links.datagrams_repaired) + " were repaired, " +
                std::to_string(links.messages_given_up) + " messages given up");
  }
  if (links.ip_fragments_given_up > ip_lost_named_) {
    NameProblem(
        "the network loses pieces of datagrams that are larger than its MTU, and with each "
        "a whole one: " +
        std::to_string(links.ip_fragments_given_up) +
        " (ReasmFails), of LCM programs that are not rgbdt's");
  }
  for (const std::string& problem : ClockProblems(links.clocks)) NameProblem(problem);
  lost_named_ = links.datagrams_lost;
  ip_lost_named_ = links.ip_fragments_given_up;
}

void NodeRunner::NameSharedChannels() {
  for (const auto& [channel, times] : fallen_back_) {
    if (times < kSharedFallBacks) continue;
    NameProblem(channel + ": its numbers fell back " + std::to_string(times) +
                " times in 10 s: two programs send on this channel; end one of them");
  }
  fallen_back_.clear();
}

void NodeRunner::NameUnsigned() {
  const Unsigned refused = bus_->refused();
  if (refused.count == unsigned_named_) return;
  unsigned_named_ = refused.count;
  NameProblem("ignored: " + refused.newest);
}

void NodeRunner::NameProblem(const std::string& problem) {
  last_problem_ = Printable(problem, kMaxProblemBytes);
  if (problem_handler_) problem_handler_(last_problem_);
}

}  // namespace rgbdt
