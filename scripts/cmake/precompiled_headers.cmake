# What most sources include, parsed once: the standard library, Eigen and OpenCV's core, and for
# tests GoogleTest. A source still includes what it uses: with the option off nothing else changes.
option(RGBDT_PRECOMPILED_HEADERS "Parse the most used system headers once" ON)

set(precompiled_headers
    <algorithm> <array> <chrono> <cmath> <cstdint> <cstdio> <deque> <filesystem> <functional>
    <limits> <map> <memory> <optional> <set> <sstream> <string> <thread> <vector>
    <Eigen/Dense> <opencv2/imgproc.hpp>)

# A target that holds nothing but the headers named after `packages`.
function(rgbdt_precompiled_target name packages)
  file(GENERATE OUTPUT ${CMAKE_BINARY_DIR}/${name}.cc CONTENT "")
  add_library(${name} OBJECT ${CMAKE_BINARY_DIR}/${name}.cc)
  target_link_libraries(${name} PRIVATE ${packages})
  target_precompile_headers(${name} PRIVATE ${precompiled_headers} ${ARGN})
endfunction()

# All libraries and programs of `folder` and those below it.
function(rgbdt_targets_below folder result)
  get_property(targets DIRECTORY ${folder} PROPERTY BUILDSYSTEM_TARGETS)
  get_property(subfolders DIRECTORY ${folder} PROPERTY SUBDIRECTORIES)
  foreach(subfolder ${subfolders})
    rgbdt_targets_below(${subfolder} below)
    list(APPEND targets ${below})
  endforeach()
  set(${result} ${targets} PARENT_SCOPE)
endfunction()

# Every target below `folder` uses the headers of `precompiled`: with GoogleTest where it is linked,
# and at -O1 where the target is. Who is to be compiled without has set DISABLE_PRECOMPILE_HEADERS.
function(rgbdt_use_precompiled_headers folder)
  rgbdt_targets_below(${folder} targets)
  foreach(target ${targets})
    get_target_property(type ${target} TYPE)
    if(type STREQUAL STATIC_LIBRARY OR type STREQUAL EXECUTABLE)
      get_target_property(libraries ${target} LINK_LIBRARIES)
      get_target_property(options ${target} COMPILE_OPTIONS)
      set(headers precompiled)
      if(GTest::gmock IN_LIST libraries)
        set(headers precompiled_tests)
      elseif(options MATCHES "-O1")
        set(headers precompiled_light)
      endif()
      set_target_properties(${target} PROPERTIES PRECOMPILE_HEADERS_REUSE_FROM ${headers})
    endif()
  endforeach()
endfunction()

if(RGBDT_PRECOMPILED_HEADERS)
  rgbdt_precompiled_target(precompiled "Eigen3::Eigen;opencv_imgproc")
  rgbdt_precompiled_target(precompiled_light "Eigen3::Eigen;opencv_imgproc")
  target_compile_options(precompiled_light PRIVATE ${light_optimization})
  set(folders calib services)
  if(RGBDT_VIEWER)
    list(APPEND folders viewer)
  endif()
  if(BUILD_TESTING)
    rgbdt_precompiled_target(precompiled_tests "Eigen3::Eigen;opencv_imgproc;GTest::gmock"
                             <fstream> <random> <gmock/gmock.h> <gtest/gtest.h>)
    target_compile_options(precompiled_tests PRIVATE ${light_optimization})
    list(APPEND folders tests)
  endif()
  foreach(folder ${folders})
    rgbdt_use_precompiled_headers(${folder})
  endforeach()
endif()
