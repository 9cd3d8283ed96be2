# The page's unit tests in WORK, as built there.
if(NOT EXISTS ${WORK}/packages.stamp)
  message("SKIPPED: the page's packages are missing")
  return()
endif()
execute_process(COMMAND ${NODE} node_modules/vitest/vitest.mjs run WORKING_DIRECTORY ${WORK} RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "vitest: ${result}")
endif()
