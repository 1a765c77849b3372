# SPDX-License-Identifier: BSD-3-Clause
# Two components, each with its own export set: `core`, which needs the C++ runtime and threads only, and `fitting`, which needs
# Ceres and NLopt besides, so that a controller configures on a machine without them.  `fitting` needs `core` installed too.
# Component `c`, libfracfit and fracfit.h, needs neither.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/fracfit)

install(TARGETS fracfit_frac fracfit_backlash EXPORT fracfit-core COMPONENT core ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY libfrac/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT core
        PATTERN "identification" EXCLUDE)
install(DIRECTORY libbacklash/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT core
        PATTERN "identification" EXCLUDE)
install(EXPORT fracfit-core NAMESPACE fracfit:: DESTINATION ${package_dir} COMPONENT core)
if(FRAC_BUILD_FITTING)
  install(TARGETS fracfit_identification fracfit_backlash_identification EXPORT fracfit-fitting COMPONENT fitting
          ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(DIRECTORY libfrac/include/frac/identification DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/frac COMPONENT fitting)
  install(DIRECTORY libbacklash/include/backlash/identification DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/backlash COMPONENT fitting)
  install(EXPORT fracfit-fitting NAMESPACE fracfit:: DESTINATION ${package_dir} COMPONENT fitting)
endif()
# For those who build without CMake.  Static libraries need to be told what they are linked with.
set(FRACFIT_PC_LIBRARIES "")
if(NOT BUILD_SHARED_LIBS)
  set(FRACFIT_PC_LIBRARIES "-lceres -lglog -lnlopt")
endif()
# fracfit_install_pkg_config(<name> <component>): the prefix in the file is that of the installation, which
# `cmake --install --prefix` decides.
function(fracfit_install_pkg_config name component)
  configure_file(${CMAKE_CURRENT_FUNCTION_LIST_DIR}/${name}.pc.in ${PROJECT_BINARY_DIR}/${name}.pc @ONLY)
  install(CODE "
    file(READ \"${PROJECT_BINARY_DIR}/${name}.pc\" text)
    get_filename_component(prefix \"\${CMAKE_INSTALL_PREFIX}\" ABSOLUTE)
    string(REGEX REPLACE \"^prefix=[^\\n]*\" \"prefix=\${prefix}\" text \"\${text}\")
    file(WRITE \"${PROJECT_BINARY_DIR}/installed/${name}.pc\" \"\${text}\")" COMPONENT ${component})
  install(FILES ${PROJECT_BINARY_DIR}/installed/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT ${component})
endfunction()
fracfit_install_pkg_config(fracfit-core core)
if(FRAC_BUILD_FITTING)
  fracfit_install_pkg_config(fracfit fitting)
endif()
if(FRACFIT_C)
  fracfit_install_pkg_config(fracfit-c c)
endif()
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/fracfitConfig.cmake.in ${PROJECT_BINARY_DIR}/fracfitConfig.cmake
                              INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/fracfitConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/fracfitConfig.cmake ${PROJECT_BINARY_DIR}/fracfitConfigVersion.cmake
        DESTINATION ${package_dir} COMPONENT core)
