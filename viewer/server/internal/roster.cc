#include "viewer/server/internal/roster.h"

#include <utility>

namespace rgbdt::viewer {

std::uint64_t Roster::Add(BrowserState state) {
  const std::lock_guard lock(mutex_);
  states_.emplace(++last_line_, std::move(state));
  return last_line_;
}

void Roster::Update(std::uint64_t line, std::size_t waiting, std::int64_t thinned, double share) {
  const std::lock_guard lock(mutex_);
  const auto found = states_.find(line);
  if (found == states_.end()) return;
  found->second.waiting = waiting;
  found->second.thinned = thinned;
  found->second.share = share;
}

void Roster::Remove(std::uint64_t line) {
  const std::lock_guard lock(mutex_);
  states_.erase(line);
}

std::vector<BrowserState> Roster::States() const {
  const std::lock_guard lock(mutex_);
  std::vector<BrowserState> states;
  for (const auto& [line, state] : states_) states.push_back(state);
  return states;
}

}  // namespace rgbdt::viewer
