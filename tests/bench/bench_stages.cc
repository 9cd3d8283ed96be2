// Times of the library's stages, beside what a user would write instead. See measure.h for flags.
#include "tests/bench/measure.h"
#include "tests/bench/stages.h"

int main(int argc, char** argv) {
  return rgbdt::bench::Main(argc, argv, [](std::int64_t most) {
    rgbdt::bench::RegisterAssemble(most);
    rgbdt::bench::RegisterDetect(most);
    rgbdt::bench::RegisterSolve(most);
    rgbdt::bench::RegisterProject(most);
    rgbdt::bench::RegisterFuse(most);
  });
}
