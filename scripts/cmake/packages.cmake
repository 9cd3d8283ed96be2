# Debian packages: `cpack` in the build directory; scripts/package does all of it.
#   rgbdt             the programs; what they load is read from them (dpkg-shlibdeps)
#   librgbdt-dev      components calib, messages, bus
#   librgbdt-rig-dev  the other components: what needs PCL, Embree, Aravis or pcap
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "rgbdt authors <rgbdt@localhost>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(debian ${CMAKE_CURRENT_LIST_DIR}/debian)
set(copyright ${PROJECT_SOURCE_DIR}/LICENSE)

# PART NAME SUMMARY DESCRIPTION, and lists of packages
function(rgbdt_debian_package part name summary)
  cmake_parse_arguments(with "" "" "DESCRIPTION;DEPENDS" ${ARGN})
  string(TOUPPER ${part} PART)
  list(JOIN with_DEPENDS ", " depends)
  list(JOIN with_DESCRIPTION "\n" description)
  set(CPACK_COMPONENTS_ALL ${CPACK_COMPONENTS_ALL} ${part} PARENT_SCOPE)
  set(CPACK_DEBIAN_${PART}_PACKAGE_NAME ${name} PARENT_SCOPE)
  set(CPACK_DEBIAN_${PART}_PACKAGE_DEPENDS "${depends}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${PART}_DESCRIPTION "${summary}\n${description}" PARENT_SCOPE)
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE RENAME copyright
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name} COMPONENT ${part})
endfunction()

rgbdt_debian_package(programs rgbdt "LIDAR, colour and thermal cameras: calibration and fused cloud"
  DESCRIPTION "Finds where colour and thermal cameras sit relative to a LIDAR, says how sure that"
              "is, and streams the fused RGB-depth-thermal cloud on an LCM bus."
  DEPENDS iproute2)  # lcm-loopback.service
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_RECOMMENDS liblcm-bin)  # rgbdt replay reads what lcm-logger writes
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_CONTROL_EXTRA ${debian}/postinst ${debian}/prerm ${debian}/postrm)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_CONTROL_STRICT_PERMISSION ON)

foreach(part dev rig_dev)
  get_property(depends_${part} GLOBAL PROPERTY rgbdt_debian_of_${part})
  get_property(parts_${part} GLOBAL PROPERTY rgbdt_parts_of_${part})
endforeach()
if(rig_dev IN_LIST parts_dev)
  message(FATAL_ERROR "a component of librgbdt-dev needs one of librgbdt-rig-dev")
endif()
list(REMOVE_DUPLICATES depends_dev)
list(REMOVE_DUPLICATES depends_rig_dev)
rgbdt_debian_package(dev librgbdt-dev "rgbdt's library, messages and bus"
  DESCRIPTION "Static libraries, headers, LCM types and Protobuf schemas:"
              "find_package(rgbdt COMPONENTS calib messages bus)."
  DEPENDS ${depends_dev})
if(depends_rig_dev)
  rgbdt_debian_package(rig_dev librgbdt-rig-dev "rgbdt's nodes, drivers, methods, simulator"
    DESCRIPTION "Static libraries and headers:"
                "find_package(rgbdt COMPONENTS nodes drivers methods simulate)."
    DEPENDS "librgbdt-dev (= ${PROJECT_VERSION})" ${depends_rig_dev})
endif()
include(CPack)
