# cmake --install <build folder> [--prefix <folder>]: programs, example configs, documents, man pages and completion, and
# the library (export.cmake).
# Nothing is built. Files generated from --help come first, so that nothing is installed if that fails.
get_property(programs GLOBAL PROPERTY SWINGBANK_PROGRAMS)
set(made ${PROJECT_BINARY_DIR}/from_help)
install(CODE "execute_process(COMMAND bash \"${PROJECT_SOURCE_DIR}/cmake/from_help.sh\" \"$<TARGET_FILE_DIR:swingbank>\"
  ${PROJECT_VERSION} \"${made}\" COMMAND_ERROR_IS_FATAL ANY)")
install(DIRECTORY ${made}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR})
install(FILES ${made}/swingbank.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME swingbank)
install(FILES ${made}/_swingbank DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions)
install(FILES ${made}/swingbank.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
install(TARGETS swingbank ${programs} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
get_property(links GLOBAL PROPERTY SWINGBANK_COMMAND_LINKS)
install(PROGRAMS ${links} DESTINATION ${CMAKE_INSTALL_BINDIR})
# The same programs for wider instruction sets, if jobs/setup.sh --any-processor has built them: swingbank chooses the
# one for the processor.
install(CODE "foreach(level x86-64-v3 x86-64-v4)
  file(GLOB wide \"$<TARGET_FILE_DIR:swingbank>/\${level}/swingbank[-_]*\")
  if(wide)
    file(INSTALL \${wide} DESTINATION \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_BINDIR}/\${level}\" USE_SOURCE_PERMISSIONS)
  endif()
endforeach()")
install(DIRECTORY configs DESTINATION ${CMAKE_INSTALL_DATADIR}/swingbank)
# The environment module names the prefix, which is known only now.
install(CODE "set(PROJECT_VERSION ${PROJECT_VERSION})
set(CMAKE_INSTALL_BINDIR ${CMAKE_INSTALL_BINDIR})
configure_file(\"${PROJECT_SOURCE_DIR}/packaging/modulefile\" \"${PROJECT_BINARY_DIR}/modulefile\" @ONLY)")
install(FILES ${PROJECT_BINARY_DIR}/modulefile DESTINATION ${CMAKE_INSTALL_DATADIR}/modulefiles/swingbank RENAME ${PROJECT_VERSION})

# README.md's relative links lead to the same paths in the installation.
install(FILES README.md CHANGELOG.md CITATION.cff CONTRIBUTING.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY docs examples DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY python/notebooks DESTINATION ${CMAKE_INSTALL_DOCDIR}/python)
file(GLOB_RECURSE readmes CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR} base/README.md cmake/README.md
  configs/README.md jobs/README.md mpi/README.md packaging/README.md python/README.md research/README.md sim/README.md slurm/README.md tests/README.md train/README.md validate/README.md)
foreach(readme ${readmes})
  cmake_path(GET readme PARENT_PATH folder)
  install(FILES ${readme} DESTINATION ${CMAKE_INSTALL_DOCDIR}/${folder})
endforeach()
# The chart library is part of programs and reports; its licence requires this notice.
install(FILES validate/report/uplot/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME uplot.copyright)
swingbank_install_package()
