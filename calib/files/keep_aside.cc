#include "calib/files/keep_aside.h"

#include <string>
#include <system_error>

#include "calib/files/atomic_file.h"
#include "calib/model/errors.h"

namespace rgbdt {

std::filesystem::path KeepAside(const std::filesystem::path& file) {
  constexpr int kMost = 10'000;
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return {};
  for (int i = 1; i <= kMost; ++i) {
    const std::filesystem::path aside =
        file.parent_path() /
        (file.stem().string() + "." + std::to_string(i) + file.extension().string());
    if (std::filesystem::exists(aside, ignored)) continue;
    Rename(file, aside);
    return aside;
  }
  throw InputError("there are " + std::to_string(kMost) + " earlier ones of " + file.string() +
                   "; remove some, or name another folder");
}

}  // namespace rgbdt
