# What `cmake --install` puts where, and what find_package(rgbdt) and pkg-config find. Included last:
# what an option left out is not there to be installed. Headers keep their paths below
# <prefix>/include/rgbdt, which is what users include from: #include "calib/model/rig.h".
if(CMAKE_LIBRARY_ARCHITECTURE AND EXISTS /etc/debian_version)  # Debian's place, in /usr/local, too
  set(CMAKE_INSTALL_LIBDIR lib/${CMAKE_LIBRARY_ARCHITECTURE} CACHE PATH "libraries")
endif()
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
include(${CMAKE_CURRENT_LIST_DIR}/public_headers.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/dependencies.cmake)

set(rgbdt_headers ${CMAKE_INSTALL_INCLUDEDIR}/rgbdt)
set(rgbdt_share ${CMAKE_INSTALL_DATADIR}/rgbdt)
set(rgbdt_config ${CMAKE_INSTALL_LIBDIR}/cmake/rgbdt)
set(rgbdt_pkg_config ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
set(rgbdt_made ${PROJECT_BINARY_DIR}/install)

function(rgbdt_component_of target result)
  get_target_property(folder ${target} SOURCE_DIR)
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${folder})
  rgbdt_component_of_folder("${folder}" component)
  set(${result} "${component}" PARENT_SCOPE)
endfunction()

# The part of the installation, and with it the Debian package, that a component is in: what brings
# PCL, what brings Aravis and pcap and what brings Embree are apart.
function(rgbdt_part_of component result)
  if(component MATCHES "^(methods|present|nodes)$")
    set(part methods_dev)
  elseif(component MATCHES "^(drivers|simulate)$")
    set(part ${component}_dev)
  else()
    set(part dev)
  endif()
  set(${result} ${part} PARENT_SCOPE)
endfunction()

function(rgbdt_install_library library component part)
  get_target_property(source ${library} SOURCE_DIR)
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${source})
  rgbdt_public_headers(${source} headers)
  install(FILES ${headers} DESTINATION ${rgbdt_headers}/${folder} COMPONENT ${part})
  target_include_directories(${library} INTERFACE $<INSTALL_INTERFACE:${rgbdt_headers}>)
  install(TARGETS ${library} EXPORT rgbdt-${component} COMPONENT ${part})
endfunction()

# How those who link a component find it and what it needs: by CMake and by pkg-config.
function(rgbdt_install_finders component part libraries)
  set(order)
  rgbdt_link_order("${libraries}" order)
  set(needed)
  set(externals)
  set(libs)
  foreach(library ${order})
    rgbdt_component_of(${library} other)
    if(NOT other)
      message(FATAL_ERROR "${library}, which component ${component} needs, is not installed")
    elseif(NOT other STREQUAL component)
      list(APPEND needed ${other})
      continue()
    endif()
    rgbdt_linked_by(${library} ours others)
    list(APPEND externals ${others})
    get_target_property(type ${library} TYPE)
    if(type STREQUAL STATIC_LIBRARY)
      string(APPEND libs " -l${library}")
    endif()
  endforeach()
  list(REMOVE_DUPLICATES needed)

  rgbdt_external_fields("${externals}" CMAKE "\n" finders)
  configure_file(${CMAKE_CURRENT_FUNCTION_LIST_DIR}/rgbdt-component.cmake.in
                 ${rgbdt_made}/rgbdt-${component}.cmake @ONLY)
  install(FILES ${rgbdt_made}/rgbdt-${component}.cmake DESTINATION ${rgbdt_config}
          COMPONENT ${part})
  install(EXPORT rgbdt-${component} NAMESPACE rgbdt:: FILE rgbdt-${component}-targets.cmake
          DESTINATION ${rgbdt_config} COMPONENT ${part})

  file(RELATIVE_PATH to_prefix /prefix/${rgbdt_pkg_config} /prefix)
  rgbdt_external_fields("${externals}" CFLAGS " " cflags)
  rgbdt_external_fields("${externals}" LIBS " " other_libs)
  rgbdt_external_fields("${externals}" REQUIRES " " requires)
  list(TRANSFORM needed PREPEND rgbdt- OUTPUT_VARIABLE ours)
  list(JOIN ours " " ours)
  set(requires "${ours} ${requires}")
  set(libs "${libs} ${other_libs}")
  configure_file(${CMAKE_CURRENT_FUNCTION_LIST_DIR}/rgbdt.pc.in ${rgbdt_made}/rgbdt-${component}.pc
                 @ONLY)
  install(FILES ${rgbdt_made}/rgbdt-${component}.pc DESTINATION ${rgbdt_pkg_config}
          COMPONENT ${part})

  rgbdt_external_fields("${externals}" DEBIAN " " debian)
  string(REPLACE " " ";" debian "${debian}")
  set_property(GLOBAL APPEND PROPERTY rgbdt_parts ${part})
  set_property(GLOBAL APPEND PROPERTY rgbdt_debian_of_${part} ${debian})
  foreach(other ${needed})
    rgbdt_part_of(${other} other_part)
    set_property(GLOBAL APPEND PROPERTY rgbdt_parts_of_${part} ${other_part})
  endforeach()
endfunction()

# The programs, and the libraries by their components.
set(rgbdt_programs)
set(rgbdt_components)
rgbdt_targets_below(${PROJECT_SOURCE_DIR} targets)
foreach(target ${targets})
  get_target_property(type ${target} TYPE)
  if(type STREQUAL EXECUTABLE AND target MATCHES "^rgbdt(-|$)")
    list(APPEND rgbdt_programs ${target})
  elseif(type MATCHES "^(STATIC|INTERFACE)_LIBRARY$")
    rgbdt_component_of(${target} component)
    if(component)
      list(APPEND rgbdt_components ${component})
      list(APPEND rgbdt_libraries_${component} ${target})
    endif()
  endif()
endforeach()
list(REMOVE_DUPLICATES rgbdt_components)

install(TARGETS ${rgbdt_programs} COMPONENT programs)
foreach(component ${rgbdt_components})
  rgbdt_part_of(${component} part)
  foreach(library ${rgbdt_libraries_${component}})
    rgbdt_install_library(${library} ${component} ${part})
  endforeach()
  rgbdt_install_finders(${component} ${part} "${rgbdt_libraries_${component}}")
  set(all rgbdt_component_${component})
  add_library(${all} INTERFACE)
  target_link_libraries(${all} INTERFACE ${rgbdt_libraries_${component}})
  set_target_properties(${all} PROPERTIES EXPORT_NAME ${component})
  install(TARGETS ${all} EXPORT rgbdt-${component} COMPONENT ${part})
endforeach()
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/rgbdt-config.cmake.in
  ${rgbdt_made}/rgbdt-config.cmake INSTALL_DESTINATION ${rgbdt_config})
write_basic_package_version_file(${rgbdt_made}/rgbdt-config-version.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${rgbdt_made}/rgbdt-config.cmake ${rgbdt_made}/rgbdt-config-version.cmake
        DESTINATION ${rgbdt_config} COMPONENT dev)

# The wire and the files: schemas for every language, and what was made of them for C++.
file(GLOB lcm_types CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/lcmtypes/*.lcm)
if(TARGET rgbdt_lcmtypes_jar)
  install(FILES ${PROJECT_BINARY_DIR}/java/rgbdt.jar DESTINATION ${CMAKE_INSTALL_DATADIR}/java
          COMPONENT dev)
endif()
install(FILES ${lcm_types} ${PROJECT_SOURCE_DIR}/lcmtypes/README.md
        DESTINATION ${rgbdt_share}/lcmtypes COMPONENT dev)
install(DIRECTORY ${PROJECT_BINARY_DIR}/lcmtypes/include/ DESTINATION ${rgbdt_headers}
        COMPONENT dev FILES_MATCHING PATTERN *.hpp)
install(DIRECTORY ${PROJECT_BINARY_DIR}/calib/files/schema/generated/ DESTINATION ${rgbdt_headers}
        COMPONENT dev FILES_MATCHING PATTERN *.pb.h)
file(GLOB_RECURSE schemas CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR} calib/*.proto)
foreach(schema ${schemas})
  get_filename_component(folder ${schema} DIRECTORY)
  install(FILES ${schema} DESTINATION ${rgbdt_share}/proto/${folder} COMPONENT dev)
endforeach()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/scripts/examples DESTINATION ${rgbdt_share} COMPONENT dev)

# What a person who runs it needs.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/scripts/rigs ${PROJECT_SOURCE_DIR}/scripts/sessions
        DESTINATION ${rgbdt_share} COMPONENT programs)
set(systemd ${PROJECT_SOURCE_DIR}/scripts/systemd)
file(GLOB units CONFIGURE_DEPENDS ${systemd}/*.service ${systemd}/*.target)
install(FILES ${units} DESTINATION lib/systemd/system COMPONENT programs)
install(DIRECTORY ${systemd}/rgbdt-.service.d DESTINATION lib/systemd/system COMPONENT programs)
install(FILES ${systemd}/60-rgbdt.conf DESTINATION lib/sysctl.d COMPONENT programs)

set(completions ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
set(manual ${rgbdt_made}/man1)
set(program_files)
foreach(program ${rgbdt_programs})
  list(APPEND program_files $<TARGET_FILE:${program}>)
  install(FILES ${PROJECT_SOURCE_DIR}/scripts/bash_completion RENAME ${program}
          DESTINATION ${completions} COMPONENT programs)
endforeach()
find_package(Python3 REQUIRED COMPONENTS Interpreter)
add_custom_command(
  OUTPUT ${rgbdt_made}/man_pages.stamp
  COMMAND Python3::Interpreter ${CMAKE_CURRENT_LIST_DIR}/man_pages.py ${manual} ${PROJECT_VERSION}
          ${program_files}
  COMMAND ${CMAKE_COMMAND} -E touch ${rgbdt_made}/man_pages.stamp
  DEPENDS ${rgbdt_programs} ${CMAKE_CURRENT_LIST_DIR}/man_pages.py
  COMMENT "Manual pages from --help"
  VERBATIM)
add_custom_target(man_pages ALL DEPENDS ${rgbdt_made}/man_pages.stamp)
install(DIRECTORY ${manual} DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT programs)

# Builds all that is installed, and no more.
add_custom_target(installed DEPENDS man_pages)
foreach(component ${rgbdt_components})
  add_dependencies(installed ${rgbdt_libraries_${component}})
endforeach()
if(TARGET rgbdt_python_package)
  add_dependencies(installed rgbdt_python_package)
endif()

include(${CMAKE_CURRENT_LIST_DIR}/packages.cmake)
