# Writes OUTPUT with the version and the commit of SOURCE; touches the file only when something changed.
execute_process(COMMAND git -C ${SOURCE} describe --always --dirty --exclude=* OUTPUT_VARIABLE commit
                OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT commit)
  set(commit "unknown")
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "#pragma once
#define STIRSPH_VERSION \"${VERSION}\"
#define STIRSPH_COMMIT \"${commit}\"
")
