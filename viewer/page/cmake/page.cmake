# Type check and build in WORK; without packages dist/index.html is empty: the page is missing.
file(LOCK ${WORK}/lock GUARD PROCESS TIMEOUT 900)
set(page ${WORK}/dist/index.html)
if(NOT EXISTS ${WORK}/packages.stamp)
  file(WRITE ${page} "")
  return()
endif()

file(REMOVE_RECURSE ${WORK}/src ${WORK}/test)  # files that are gone would be checked, too
file(COPY ${SOURCE}/src ${SOURCE}/test ${SOURCE}/index.html ${SOURCE}/tsconfig.json ${SOURCE}/vite.config.ts
     DESTINATION ${WORK})

function(run what)
  execute_process(COMMAND ${NODE} ${ARGN} WORKING_DIRECTORY ${WORK}
                  RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    file(REMOVE ${page})
    message(NOTICE "${output}")  # as it stands: FATAL_ERROR would wrap its lines
    message(FATAL_ERROR "${what} of the viewer's page failed: see the lines above")
  endif()
endfunction()
run("The type check" node_modules/typescript/bin/tsc --noEmit)
run("The build" node_modules/vite/bin/vite.js build --logLevel warn)
