# Debian packages: `cpack` in the build directory; scripts/package does all of it.
#   rgbdt         the programs; what they load is read from them (dpkg-shlibdeps)
#   librgbdt-dev  components calib, messages, bus, runtime, and what all components share
#   librgbdt-methods-dev, librgbdt-drivers-dev, librgbdt-simulate-dev    the other components
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "rgbdt authors <rgbdt@localhost>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(debian ${CMAKE_CURRENT_LIST_DIR}/debian)

# PART NAME, the description's lines, and the packages needed.
function(rgbdt_debian_package part name)
  cmake_parse_arguments(with "" "" "DESCRIPTION;DEPENDS" ${ARGN})
  string(TOUPPER ${part} PART)
  list(JOIN with_DEPENDS ", " depends)
  list(JOIN with_DESCRIPTION "\n" description)
  set(CPACK_COMPONENTS_ALL ${CPACK_COMPONENTS_ALL} ${part} PARENT_SCOPE)
  set(CPACK_DEBIAN_${PART}_PACKAGE_NAME ${name} PARENT_SCOPE)
  set(CPACK_DEBIAN_${PART}_PACKAGE_DEPENDS "${depends}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${PART}_DESCRIPTION "${description}" PARENT_SCOPE)
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE RENAME copyright
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name} COMPONENT ${part})
endfunction()

rgbdt_debian_package(programs rgbdt
  DESCRIPTION "Finds where colour and thermal cameras sit relative to a LIDAR, with the"
              "uncertainty, and streams the fused RGB-depth-thermal cloud on an LCM bus."
  DEPENDS iproute2)  # lcm-loopback.service
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SHLIBDEPS ON)
# rgbdt replay reads what lcm-logger writes; lcm-firewall.service keeps others out of that.
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_RECOMMENDS "liblcm-bin, nftables")
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_CONTROL_EXTRA ${debian}/postinst ${debian}/prerm ${debian}/postrm)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(description_of_dev "components calib, messages, bus and runtime; LCM types, Protobuf schemas.")
set(description_of_methods_dev "components methods, present and nodes.")
set(description_of_drivers_dev "component drivers.")
set(description_of_simulate_dev "component simulate.")
get_property(parts GLOBAL PROPERTY rgbdt_parts)
list(REMOVE_DUPLICATES parts)
foreach(part ${parts})
  get_property(depends GLOBAL PROPERTY rgbdt_debian_of_${part})
  get_property(needed_parts GLOBAL PROPERTY rgbdt_parts_of_${part})
  if(NOT part STREQUAL dev)
    list(APPEND needed_parts dev)
  endif()
  list(REMOVE_DUPLICATES depends)
  list(REMOVE_DUPLICATES needed_parts)
  list(REMOVE_ITEM needed_parts ${part})
  foreach(needed ${needed_parts})
    string(REPLACE _ - needed ${needed})
    list(APPEND depends "librgbdt-${needed} (= ${PROJECT_VERSION})")
  endforeach()
  string(REPLACE _ - name ${part})
  rgbdt_debian_package(${part} librgbdt-${name} DEPENDS ${depends}
    DESCRIPTION "Static libraries and headers, for find_package(rgbdt) and pkg-config:"
                ${description_of_${part}})
endforeach()
include(CPack)
