#include "services/packets/bag_packets.h"

#include <algorithm>
#include <utility>

#include "calib/model/errors.h"

namespace rgbdt {

BagPackets::BagPackets(std::filesystem::path bag, BagPacketsOptions options)
    : path_(std::move(bag)), options_(std::move(options)) {
  Rewind();
}

void BagPackets::Rewind() {
  bag_ = OpenBag(path_);
  sweeps_ = options_.metadata.empty()
                ? nullptr
                : PacketsByMetadata(options_.metadata, options_.metadata_name);
  ready_.clear();
  given_ = packets_ = bad_ = others_ = 0;
  last_problem_.clear();
  ended_ = false;
}

void BagPackets::Decode(const PacketSweeps::Payload& payload, Utime arrival) {
  if (!sweeps_) sweeps_ = PacketsByThemselves(payload);
  if (!sweeps_ || !sweeps_->IsOurs(payload)) {
    ++others_;
    return;
  }
  ++packets_;
  try {
    std::vector<Cloud> done = sweeps_->Add(payload, arrival);
    ready_.insert(ready_.begin(), std::make_move_iterator(done.rbegin()),
                  std::make_move_iterator(done.rend()));
  } catch (const InputError& error) {
    ++bad_;
    last_problem_ = error.what();
  }
}

void BagPackets::Take(const BagMessage& message) {
  const BagTopic& topic = bag_->topics()[message.topic];
  if (topic.name != options_.topic) return;
  ros::Packets packets;
  try {
    packets = ros::DecodePackets(message, topic);
  } catch (const InputError& error) {
    ++bad_;
    last_problem_ = std::string("a message ") + error.what();
    return;
  }
  for (const ros::Packets::Packet& packet : packets.packets) {
    Decode({packet.data, packet.data + packet.size},
           packet.utime != 0 ? packet.utime : message.log_utime);
  }
}

bool BagPackets::Next(Cloud* sweep) {
  BagMessage message;
  while (ready_.empty() && !ended_) {
    if (bag_->Next(&message)) {
      Take(message);
      continue;
    }
    ended_ = true;
    std::optional<Cloud> last;
    if (sweeps_) last = sweeps_->Finish();
    if (last) ready_.push_back(std::move(*last));
  }
  if (ready_.empty()) return false;
  *sweep = std::move(ready_.back());
  ready_.pop_back();
  ++given_;
  return true;
}

std::vector<Stamped> BagPackets::Find(const std::function<void(double)>& progress) {
  Rewind();
  std::vector<Stamped> found;
  Cloud sweep;
  while (Next(&sweep)) {
    found.push_back({sweep.sweep_utime, {0, given_ - 1, -1}});
    if (progress) {
      progress(static_cast<double>(bag_->position()) /
               static_cast<double>(std::max<std::int64_t>(1, bag_->size())));
    }
  }
  if (found.empty()) {
    throw InputError(
        options_.topic + ": " +
        (packets_ == 0 ? "has no packets of " +
                             (sweeps_ ? "the " + sweeps_->name() + " of " + options_.metadata_name
                                      : std::string(kSelfTellingLidars))
                       : "holds no whole sweep" +
                             (sweeps_->Lost().empty() ? "" : "; lost: " + sweeps_->Lost()) +
                             (bad_ > 0 ? "; the last packet: " + last_problem_ : "")));
  }
  lines_ = {options_.topic + ": " + std::to_string(packets_) + " packets of a " + sweeps_->name() +
            ", " + std::to_string(found.size()) + " sweeps"};
  if (others_ > 0) lines_.push_back("left out: " + std::to_string(others_) + " other packets");
  if (!sweeps_->Lost().empty()) lines_.push_back("lost: " + sweeps_->Lost());
  if (bad_ > 0) {
    lines_.push_back("problem: " + std::to_string(bad_) +
                     " could not be read, the last: " + last_problem_);
  }
  Rewind();
  return found;
}

Cloud BagPackets::Read(const Stamped& stamped) {
  if (given_ > stamped.place.at) Rewind();
  Cloud sweep;
  while (given_ <= stamped.place.at) {
    if (!Next(&sweep)) throw InputError(path_.string() + ": has changed since it was first read");
  }
  return sweep;
}

}  // namespace rgbdt
