# `cpack -G DEB` in the build folder: rayfarm (the program) and librayfarm-dev (the renderer as a library).
set(RAYFARM_MAINTAINER "Rayfarm maintainers <maintainers@rayfarm.example>" CACHE STRING "Who made the Debian packages")
set(release 1)

# What Debian asks of its packages, and no other installation has.
set(files ${PROJECT_BINARY_DIR}/package)
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)  # or SOURCE_DATE_EPOCH
configure_file(cmake/package/changelog.in ${files}/changelog.Debian @ONLY)
execute_process(COMMAND gzip -9nkf ${files}/changelog.Debian COMMAND_ERROR_IS_FATAL ANY)
foreach(package rayfarm librayfarm-dev)
  set(component debian_${package})
  install(FILES cmake/package/copyright ${files}/changelog.Debian.gz
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package} COMPONENT ${component} EXCLUDE_FROM_ALL)
endforeach()
if(TARGET manual)
  install(FILES ${manual}/zsh/_rayfarm DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions
          COMPONENT debian_rayfarm EXCLUDE_FROM_ALL)
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME rayfarm)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT ${RAYFARM_MAINTAINER})
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS ${CMAKE_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS})
set(CPACK_COMPONENTS_ALL program debian_rayfarm library debian_librayfarm-dev)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_COMPONENT_PROGRAM_GROUP program)
set(CPACK_COMPONENT_DEBIAN_RAYFARM_GROUP program)
set(CPACK_COMPONENT_LIBRARY_GROUP library)
set(CPACK_COMPONENT_DEBIAN_LIBRAYFARM-DEV_GROUP library)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each package has its own, as the first line of its description
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE ${release})
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME rayfarm)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS openmpi-bin)
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION "ray tracing render farm on Open MPI
Rayfarm renders stills and animations by ray tracing on many processors.
A host process sends the scene once, hands out parts of the picture, and
assembles what the nodes return. The picture is the same to the byte for
any number of processes, and when nodes are killed on the way.")

set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME librayfarm-dev)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS
    "rayfarm (= ${PROJECT_VERSION}-${release}), libfmt-dev, libglm-dev, libhwy-dev, libimath-dev, libmeshoptimizer-dev, libopenexr-dev, libpng-dev, libssl-dev, libyaml-cpp-dev")
set(CPACK_DEBIAN_LIBRARY_DESCRIPTION "ray tracer of Rayfarm as a library
The renderer of Rayfarm for other programs: it loads scenes, builds
hierarchies, traces pictures and writes them, in the process that calls
it. For CMake: find_package(rayfarm), and link rayfarm::renderer.")
include(CPack)
