#pragma once

#include <filesystem>
#include <string>

namespace rgbdt {

/// The folder `folder` / `name` of a session, there or not, to be written to. Throws InputError
/// where it is a symbolic link: by it a stranger who made the session would say what is overwritten
/// elsewhere.
std::filesystem::path OwnFolder(const std::filesystem::path& folder, const std::string& name);

}  // namespace rgbdt
