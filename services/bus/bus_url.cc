#include "services/bus/bus_url.h"

#include <arpa/inet.h>
#include <netinet/in.h>

#include <sstream>

namespace rgbdt {
namespace {

constexpr char kScheme[] = "udpm://";

// A whole number from `low` to `high`; else what is wrong goes to `error`.
std::int64_t Number(const std::string& text, const std::string& name, std::int64_t low,
                    std::int64_t high, std::string* error) {
  const bool digits = !text.empty() && text.size() <= 10 &&
                      text.find_first_not_of("0123456789") == std::string::npos;
  const std::int64_t number = digits ? std::stoll(text) : -1;
  if (digits && number >= low && number <= high) return number;
  *error = name + " is \"" + text + "\"; expected a number from " + std::to_string(low) + " to " +
           std::to_string(high);
  return 0;
}

void ReadPlace(const std::string& place, BusUrl* url) {
  const std::size_t colon = place.find(':');
  const std::string group = place.substr(0, colon);
  in_addr address{};
  const char* text = group.empty() ? "239.255.76.67" : group.c_str();
  if (inet_pton(AF_INET, text, &address) == 1) url->group = ntohl(address.s_addr);
  if (!IN_MULTICAST(url->group)) {
    url->error = "\"" + group + "\" is no multicast address; expected 239.x.x.x";
  } else if (colon != std::string::npos) {
    url->port =
        static_cast<int>(Number(place.substr(colon + 1), "the port", 1, 65535, &url->error));
  }
}

void ReadOption(const std::string& option, BusUrl* url) {
  const std::size_t equals = option.find('=');
  const std::string name = option.substr(0, equals);
  const std::string value = equals == std::string::npos ? "" : option.substr(equals + 1);
  if (name == "ttl") {
    url->ttl = static_cast<int>(Number(value, name, 0, 255, &url->error));
  } else if (name == "recv_buf_size") {
    url->buffer_bytes = Number(value, name, 0, 2147483647, &url->error);
  } else {
    url->error = "LCM knows no option \"" + name + "\"; expected ttl or recv_buf_size";
  }
}

}  // namespace

BusUrl ParseBusUrl(const std::string& text) {
  BusUrl url;
  url.text = text;
  const std::size_t begin = sizeof kScheme - 1;
  if (text.compare(0, begin, kScheme) != 0) {
    url.error = "it does not begin with udpm://, and a live system needs that";
    return url;
  }
  const std::size_t question = text.find('?', begin);
  ReadPlace(text.substr(begin, question - begin), &url);
  if (question == std::string::npos) return url;
  std::istringstream options(text.substr(question + 1));
  for (std::string option; url.error.empty() && std::getline(options, option, '&');) {
    ReadOption(option, &url);
  }
  return url;
}

}  // namespace rgbdt
