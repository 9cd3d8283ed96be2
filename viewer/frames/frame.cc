#include "viewer/frames/frame.h"

#include <cmath>

namespace rgbdt::viewer {
namespace {

constexpr std::size_t kAlign = 8;

void PadTo8(char with, std::string* bytes) {
  while (bytes->size() % kAlign != 0) bytes->push_back(with);
}

}  // namespace

void FrameWriter::Add(const std::string& name, const char* type, std::size_t elements,
                      const void* data, std::size_t bytes) {
  PadTo8('\0', &payload_);
  payload_.append(static_cast<const char*>(data), bytes);
  arrays_.push_back({{"name", name}, {"type", type}, {"length", elements}});
}

void FrameWriter::AddBytes(const std::string& name, const std::string& bytes) {
  Add(name, "u8", bytes.size(), bytes.data(), bytes.size());
}

void FrameWriter::AddFloats(const std::string& name, const std::vector<float>& values) {
  Add(name, "f32", values.size(), values.data(), values.size() * sizeof(float));
}

std::string FrameWriter::Finish() {
  if (!arrays_.empty()) header_["arrays"] = arrays_;
  // Names and texts come from messages and files; what is no UTF-8 is replaced.
  std::string json = header_.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  PadTo8(' ', &json);
  std::string frame(8, '\0');
  const auto size = static_cast<std::uint32_t>(json.size());
  for (int i = 0; i < 4; ++i)
    frame[4 + static_cast<std::size_t>(i)] = static_cast<char>(size >> (8 * i));
  return frame + json + payload_;
}

std::string JsonFrame(const nlohmann::json& header) { return FrameWriter(header).Finish(); }

nlohmann::json FiniteOrNull(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

}  // namespace rgbdt::viewer
