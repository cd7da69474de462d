# Strips binaries, compresses man pages, and writes copyright, changelog and overrides for lintian. cpack runs this
# script after it has installed all components into its folder, and before it packs them.
cmake_minimum_required(VERSION 3.25)
file(READ ${CPACK_SWINGBANK_SOURCE}/LICENSE licence)
file(READ ${CPACK_SWINGBANK_SOURCE}/validate/report/uplot/LICENSE uplot)
file(READ ${CPACK_SWINGBANK_SOURCE}/CHANGELOG.md changes)

# deb822(text out): sets out to the text as continuation lines of a field; an empty line becomes "."
function(deb822 text out)
  string(STRIP "${text}" text)
  string(REPLACE "\n" "\n " text " ${text}")
  string(REGEX REPLACE "\n +\n" "\n .\n" text "${text}")
  set(${out} "${text}" PARENT_SCOPE)
endfunction()

# copyright_line(text line terms): splits a licence into its copyright line ("2026, the Swingbank authors") and its
# terms
function(copyright_line text line terms)
  string(REGEX MATCH "Copyright \\(c\\) ([^\n]*)\n(.*)" found "${text}")
  set(${line} "${CMAKE_MATCH_1}" PARENT_SCOPE)
  deb822("${CMAKE_MATCH_2}" lines)
  set(${terms} "${lines}" PARENT_SCOPE)
endfunction()
copyright_line("${licence}" own own_terms)
copyright_line("${uplot}" other other_terms)
set(copyright "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: Swingbank

Files: *
Copyright: ${own}
License: BSD-3-Clause

Files: validate/report/uplot/*
Copyright: ${other}
License: Expat

License: BSD-3-Clause
${own_terms}

License: Expat
${other_terms}
")

# The changelog's heading of this version, with its date.
string(REGEX MATCH "\n## ${CPACK_PACKAGE_VERSION} — ([0-9-]+)\n" found "${changes}")
if(NOT found)
  message(FATAL_ERROR "no release ${CPACK_PACKAGE_VERSION} at CHANGELOG.md (the packages have that version): add its heading")
endif()
execute_process(COMMAND date -u -R -d ${CMAKE_MATCH_1} OUTPUT_VARIABLE date OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
set(changelog "swingbank (${CPACK_PACKAGE_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) bookworm; urgency=medium

  * Release ${CPACK_PACKAGE_VERSION}. CHANGELOG.md lists its changes.

 -- ${CPACK_DEBIAN_PACKAGE_MAINTAINER} <>  ${date}
")

set(overrides "# The project publishes no address of its developers.
malformed-contact Maintainer *
bogus-mail-host-in-debian-changelog *
# The package is not part of Debian.
initial-upload-closes-no-bugs *
# README.md refers to the file by this name.
wrong-name-for-upstream-changelog *CHANGELOG.md*
")

foreach(component ${CPACK_COMPONENTS_ALL})
  string(TOUPPER ${component} upper)
  set(tree ${CPACK_TEMPORARY_DIRECTORY}/${component}/usr)
  set(documents ${tree}/share/doc/${CPACK_DEBIAN_${upper}_PACKAGE_NAME})
  file(WRITE ${documents}/copyright "${copyright}")
  file(WRITE ${documents}/changelog.Debian "${changelog}")
  file(WRITE ${tree}/share/lintian/overrides/${CPACK_DEBIAN_${upper}_PACKAGE_NAME} "${overrides}")
  file(GLOB pages ${tree}/share/man/man1/*.1)
  execute_process(COMMAND gzip -9nf ${documents}/changelog.Debian ${pages} COMMAND_ERROR_IS_FATAL ANY)
  file(GLOB_RECURSE files LIST_DIRECTORIES OFF ${tree}/lib/* ${tree}/libexec/*)
  foreach(file ${files})
    if(IS_SYMLINK ${file})
      continue()
    endif()
    file(READ ${file} magic LIMIT 8 HEX)
    if(magic MATCHES "^7f454c46") # ELF
      # The search path (RPATH) of the build machine is not needed: Debian's libraries are in the default search path.
      file(RPATH_REMOVE FILE ${file})
      execute_process(COMMAND strip --strip-unneeded --remove-section=.comment --remove-section=.note ${file} COMMAND_ERROR_IS_FATAL ANY)
    elseif(magic STREQUAL 213c617263683e0a) # archive
      execute_process(COMMAND strip --strip-debug --enable-deterministic-archives ${file} COMMAND_ERROR_IS_FATAL ANY)
    endif()
  endforeach()
endforeach()
