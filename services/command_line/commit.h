#pragma once

namespace rgbdt {

/// The commit that was checked out when this was built, twelve digits; empty: not known.
const char* Commit();

}  // namespace rgbdt
