# Writes OUT, a header with the commit of the repository SOURCE; nothing of where it lies.
# Usage: cmake -DGIT=PROGRAM -DSOURCE=FOLDER -DOUT=FILE -P write_commit.cmake
cmake_minimum_required(VERSION 3.25)
set(commit "")
if(GIT AND EXISTS ${SOURCE}/.git)
  execute_process(COMMAND ${GIT} rev-parse --short=12 HEAD WORKING_DIRECTORY ${SOURCE}
                  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
if(NOT commit MATCHES "^[0-9a-f]+$")
  set(commit "")
endif()
file(CONFIGURE OUTPUT ${OUT} CONTENT "#define RGBDT_COMMIT \"@commit@\"\n" @ONLY)
