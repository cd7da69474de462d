# cmake --install <build folder> [--prefix <folder>]: programs, example configs, documents, man pages and completion,
# and the library (export.cmake). Components: train (programs of datasets and networks), development, python, v3 and v4
# (programs for these instruction sets), and swingbank (everything else). The installation builds nothing. It first
# generates files with the programs (--help, schema), so that nothing is installed if that fails.
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME swingbank)
# The programs are in a separate folder, because bin must not have subfolders (instruction sets).
set(programs_folder ${CMAKE_INSTALL_LIBEXECDIR}/swingbank)
set(made ${PROJECT_BINARY_DIR}/from_help)

get_property(links_of_train GLOBAL PROPERTY SWINGBANK_COMMAND_LINKS_train)
foreach(link ${links_of_train})
  cmake_path(GET link FILENAME name)
  string(APPEND commands_of_train " ${name}")
endforeach()

# swingbank_install_programs(component): installs the programs of a component and their man pages
function(swingbank_install_programs component)
  get_property(programs GLOBAL PROPERTY SWINGBANK_PROGRAMS_${component})
  get_property(links GLOBAL PROPERTY SWINGBANK_COMMAND_LINKS_${component})
  install(CODE "if(NOT from_help)
  execute_process(COMMAND bash \"${PROJECT_SOURCE_DIR}/cmake/from_help.sh\" \"$<TARGET_FILE_DIR:swingbank>\"
    ${PROJECT_VERSION} \"${made}\"${commands_of_train} COMMAND_ERROR_IS_FATAL ANY)
  set(from_help TRUE)
endif()" COMPONENT ${component})
  install(TARGETS ${programs} RUNTIME DESTINATION ${programs_folder} COMPONENT ${component})
  install(PROGRAMS ${links} DESTINATION ${programs_folder} COMPONENT ${component})
  set(names ${programs})
  foreach(link ${links})
    cmake_path(GET link FILENAME name)
    list(APPEND names ${name})
    # Internal commands have no man page.
    install(FILES ${made}/man1/${name}.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT ${component} OPTIONAL)
  endforeach()
  # Installs the same programs for wider instruction sets, if jobs/setup.sh --any-processor has built them. The
  # dispatcher selects the programs for the processor. For the component swingbank, each wider instruction set is a
  # separate component, because its programs are as large as the rest of the package.
  foreach(level x86-64-v3 x86-64-v4)
    set(of ${component})
    if(component STREQUAL "swingbank")
      string(REPLACE x86-64- "" of ${level})
    endif()
    install(CODE "foreach(name ${names})
  if(EXISTS \"$<TARGET_FILE_DIR:swingbank>/${level}/\${name}\")
    file(INSTALL \"$<TARGET_FILE_DIR:swingbank>/${level}/\${name}\"
      DESTINATION \"\${CMAKE_INSTALL_PREFIX}/${programs_folder}/${level}\" USE_SOURCE_PERMISSIONS)
  endif()
endforeach()" COMPONENT ${of})
  endforeach()
endfunction()
swingbank_install_programs(swingbank)
swingbank_install_programs(train)
install(TARGETS swingbank RUNTIME DESTINATION ${programs_folder})
file(RELATIVE_PATH from_bin ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBEXECDIR}/swingbank/swingbank)
install(CODE "set(bin \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_BINDIR}\")
file(MAKE_DIRECTORY \${bin})
file(CREATE_LINK ${from_bin} \${bin}/swingbank SYMBOLIC)")
# The man page swingbank(1) lists only the commands of its own component, because a package contains one component.
install(CODE "set(page \"${made}/man1/swingbank.1\")
if(CMAKE_INSTALL_COMPONENT)
  set(page \"${made}/alone/swingbank.1\")
endif()
file(INSTALL \${page} DESTINATION \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_MANDIR}/man1\")")
install(FILES ${made}/swingbank.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME swingbank)
install(FILES ${made}/_swingbank DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions)
install(FILES ${made}/swingbank.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
install(DIRECTORY configs DESTINATION ${CMAKE_INSTALL_DATADIR}/swingbank)
install(DIRECTORY ${made}/schema DESTINATION ${CMAKE_INSTALL_DATADIR}/swingbank/configs)
# The environment module contains the prefix, which is known only at installation.
install(CODE "set(PROJECT_VERSION ${PROJECT_VERSION})
set(CMAKE_INSTALL_BINDIR ${CMAKE_INSTALL_BINDIR})
configure_file(\"${PROJECT_SOURCE_DIR}/packaging/modulefile\" \"${PROJECT_BINARY_DIR}/modulefile\" @ONLY)")
install(FILES ${PROJECT_BINARY_DIR}/modulefile DESTINATION ${CMAKE_INSTALL_DATADIR}/modulefiles/swingbank RENAME ${PROJECT_VERSION})

# Relative links of README.md to installed files remain; links to other files become plain text.
install(FILES README.md CHANGELOG.md CITATION.cff CONTRIBUTING.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY docs examples DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY python/notebooks DESTINATION ${CMAKE_INSTALL_DOCDIR}/python)
file(GLOB_RECURSE readmes CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR} base/README.md cmake/README.md
  configs/README.md jobs/README.md mpi/README.md packaging/README.md python/README.md research/README.md sim/README.md slurm/README.md tests/README.md train/README.md validate/README.md)
foreach(readme ${readmes})
  cmake_path(GET readme PARENT_PATH folder)
  install(FILES ${readme} DESTINATION ${CMAKE_INSTALL_DOCDIR}/${folder})
endforeach()
# Programs and reports contain the chart library, whose licence requires this notice.
install(FILES validate/report/uplot/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME uplot.copyright)
install(CODE "execute_process(COMMAND bash \"${PROJECT_SOURCE_DIR}/cmake/plain_links.sh\"
  \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DOCDIR}\"
  \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DATADIR}/swingbank\" COMMAND_ERROR_IS_FATAL ANY)")
swingbank_install_package()
