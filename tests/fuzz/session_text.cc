// A session's script, and a view's file beside images and a cloud that are good.
#include "calib/files/schema/rig_file.h"
#include "calib/files/schema/session_script.h"
#include "calib/files/session/session_dir.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/small_session.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rgbdt;
  static const fuzz::ScratchFile script("session.textproto");
  static const Session session = [] {
    fuzz::WriteSmallSession(script.folder());
    return OpenSession(script.folder());
  }();
  const std::string text = fuzz::Input(data, size).Rest();
  script.Write(text);
  fuzz::Try([&] { ReadSessionScript(script.path(), script.folder() / "rig.textproto"); });
  fuzz::Try([&] { ReadSessionScript(script.path()); });
  fuzz::WriteViewText(script.folder(), text);
  fuzz::Try([&] { ReadView(session, "0001"); });
  fuzz::Try([&] { ReadImages(session, "0001"); });
  fuzz::Try([&] { ReadCloud(session, "0001"); });
  return 0;
}
