#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "calib/model/errors.h"
#include "viewer/server/internal/limits.h"

namespace rgbdt::viewer {

/// What a browser sent is no ToBridge message; a few words why.
class MalformedMessage : public InputError {
 public:
  MalformedMessage(bool is_json, const std::string& what) : InputError(what), is_json_(is_json) {}
  bool is_json() const { return is_json_; }

 private:
  bool is_json_;
};

/// A text of at most kMaxMessageText as JSON. Throws MalformedMessage.
nlohmann::json ParseJson(const std::string& text);

/// A message of ToBridge (protocol.ts): exactly its fields, each of its type and within its range.
/// Throws MalformedMessage.
nlohmann::json ParseMessage(const std::string& text);

}  // namespace rgbdt::viewer
