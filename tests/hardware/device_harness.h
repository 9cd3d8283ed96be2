#pragma once

#include <chrono>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "services/runtime/device_thread.h"

namespace rgbdt {

/// What a device's thread has published so far.
struct Collected {
  Messages messages;
  std::vector<std::string> warnings;

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
  bool HasWarning(const std::string& part) const {
    for (const std::string& warning : warnings) {
      if (warning.find(part) != std::string::npos) return true;
    }
    return false;
  }
};

inline DeviceOutput OutputOf(DeviceThread* thread) { return thread->Take(); }

/// What a node publishes and warns of.
inline DeviceOutput OutputOf(DeviceNode* node) {
  DeviceOutput output;
  node->SetWarningHandler([&](const std::string& text) { output.warnings.push_back(text); });
  output.messages = node->Advance(0);
  node->SetWarningHandler({});
  return output;
}

/// Takes the output of a thread or node until `enough` says so; false after `timeout_s`.
template <typename Source, typename Enough>
bool Collect(Source* source, Collected* collected, const Enough& enough, double timeout_s = 30) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout_s);
  while (std::chrono::steady_clock::now() < until) {
    DeviceOutput output = OutputOf(source);
    for (Message& message : output.messages) collected->messages.push_back(std::move(message));
    for (std::string& warning : output.warnings) collected->warnings.push_back(std::move(warning));
    if (enough(*collected)) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return false;
}

}  // namespace rgbdt
