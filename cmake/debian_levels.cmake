# Removes the components of instruction sets whose programs were not built. cpack reads this file before it packs.
foreach(level v3 v4)
  if(NOT EXISTS ${CPACK_SWINGBANK_PROGRAMS}/x86-64-${level})
    list(REMOVE_ITEM CPACK_COMPONENTS_ALL ${level})
  endif()
endforeach()
