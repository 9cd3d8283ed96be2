#include "calib/present/layout/frame.h"

#include <cmath>

namespace rgbdt {
namespace {

constexpr std::size_t kAlign = 8;

void PadTo8(char with, std::string* bytes) {
  while (bytes->size() % kAlign != 0) bytes->push_back(with);
}

}  // namespace

void FrameWriter::Describe(const std::string& name, const char* type, std::size_t elements) {
  arrays_.push_back({{"name", name}, {"type", type}, {"length", elements}});
}

void FrameWriter::AddBytes(const std::string& name, const std::string& bytes) {
  Describe(name, "u8", bytes.size());
  PadTo8('\0', &payload_);
  payload_ += bytes;
}

void FrameWriter::AddFloats(const std::string& name, const std::vector<float>& values) {
  Describe(name, "f32", values.size());
  PadTo8('\0', &payload_);
  payload_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
}

std::string FrameWriter::Finish() { return Together(0); }

std::string FrameWriter::FinishWith(const std::string& name, std::size_t bytes) {
  Describe(name, "u8", bytes);
  PadTo8('\0', &payload_);
  return Together(bytes);
}

std::string FrameWriter::Together(std::size_t space) {
  if (!arrays_.empty()) header_["arrays"] = arrays_;
  // Names and texts come from messages and files; what is no UTF-8 is replaced.
  std::string json = header_.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  PadTo8(' ', &json);
  const auto size = static_cast<std::uint32_t>(json.size());
  std::string frame;
  frame.reserve(8 + json.size() + payload_.size() + space);
  frame.append(4, '\0');
  for (int i = 0; i < 4; ++i) frame.push_back(static_cast<char>(size >> (8 * i)));
  return frame.append(json).append(payload_).append(space, '\0');
}

std::string JsonFrame(const nlohmann::json& header) { return FrameWriter(header).Finish(); }

nlohmann::json MatrixOf(const Rigid3& a_from_b) {
  const Eigen::Matrix3d rotation = a_from_b.rotation.toRotationMatrix();
  nlohmann::json matrix = nlohmann::json::array();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) matrix.push_back(rotation(row, column));
    matrix.push_back(a_from_b.translation[row]);
  }
  for (const double last : {0.0, 0.0, 0.0, 1.0}) matrix.push_back(last);
  return matrix;
}

nlohmann::json FiniteOrNull(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

}  // namespace rgbdt
