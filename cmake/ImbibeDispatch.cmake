# The command once more for x86-64-v3, beside the one for every processor, which starts it where it can.
include(ExternalProject)
set(level x86-64-v3)
set(command imbibe-${level})
ExternalProject_Add(imbibe_cli_${level}
  SOURCE_DIR ${CMAKE_SOURCE_DIR}
  BINARY_DIR ${CMAKE_BINARY_DIR}/${level}
  CMAKE_ARGS -DCMAKE_BUILD_TYPE=${CMAKE_BUILD_TYPE} -DCMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER}
    -DCMAKE_CXX_COMPILER_LAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER} -DIMBIBE_TESTS=OFF -DIMBIBE_ARCH=${level}
  BUILD_COMMAND ${CMAKE_COMMAND} --build . --target imbibe_cli
  INSTALL_COMMAND ${CMAKE_COMMAND} -E copy_if_different imbibe ${CMAKE_BINARY_DIR}/${command}
  BUILD_ALWAYS ON DEPENDS imbibe_cli)
install(PROGRAMS ${CMAKE_BINARY_DIR}/${command} DESTINATION ${CMAKE_INSTALL_BINDIR})
