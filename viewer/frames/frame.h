#pragma once

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace rgbdt::viewer {

/// Bytes for the page, laid out as viewer/page/src/protocol.ts says: id (0; the bridge puts a
/// connection's own in its place), header, arrays.
class FrameWriter {
 public:
  /// `header` has at least "type"; "arrays" is added by Finish().
  explicit FrameWriter(nlohmann::json header) : header_(std::move(header)) {}

  void AddBytes(const std::string& name, const std::string& bytes);           ///< "u8"
  void AddFloats(const std::string& name, const std::vector<float>& values);  ///< "f32"

  std::string Finish();

 private:
  void Add(const std::string& name, const char* type, std::size_t elements, const void* data,
           std::size_t bytes);

  nlohmann::json header_;
  nlohmann::json arrays_ = nlohmann::json::array();
  std::string payload_;
};

/// A frame without arrays.
std::string JsonFrame(const nlohmann::json& header);

/// JSON of a number: null where it is not finite.
nlohmann::json FiniteOrNull(double value);

}  // namespace rgbdt::viewer
