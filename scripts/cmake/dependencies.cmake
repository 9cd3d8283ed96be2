# What the installed libraries need of others: read from what they link, so that nobody has to keep
# a list of who needs what. Only how each of the others is found stands here, once:
#   rgbdt_external(PATTERN  of what is linked
#                  CMAKE    the command that finds it, in rgbdt-config.cmake
#                  DEBIAN   its package
#                  REQUIRES its .pc files, or else
#                  LIBS     the linker's flags, and
#                  CFLAGS   the compiler's)
set(rgbdt_externals)
macro(rgbdt_external pattern)
  cmake_parse_arguments(entry "" "CMAKE;DEBIAN;REQUIRES;LIBS;CFLAGS" "" ${ARGN})
  list(LENGTH rgbdt_externals rgbdt_external)
  list(APPEND rgbdt_externals "^(${pattern})$")
  foreach(field CMAKE DEBIAN REQUIRES LIBS CFLAGS)
    set(rgbdt_external_${rgbdt_external}_${field} "${entry_${field}}")
  endforeach()
endmacro()

rgbdt_external(Threads::Threads CMAKE "find_dependency(Threads)" LIBS "-pthread")
rgbdt_external(Eigen3::Eigen CMAKE "find_dependency(Eigen3)" DEBIAN libeigen3-dev REQUIRES eigen3)
rgbdt_external("opencv_[a-z0-9]+" DEBIAN libopencv-dev
  CMAKE "find_dependency(OpenCV COMPONENTS core imgproc imgcodecs calib3d video aruco)"
  LIBS "-l@" CFLAGS "-I${OpenCV_INCLUDE_DIRS}")
rgbdt_external(Ceres::ceres CMAKE "find_dependency(Ceres)" DEBIAN libceres-dev
  REQUIRES "eigen3 libglog" LIBS "-lceres")
rgbdt_external(protobuf::libprotobuf CMAKE "find_dependency(Protobuf)" DEBIAN libprotobuf-dev
  REQUIRES protobuf)
rgbdt_external(lzf DEBIAN liblzf-dev REQUIRES liblzf)
rgbdt_external(yaml DEBIAN libyaml-dev REQUIRES yaml-0.1)
rgbdt_external(embree CMAKE "find_dependency(embree 3)" DEBIAN libembree-dev LIBS "-lembree3")
rgbdt_external(fmt::fmt CMAKE "find_dependency(fmt)" DEBIAN libfmt-dev REQUIRES fmt)
rgbdt_external(spdlog::spdlog CMAKE "find_dependency(spdlog)" DEBIAN libspdlog-dev REQUIRES spdlog)
rgbdt_external(nlohmann_json::nlohmann_json CMAKE "find_dependency(nlohmann_json)"
  DEBIAN nlohmann-json3-dev REQUIRES nlohmann_json)
rgbdt_external(PkgConfig::LCM CMAKE "find_by_pkg_config(LCM lcm)"
  DEBIAN "liblcm-dev libglib2.0-dev" REQUIRES lcm)
rgbdt_external(PkgConfig::SODIUM CMAKE "find_by_pkg_config(SODIUM libsodium)" DEBIAN libsodium-dev
  REQUIRES libsodium)
rgbdt_external(PkgConfig::PCAP CMAKE "find_by_pkg_config(PCAP libpcap)" DEBIAN libpcap-dev
  REQUIRES libpcap)
rgbdt_external(PkgConfig::ARAVIS CMAKE "find_by_pkg_config(ARAVIS aravis-0.8)"
  DEBIAN libaravis-dev REQUIRES aravis-0.8)
set(pcl "pcl_common pcl_kdtree pcl_search pcl_features pcl_surface")
rgbdt_external(PkgConfig::PCL CMAKE "find_by_pkg_config(PCL ${pcl})" DEBIAN libpcl-dev
  REQUIRES "${pcl}")

# The fields of all in `externals`, without what is there twice.
function(rgbdt_external_fields externals field separator result)
  set(values)
  foreach(external ${externals})
    set(found FALSE)
    set(index 0)
    foreach(pattern IN LISTS rgbdt_externals)
      if(external MATCHES "${pattern}")
        set(found TRUE)
        string(REPLACE "@" "${external}" value "${rgbdt_external_${index}_${field}}")
        if(NOT value STREQUAL "")
          list(APPEND values "${value}")
        endif()
        break()
      endif()
      math(EXPR index "${index} + 1")
    endforeach()
    if(NOT found)
      message(FATAL_ERROR "An installed library links '${external}': scripts/cmake/dependencies.cmake "
                          "does not say how who links it finds that.")
    endif()
  endforeach()
  list(REMOVE_DUPLICATES values)
  list(JOIN values "${separator}" values)
  set(${result} "${values}" PARENT_SCOPE)
endfunction()

# What a library links, of ours and of others; $<LINK_ONLY:...> is a library's private affair, but a
# static one's users link that, too.
function(rgbdt_linked_by library ours others)
  get_target_property(linked ${library} INTERFACE_LINK_LIBRARIES)
  if(NOT linked)
    set(linked)
  endif()
  list(TRANSFORM linked REPLACE "^\\$<LINK_ONLY:(.*)>$" "\\1")
  set(mine ${linked})
  list(FILTER mine INCLUDE REGEX "^rgbdt_")
  list(FILTER linked EXCLUDE REGEX "^rgbdt_")
  set(${ours} ${mine} PARENT_SCOPE)
  set(${others} ${linked} PARENT_SCOPE)
endfunction()

# `libraries` and all of ours that they need, each before those that it needs itself.
function(rgbdt_link_order libraries result)
  set(order ${${result}})
  foreach(library ${libraries})
    if(NOT library IN_LIST order)
      rgbdt_linked_by(${library} ours others)
      rgbdt_link_order("${ours}" order)
      list(PREPEND order ${library})
    endif()
  endforeach()
  set(${result} ${order} PARENT_SCOPE)
endfunction()
