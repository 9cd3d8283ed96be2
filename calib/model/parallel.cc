#include "calib/model/parallel.h"

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace rgbdt {

void ForEach(int count, int threads, const std::function<void(int)>& work) {
  if (threads == 0) threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  std::atomic<int> next{0};
  const auto loop = [&] {
    for (int i = next++; i < count; i = next++) work(i);
  };
  std::vector<std::thread> helpers;
  for (int i = 1; i < std::min(threads, count); ++i) helpers.emplace_back(loop);
  loop();
  for (std::thread& helper : helpers) helper.join();
}

}  // namespace rgbdt
