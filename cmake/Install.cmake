# What `cmake --install build` and the Debian package hold: the program, its man page, the Python modules with their two commands,
# the decks, and the pages. No headers and no libraries: the rooms are not an interface for other programs before version 1.0.
# Other programs run decks and read summary.json and results.h5.
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)  # installing needs the program, not the tests
include(GNUInstallDirs)
set(WHIRL_PYTHON_DIR lib/python3/dist-packages CACHE STRING "folder of the Python modules below the prefix")

install(TARGETS whirl RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
configure_file(${PROJECT_SOURCE_DIR}/docs/whirl.1 ${PROJECT_BINARY_DIR}/install/whirl.1 @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/install/whirl.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)

install(DIRECTORY ${PROJECT_SOURCE_DIR}/scripts/whirl ${PROJECT_SOURCE_DIR}/scripts/whirl_plot DESTINATION ${WHIRL_PYTHON_DIR}
        FILES_MATCHING PATTERN "*.py" PATTERN "*.js")
# The version that Python's importlib.metadata finds.
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/install/METADATA
     CONTENT "Metadata-Version: 2.1\nName: whirl\nVersion: @PROJECT_VERSION@\nSummary: @PROJECT_DESCRIPTION@\n" @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/install/METADATA DESTINATION ${WHIRL_PYTHON_DIR}/whirl-${PROJECT_VERSION}.dist-info)
foreach(WHIRL_COMMAND plot report scene)
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/install/whirl-${WHIRL_COMMAND} @ONLY CONTENT [[
#!/usr/bin/python3
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "@WHIRL_PYTHON_DIR@"))
from whirl_plot.commands import @WHIRL_COMMAND@  # noqa: E402

@WHIRL_COMMAND@()
]])
  install(PROGRAMS ${PROJECT_BINARY_DIR}/install/whirl-${WHIRL_COMMAND} DESTINATION ${CMAKE_INSTALL_BINDIR})
endforeach()

install(DIRECTORY ${PROJECT_SOURCE_DIR}/inputs DESTINATION ${CMAKE_INSTALL_DATADIR}/whirl)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/docs PATTERN whirl.1 EXCLUDE)
install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
# Links of the pages: those to decks lead to the installed decks and back; those to sources become plain text.
file(RELATIVE_PATH WHIRL_TO_DATA /${CMAKE_INSTALL_DOCDIR} /${CMAKE_INSTALL_DATADIR}/whirl)
file(RELATIVE_PATH WHIRL_TO_DOC /${CMAKE_INSTALL_DATADIR}/whirl /${CMAKE_INSTALL_DOCDIR})
file(CREATE_LINK ${WHIRL_TO_DATA}/inputs ${PROJECT_BINARY_DIR}/install/inputs SYMBOLIC)
file(CREATE_LINK ${WHIRL_TO_DOC}/docs ${PROJECT_BINARY_DIR}/install/docs SYMBOLIC)
install(FILES ${PROJECT_BINARY_DIR}/install/inputs DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES ${PROJECT_BINARY_DIR}/install/docs DESTINATION ${CMAKE_INSTALL_DATADIR}/whirl)
install(CODE "set(whirl_doc \"${CMAKE_INSTALL_DOCDIR}\")\nset(whirl_data \"${CMAKE_INSTALL_DATADIR}/whirl\")")
install(CODE [[
cmake_policy(SET CMP0009 NEW)
set(root "$ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}")
file(GLOB_RECURSE pages "${root}/${whirl_doc}/README.md" "${root}/${whirl_doc}/docs/*.md" "${root}/${whirl_data}/inputs/*.md")
foreach(page IN LISTS pages)
  file(READ "${page}" text)
  string(REGEX REPLACE "\\[([^][]+)\\]\\((\\.\\./)*(src|tests|scripts|include|cmake)/[^)]*\\)" "\\1" text "${text}")
  file(WRITE "${page}" "${text}")
endforeach()
]])

# The Debian package: `cpack --config build/CPackConfig.cmake`, or scripts/package.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME whirl)
set(CPACK_PACKAGE_CONTACT "the Whirl developers <whirl@example.org>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)   # the libraries that the program is linked with, by dpkg-shlibdeps
set(CPACK_DEBIAN_PACKAGE_DEPENDS "openmpi-bin, libopenblas0-pthread, python3, python3-numpy, python3-h5py, python3-matplotlib, python3-yaml, libjs-chart.js")
if(WHIRL_NATIVE)
  # A program that is tuned for one processor does not run on an older one.
  set(CPACK_DEBIAN_PACKAGE_RELEASE native)
else()
  set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
endif()
include(CPack)
