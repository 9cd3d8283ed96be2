#include "viewer/server/internal/message.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <vector>

namespace rgbdt::viewer {
namespace {

using nlohmann::json;

constexpr std::int64_t kMaxPoints = 10'000'000;
constexpr std::int64_t kMaxInteger = std::int64_t{1} << 53;  // a page's numbers are doubles
constexpr std::size_t kMaxCameras = 64;
constexpr std::size_t kMaxViews = 1000;

bool IsBool(const json& value) { return value.is_boolean(); }

bool IsInteger(const json& value, std::int64_t low, std::int64_t high) {
  if (!value.is_number_integer()) return false;
  if (value.is_number_unsigned() && value.get<std::uint64_t>() > std::uint64_t{1} << 62) {
    return false;
  }
  const auto number = value.get<std::int64_t>();
  return number >= low && number <= high;
}

bool IsPoints(const json& value) { return IsInteger(value, 1, kMaxPoints); }
bool IsUtime(const json& value) { return IsInteger(value, 0, kMaxInteger); }
bool IsId(const json& value) {
  return IsInteger(value, 1, std::numeric_limits<std::uint32_t>::max());
}

bool IsString(const json& value) {
  return value.is_string() && value.get_ref<const std::string&>().size() <= kMaxMessageString;
}

bool IsName(const json& value) {
  return IsString(value) && !value.get_ref<const std::string&>().empty();
}

bool IsNames(const json& value, std::size_t most) {
  return value.is_array() && value.size() <= most &&
         std::all_of(value.begin(), value.end(), IsName);
}

bool IsCameras(const json& value) { return IsNames(value, kMaxCameras); }
bool IsViews(const json& value) { return IsNames(value, kMaxViews); }

bool IsRequest(const json& value) {
  return value == "next_pose" || value == "pose_is_set" || value == "capture" || value == "finish";
}

bool IsPixel(const json& value) {
  const auto finite = [](const json& v) { return v.is_number() && std::isfinite(v.get<double>()); };
  return value.is_array() && value.size() == 2 && std::all_of(value.begin(), value.end(), finite);
}

bool IsCorners(const json& value) {
  return value.is_array() && value.size() == 4 && std::all_of(value.begin(), value.end(), IsPixel);
}

struct Field {
  const char* name;
  bool (*good)(const json& value);
};

// Beside "type".
const std::vector<Field>* FieldsOf(const std::string& type) {
  static const std::map<std::string, std::vector<Field>> kFields = {
      {"hello", {{"token", IsString}}},
      {"watch",
       {{"cloud", IsBool},
        {"cameras", IsCameras},
        {"overlay_cloud", IsBool},
        {"points", IsPoints}}},
      {"ack", {{"id", IsId}}},
      {"view", {{"view", IsString}}},
      {"leave_out", {{"views", IsViews}}},
      {"request", {{"request", IsRequest}, {"heldout", IsBool}}},
      {"pick", {{"camera", IsName}, {"image_utime", IsUtime}, {"corners", IsCorners}}}};
  const auto found = kFields.find(type);
  return found == kFields.end() ? nullptr : &found->second;
}

[[noreturn]] void Refuse(const std::string& why) { throw MalformedMessage(true, why); }

const std::string& TypeOf(const json& message) {
  if (!message.is_object()) Refuse("no JSON object");
  const auto type = message.find("type");
  if (type == message.end() || !type->is_string()) Refuse("no type");
  return type->get_ref<const std::string&>();
}

}  // namespace

json ParseJson(const std::string& text) {
  if (text.size() > kMaxMessageText) Refuse("message too large");
  try {
    return json::parse(text);
  } catch (const json::exception&) {  // its words would quote the message
    throw MalformedMessage(false, "no JSON");
  }
}

json ParseMessage(const std::string& text) {
  json message = ParseJson(text);
  const std::vector<Field>* fields = FieldsOf(TypeOf(message));
  if (fields == nullptr) Refuse("unknown type");
  for (const Field& field : *fields) {
    const auto value = message.find(field.name);
    if (value == message.end()) Refuse(std::string("no field ") + field.name);
    if (!field.good(*value)) Refuse(std::string("wrong value of ") + field.name);
  }
  if (message.size() != fields->size() + 1) Refuse("a field too many");
  return message;
}

}  // namespace rgbdt::viewer
