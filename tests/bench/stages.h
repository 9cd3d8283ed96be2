#pragma once

#include <cstdint>

namespace rgbdt::bench {

/// Each registers its rows, with sizes up to `most` where they have any.
void RegisterAssemble(std::int64_t most);
void RegisterDetect(std::int64_t most);
void RegisterSolve(std::int64_t most);
void RegisterProject(std::int64_t most);
void RegisterFuse(std::int64_t most);

}  // namespace rgbdt::bench
