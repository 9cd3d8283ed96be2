#include "services/command_line/commit.h"

#include "commit_made.h"

namespace rgbdt {

const char* Commit() { return RGBDT_COMMIT; }

}  // namespace rgbdt
