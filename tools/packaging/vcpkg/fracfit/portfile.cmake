# SPDX-License-Identifier: BSD-3-Clause
# The C++ libraries for vcpkg, from this clone: `vcpkg install "fracfit[fitting]" --overlay-ports=tools/packaging/vcpkg`.
get_filename_component(SOURCE_PATH "${CURRENT_PORT_DIR}/../../../.." ABSOLUTE)

vcpkg_check_features(OUT_FEATURE_OPTIONS FEATURE_OPTIONS FEATURES fitting FRAC_BUILD_FITTING)
vcpkg_cmake_configure(
  SOURCE_PATH "${SOURCE_PATH}"
  OPTIONS ${FEATURE_OPTIONS} -DFRAC_BUILD_TOOLS=OFF -DFRAC_BUILD_TESTS=OFF -DFRAC_BUILD_BENCHMARKS=OFF -DFRACFIT_MAT_FILES=OFF
          -DFRACFIT_EXPORTS=OFF)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(PACKAGE_NAME fracfit CONFIG_PATH lib/cmake/fracfit)
vcpkg_fixup_pkgconfig()
file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug/include")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE")
