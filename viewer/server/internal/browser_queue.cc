#include "viewer/server/internal/browser_queue.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "viewer/server/internal/frame_layout.h"

namespace rgbdt::viewer {
namespace {

constexpr std::size_t kMostUnacked = 4;
constexpr std::size_t kEnoughUnackedBytes = 4 * 1024 * 1024;
// A browser draws all that came since its last frame at once, however many: lines of a scanner.
constexpr std::size_t kFewUnackedBytes = 1024 * 1024;
constexpr std::size_t kMostWaitingClouds = 8;
constexpr std::size_t kMostWaitingOthers = 256;
constexpr std::size_t kMostKept = 4096;

bool IsCloud(const Post& post) { return post.heavy && post.record_bytes > 0; }
bool IsPassing(const Post& post) { return !IsCloud(post) && !post.kept; }
bool IsKept(const Post& post) { return !IsCloud(post) && post.kept; }

}  // namespace

std::set<std::string> BrowserQueue::Watch(std::set<std::string> keys, std::int64_t points) {
  std::set<std::string> added;
  std::set_difference(keys.begin(), keys.end(), watched_.begin(), watched_.end(),
                      std::inserter(added, added.end()));
  watched_ = std::move(keys);
  thinning_.WantPoints(points);
  const auto unwatched = [this](const Post& post) { return !Watches(post.watch); };
  light_.EraseIf(unwatched);
  heavy_.EraseIf(unwatched);
  cut_.EraseIf(unwatched);
  return added;
}

void BrowserQueue::Offer(SharedPost post) {
  if (!Watches(post->post().watch)) return;
  cut_.Erase(post->post().topic);
  TopicQueue* queue = post->post().heavy ? &heavy_ : &light_;
  queue->Put(std::move(post));
  DropBeyond(queue);
}

void BrowserQueue::Replay(SharedPost post) {
  if (!Watches(post->post().watch)) return;
  (post->post().heavy ? heavy_ : light_).Put(std::move(post));
}

void BrowserQueue::DropBeyond(TopicQueue* queue) {
  const std::size_t clouds = queue->DropOldest(IsCloud, kMostWaitingClouds);
  if (clouds > 0) thinning_.Dropped();
  const std::size_t others =
      queue->DropOldest(IsPassing, kMostWaitingOthers) + queue->DropOldest(IsKept, kMostKept);
  thinned_ += static_cast<std::int64_t>(clouds + others);
}

bool BrowserQueue::MaySendHeavy() const {
  return unacked_bytes_ < (unacked_.size() < kMostUnacked ? kEnoughUnackedBytes : kFewUnackedBytes);
}

std::optional<BrowserQueue::Outgoing> BrowserQueue::Next() {
  while (!light_.empty()) {
    if (auto out = Outgo(light_.PopFront())) return out;
  }
  while (!heavy_.empty() && MaySendHeavy()) {
    if (auto out = Outgo(heavy_.PopFront())) return out;
  }
  return heavy_.empty() && unacked_.empty() && !cut_.empty() ? OutgoWhole() : std::nullopt;
}

// It was measured when it was sent in part: its ack says nothing of the time to the screen.
std::optional<BrowserQueue::Outgoing> BrowserQueue::OutgoWhole() {
  const SharedPost post = cut_.PopFront();
  Outgoing out;
  out.frame = post->Frame();
  out.id = ++last_id_;
  const std::size_t header = HeaderBytes(*out.frame);
  const std::size_t record = post->post().record_bytes;
  out.bytes = header + record * thinning_.Wanted((out.frame->size() - header) / record);
  unacked_[out.id] = {out.bytes, std::nullopt};
  unacked_bytes_ += out.bytes;
  return out;
}

std::optional<BrowserQueue::Outgoing> BrowserQueue::Outgo(const SharedPost& post) {
  Outgoing out;
  out.frame = post->Frame();
  if (!out.frame) return std::nullopt;
  out.id = ++last_id_;
  out.bytes = CutBytes(post, *out.frame);
  if (post->post().heavy) {
    unacked_[out.id] = {out.bytes, std::nullopt};
    if (post->post().timed) unacked_[out.id].sent_s = post->sent_s();
    unacked_bytes_ += out.bytes;
  }
  return out;
}

std::size_t BrowserQueue::CutBytes(const SharedPost& shared, const std::string& frame) {
  const Post& post = shared->post();
  if (!IsCloud(post)) return frame.size();
  const std::size_t header = HeaderBytes(frame);
  const std::size_t records = (frame.size() - header) / post.record_bytes;
  const std::size_t cut = thinning_.Cut(post.topic, records, heavy_.Count(IsCloud));
  if (cut == records) return frame.size();
  ++thinned_;
  if (post.kept && cut < thinning_.Wanted(records)) cut_.Put(shared);
  return header + cut * post.record_bytes;
}

std::optional<double> BrowserQueue::Acked(std::uint32_t id) {
  const auto found = unacked_.find(id);
  if (found == unacked_.end()) return std::nullopt;
  const Unacked acked = found->second;
  unacked_bytes_ -= acked.bytes;
  unacked_.erase(found);
  return acked.sent_s;
}

}  // namespace rgbdt::viewer
