#include "services/runtime/node_runner.h"

#include <algorithm>

#include "services/messages/check.h"
#include "services/messages/codec.h"

namespace rgbdt {
namespace {

constexpr std::size_t kMaxProblemBytes = 1000;
// What strangers name themselves must not fill the memory or the status.
constexpr std::size_t kMaxKeys = 1000;
constexpr std::size_t kMaxChannelsNamed = 100;

// Whose numbers a message belongs to.
std::string SequenceOf(const Message& message) {
  std::string sender;
  if (const auto* status = std::get_if<Status>(&message)) sender = status->process;
  if (const auto* event = std::get_if<SessionEvent>(&message)) sender = event->source;
  if (const auto* pose = std::get_if<StampedPose>(&message)) sender = pose->source;
  return ChannelOf(message) + (sender.empty() ? "" : " " + sender);
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
  for (const std::string& channel : node_->Repeats()) repeats_.insert(channel);
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
    answers = node_->Handle(message);
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
}

void NodeRunner::Publish(Messages messages) {
  for (Message& message : messages) PublishOne(std::move(message));
}

// What cannot be encoded takes no number: nobody missed it. What the bus failed to send does.
void NodeRunner::PublishOne(Message message) {
  const std::string channel = ChannelOf(message);
  Guard("publishing " + channel, [&] {
    if (repeats_.count(channel) != 0) {
      bus_->Publish(channel, Encode(message));
      return;
    }
    const std::string key = SequenceOf(message);
    SetSeq(next_seq_[key], &message);
    const Bytes bytes = Encode(message);
    ++next_seq_[key];
    bus_->Publish(channel, bytes);
  });
}

void NodeRunner::Advance(Utime now) {
  Guard("advancing", [&] { Publish(node_->Advance(now)); });
  if (!status_.IsDue(now)) return;
  NameMalformed();
  Guard("status", [&] { PublishOne(GetStatus()); });
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

void NodeRunner::NameProblem(const std::string& problem) {
  last_problem_ = Printable(problem, kMaxProblemBytes);
  if (problem_handler_) problem_handler_(last_problem_);
}

}  // namespace rgbdt
