#pragma once

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "calib/model/rigid3.h"

namespace rgbdt {

/// Bytes for the page, laid out as viewer/page/src/protocol.ts says: id (0; the bridge puts a
/// connection's own in its place), header, arrays.
class FrameWriter {
 public:
  /// `header` has at least "type"; "arrays" is added by Finish().
  explicit FrameWriter(nlohmann::json header) : header_(std::move(header)) {}

  void AddBytes(const std::string& name, const std::string& bytes);           ///< "u8"
  void AddFloats(const std::string& name, const std::vector<float>& values);  ///< "f32"

  std::string Finish();

  /// With one array more, "u8" and the last: zeros, which the caller writes over. They are the
  /// frame's last bytes; a cloud is not copied so.
  std::string FinishWith(const std::string& name, std::size_t bytes);

 private:
  std::string Together(std::size_t space);
  void Describe(const std::string& name, const char* type, std::size_t elements);

  nlohmann::json header_;
  nlohmann::json arrays_ = nlohmann::json::array();
  std::string payload_;
};

/// A frame without arrays.
std::string JsonFrame(const nlohmann::json& header);

/// JSON of a pose as a 4x4 matrix, row by row.
nlohmann::json MatrixOf(const Rigid3& a_from_b);

/// JSON of a number: null where it is not finite.
nlohmann::json FiniteOrNull(double value);

}  // namespace rgbdt
