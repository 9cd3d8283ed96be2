#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>

namespace rgbdt::viewer {

/// Bytes that are made when they are first asked for, once for all who get them.
class LazyBytes {
 public:
  explicit LazyBytes(std::function<std::string()> make) : make_(std::move(make)) {}

  /// Null where they could not be made. Only on the server's thread.
  std::shared_ptr<const std::string> Get();

 private:
  std::function<std::string()> make_;
  std::shared_ptr<const std::string> bytes_;
};

}  // namespace rgbdt::viewer
