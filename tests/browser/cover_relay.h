#pragma once

#include <filesystem>
#include <string>

namespace rgbdt::browser {

/// Stands between the bus (LCM_DEFAULT_URL) and a simulator on a bus of its own: SESSION_COMMAND
/// goes there, everything else comes from there. From a view's sweep on, the images of `camera`
/// show a bar aslant across the board, so that the board is not found there and a person still sees
/// its corners. Where the board is says the simulator's truth file. Runs until it is killed; throws
/// InputError where a view is not in the truth file.
void CoverRelay(const std::string& simulator_url, const std::filesystem::path& truth,
                const std::string& camera);

}  // namespace rgbdt::browser
