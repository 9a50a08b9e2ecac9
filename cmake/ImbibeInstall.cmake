# cmake --install: libraries, headers, command, data, and find_package(Imbibe).
include(CMakePackageConfigHelpers)
install(TARGETS ${IMBIBE_MODULES} EXPORT ImbibeTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS imbibe_cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY src/imbibe DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.h")
install(DIRECTORY fibres liquids fabrics scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/imbibe)
if(EXISTS ${CMAKE_SOURCE_DIR}/viewer/dist/index.html)  # built by npm (the launcher does); `imbibe live` says when it is missing
  install(DIRECTORY viewer/dist DESTINATION ${CMAKE_INSTALL_DATADIR}/imbibe/viewer)
endif()
install(EXPORT ImbibeTargets NAMESPACE Imbibe:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/Imbibe)
configure_package_config_file(cmake/ImbibeConfig.cmake.in ${CMAKE_BINARY_DIR}/ImbibeConfig.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/Imbibe)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/ImbibeConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/ImbibeConfig.cmake ${CMAKE_BINARY_DIR}/ImbibeConfigVersion.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/Imbibe)
