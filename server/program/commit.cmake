# Writes the commit of the sources in SOURCE, as a header, into OUTPUT; leaves it alone where it says so already.
set(commit "")
if(GIT AND EXISTS ${SOURCE}/.git)
  execute_process(COMMAND ${GIT} -C ${SOURCE} describe --always --exclude=* --abbrev=12 --dirty=+
                  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
set(text "constexpr const char* isthmus_commit = \"${commit}\";\n")
set(written "")
if(EXISTS ${OUTPUT})
  file(READ ${OUTPUT} written)
endif()
if(NOT text STREQUAL written)
  file(WRITE ${OUTPUT} "${text}")
endif()
