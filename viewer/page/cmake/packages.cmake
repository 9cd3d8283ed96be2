# npm ci in WORK; ends well, but without packages.stamp, where no registry can be reached.
file(MAKE_DIRECTORY ${WORK})
file(LOCK ${WORK}/lock GUARD PROCESS TIMEOUT 900)  # two builds of one tree
file(REMOVE ${WORK}/packages.stamp)
file(COPY ${SOURCE}/package.json ${SOURCE}/package-lock.json ${SOURCE}/.npmrc DESTINATION ${WORK})

# No package needs its install script: esbuild's binary is a package of its own.
execute_process(
  COMMAND ${NPM} ci --ignore-scripts --no-progress --no-update-notifier --prefer-offline
          --fetch-retries=2 --fetch-retry-mintimeout=1000 --fetch-retry-maxtimeout=5000
  WORKING_DIRECTORY ${WORK}
  RESULT_VARIABLE result
  OUTPUT_VARIABLE output
  ERROR_VARIABLE output)
if(result EQUAL 0)
  file(TOUCH ${WORK}/packages.stamp)
elseif(output MATCHES "EUSAGE|EINTEGRITY|EJSONPARSE")
  message(NOTICE "${output}")
  message(FATAL_ERROR "npm ci refuses package-lock.json: see the lines above")
else()
  string(REGEX MATCHALL "npm (error|ERR!) code [A-Z0-9_]+" code "${output}")
  message(WARNING "without a package registry: the viewer's page is missing; the next build tries again (${code})")
endif()
