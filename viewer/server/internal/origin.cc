#include "viewer/server/internal/origin.h"

#include <unistd.h>

#include <algorithm>
#include <optional>

#include "viewer/server/internal/net.h"

namespace rgbdt::viewer {
namespace {

constexpr int kHttpPort = 80, kHttpsPort = 443;
constexpr std::size_t kMaxHostBytes = 300;

struct HostPort {
  std::string name;
  int port = kHttpPort;
  bool operator==(const HostPort& other) const { return name == other.name && port == other.port; }
};

std::string LowerCase(std::string text) {
  for (char& c : text) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return text;
}

std::optional<int> Port(const std::string& digits) {
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  if (digits.empty() || digits.size() > 5 || !std::all_of(digits.begin(), digits.end(), digit)) {
    return std::nullopt;
  }
  return std::stoi(digits);
}

std::optional<HostPort> Split(const std::string& host, bool tls) {
  if (host.empty() || host.size() > kMaxHostBytes) return std::nullopt;
  const bool brackets = host[0] == '[';
  const std::size_t end = host.find(brackets ? ']' : ':');
  if (brackets && end == std::string::npos) return std::nullopt;
  HostPort split;
  split.port = tls ? kHttpsPort : kHttpPort;
  split.name = LowerCase(brackets ? host.substr(1, end - 1) : host.substr(0, end));
  const std::string rest = end == std::string::npos ? "" : host.substr(brackets ? end + 1 : end);
  if (rest.empty()) return split;
  const std::optional<int> port = rest[0] == ':' ? Port(rest.substr(1)) : std::nullopt;
  if (!port) return std::nullopt;
  split.port = *port;
  return split;
}

bool IsAddress(const std::string& name) {
  boost::system::error_code error;
  net::ip::make_address(name, error);
  return !error;
}

}  // namespace

std::vector<std::string> MachineNames() {
  char name[256] = "";
  if (gethostname(name, sizeof(name) - 1) != 0 || name[0] == '\0') return {};
  const std::string full = LowerCase(name);
  const std::string first = full.substr(0, full.find('.'));
  return {full, first, first + ".local"};
}

bool HostRule::Allows(const std::string& host) const {
  const std::optional<HostPort> split = Split(host, tls);
  if (!split || split->port != port) return false;
  if (any_address_literal && IsAddress(split->name)) return true;
  return std::find(names.begin(), names.end(), split->name) != names.end();
}

HostRule RuleFor(const std::string& bound_address, int port, bool tls) {
  boost::system::error_code error;
  const net::ip::address address = net::ip::make_address(bound_address, error);
  HostRule rule;
  rule.port = port;
  rule.tls = tls;
  rule.names = {"localhost", "127.0.0.1", "::1"};
  if (!error && address.is_loopback()) {
    rule.names.push_back(bound_address);
    return rule;
  }
  rule.any_address_literal = true;
  for (std::string& name : MachineNames()) rule.names.push_back(std::move(name));
  return rule;
}

bool OriginIsHost(const std::string& origin, const std::string& host, bool tls) {
  const std::string scheme = tls ? "https://" : "http://";
  if (LowerCase(origin.substr(0, scheme.size())) != scheme) return false;
  const std::optional<HostPort> from = Split(origin.substr(scheme.size()), tls);
  return from && from == Split(host, tls);
}

bool SameToken(const std::string& given, const std::string& token) {
  auto differ = static_cast<unsigned>(given.size() != token.size());
  for (std::size_t i = 0; i < token.size(); ++i) {
    const char digit = i < given.size() ? given[i] : '\0';
    differ |= static_cast<unsigned char>(digit) ^ static_cast<unsigned char>(token[i]);
  }
  return differ == 0;
}

}  // namespace rgbdt::viewer
