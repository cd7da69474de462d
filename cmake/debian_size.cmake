# Corrects the field Installed-Size of the packages, because CPack counts the program behind each symbolic link, and
# compresses the packages with xz, which lintian requires. cpack runs this script after it has built the packages.
cmake_minimum_required(VERSION 3.25)
foreach(package ${CPACK_PACKAGE_FILES})
  set(tree ${CPACK_TEMPORARY_DIRECTORY}/again)
  file(REMOVE_RECURSE ${tree})
  execute_process(COMMAND dpkg-deb -R ${package} ${tree} COMMAND_ERROR_IS_FATAL ANY)
  # The size as dpkg-gencontrol computes it: files in KiB, and 1 KiB for each folder and link.
  execute_process(COMMAND bash -c "find '${tree}' -path '${tree}/DEBIAN' -prune -o -type f -printf '%s\\n' -o -printf '1\\n' |
    awk '{sum += int(($1 + 1023) / 1024)} END {print sum}'" OUTPUT_VARIABLE size OUTPUT_STRIP_TRAILING_WHITESPACE
    COMMAND_ERROR_IS_FATAL ANY)
  file(READ ${tree}/DEBIAN/control control)
  string(REGEX REPLACE "Installed-Size: [0-9]+" "Installed-Size: ${size}" control "${control}")
  file(WRITE ${tree}/DEBIAN/control "${control}")
  execute_process(COMMAND dpkg-deb --root-owner-group -Zxz -z0 --build ${tree} ${package} OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
endforeach()
