#pragma once

#include <chrono>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "services/runtime/device_thread.h"

namespace rgbdt {

/// What a device's thread has told so far.
struct Told {
  Messages messages;
  std::vector<std::string> problems;

  template <typename T>
  std::vector<T> All() const {
    std::vector<T> all;
    for (const Message& message : messages) {
      if (const T* one = std::get_if<T>(&message)) all.push_back(*one);
    }
    return all;
  }
  template <typename T>
  std::size_t Count() const {
    std::size_t count = 0;
    for (const Message& message : messages) count += std::holds_alternative<T>(message) ? 1 : 0;
    return count;
  }
  bool HasProblem(const std::string& part) const {
    for (const std::string& problem : problems) {
      if (problem.find(part) != std::string::npos) return true;
    }
    return false;
  }
};

/// Takes news from a thread or node until `enough` says so; false after `timeout_s`.
template <typename Source, typename Enough>
bool Collect(Source* source, Told* told, const Enough& enough, double timeout_s = 30) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout_s);
  while (std::chrono::steady_clock::now() < until) {
    DeviceNews news = source->TakeNews();
    for (Message& message : news.messages) told->messages.push_back(std::move(message));
    for (std::string& problem : news.problems) told->problems.push_back(std::move(problem));
    if (enough(*told)) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return false;
}

}  // namespace rgbdt
