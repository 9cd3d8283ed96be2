// The file of a rig's key (--key): 64 hexadecimal digits, and nothing else but a line's end.
#include <sys/stat.h>

#include <cctype>

#include "calib/model/text.h"
#include "services/bus/bus_key.h"
#include "tests/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rgbdt;
  static const fuzz::ScratchFile file("rig.key");
  const std::string text = fuzz::Input(data, size).Rest();
  file.Write(text);
  chmod(file.path().c_str(), 0600);  // what others may read is not looked at
  fuzz::Try([&] {
    std::string digits;
    for (const unsigned byte : ReadBusKey(file.path()).bytes) digits += Format("%02x", byte);
    std::string given = text.substr(0, digits.size());
    for (char& c : given) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    const std::string rest = text.substr(given.size());
    fuzz::Require(given == digits && (rest.empty() || rest == "\n"), "the key that the file holds");
  });
  return 0;
}
