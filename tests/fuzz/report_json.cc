// report.json, and REPORT on the bus.
#include "calib/files/schema/report_file.h"
#include "tests/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rgbdt;
  const std::string json = fuzz::Input(data, size).Rest();
  fuzz::Try([&] {
    const std::string printed = ReportToJson(ReportFromJson(json));
    std::string again;
    try {
      again = ReportToJson(ReportFromJson(printed));
    } catch (const InputError& error) {
      fuzz::Require(false, std::string("a printed report that is read; ") + error.what());
    }
    fuzz::Require(printed == again, "the same report printed again");
  });
  return 0;
}
