#pragma once

// Reads frames as viewer/page/src/protocol.ts lays them out, by none of its code.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace rgbdt {

struct ParsedFrame {
  std::uint32_t id = 0;
  nlohmann::json header;
  std::map<std::string, std::string> arrays;  ///< bytes, whole elements of what is there

  std::vector<float> Floats(const std::string& name) const {
    const std::string& bytes = arrays.at(name);
    std::vector<float> numbers(bytes.size() / sizeof(float));
    std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(float));
    return numbers;
  }

  cv::Mat Jpeg() const {
    const std::string& bytes = arrays.at("jpeg");
    return cv::imdecode(std::vector<unsigned char>(bytes.begin(), bytes.end()),
                        cv::IMREAD_UNCHANGED);
  }
};

inline std::uint32_t NumberAt(const std::string& bytes, std::size_t at) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    number |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes.at(at + i))) << (8 * i);
  }
  return number;
}

inline ParsedFrame Parse(const std::string& bytes) {
  ParsedFrame frame;
  frame.id = NumberAt(bytes, 0);
  const std::size_t begin = 8 + NumberAt(bytes, 4);
  if (begin % 8 != 0 || begin > bytes.size()) throw std::runtime_error("the header's size");
  frame.header = nlohmann::json::parse(bytes.substr(8, begin - 8));
  std::size_t at = begin;
  for (const auto& info : frame.header.value("arrays", nlohmann::json::array())) {
    at = (at + 7) / 8 * 8;
    const std::string type = info.at("type");
    const std::size_t element = type == "u8" ? 1 : type == "u16" ? 2 : 4;
    const std::size_t size = info.at("length").get<std::size_t>() * element;
    const std::string there = at < bytes.size() ? bytes.substr(at, size) : "";
    frame.arrays[info.at("name")] = there.substr(0, there.size() / element * element);
    at += size;
  }
  if (at < bytes.size()) throw std::runtime_error("bytes behind the last array");
  return frame;
}

}  // namespace rgbdt
