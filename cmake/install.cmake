# What `cmake --install` puts where, below the prefix. The executable finds its module from where it stands itself.
include(CMakePackageConfigHelpers)
set(CMAKE_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(share ${CMAKE_INSTALL_DATADIR}/rayfarm)

# The program.
install(TARGETS rayfarm DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
install(TARGETS image_formats DESTINATION lib/rayfarm COMPONENT program)
install(FILES deploy/mpi-env DESTINATION ${share} COMPONENT program)
install(DIRECTORY scenes/ DESTINATION ${share}/scenes COMPONENT program FILES_MATCHING
        PATTERN "*.yaml" PATTERN "*.json" PATTERN "*.hdr" PATTERN "*.nrrd" PATTERN "*.glb" PATTERN "painting_*.png")
# YAML scenes name their schema as it stands beside them; editors are told of it one folder above.
file(CREATE_LINK scenes/rayfarm.schema.json ${PROJECT_BINARY_DIR}/rayfarm.schema.json SYMBOLIC)
install(FILES ${PROJECT_BINARY_DIR}/rayfarm.schema.json DESTINATION ${share} COMPONENT program)
install(FILES README.md DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/rayfarm COMPONENT program)
install(FILES scenes/README.md DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/rayfarm/scenes COMPONENT program)

# Manual pages and completions, by a program that knows the options: where what is built can't run there are none.
if(NOT CMAKE_CROSSCOMPILING OR CMAKE_CROSSCOMPILING_EMULATOR)
  set(manual ${PROJECT_BINARY_DIR}/manual)
  find_program(GZIP gzip REQUIRED)
  add_custom_command(
    OUTPUT ${manual}/made
    COMMAND ${CMAKE_COMMAND} -E rm -rf ${manual}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${manual}
    COMMAND rayfarm_manual ${manual}
    COMMAND ${GZIP} -9nr ${manual}/man1
    COMMAND ${CMAKE_COMMAND} -E touch ${manual}/made
    DEPENDS rayfarm_manual VERBATIM COMMENT "Writing manual pages and completions")
  add_custom_target(manual ALL DEPENDS ${manual}/made)
  install(DIRECTORY ${manual}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT program)
  install(FILES ${manual}/bash/rayfarm DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT program)
  install(FILES ${manual}/fish/rayfarm.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d
          COMPONENT program)
  # Where zsh looks below /usr/local; Debian's packages have a folder of their own (package.cmake).
  install(FILES ${manual}/zsh/_rayfarm DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions COMPONENT zsh)
endif()

# The renderer as a library: find_package(rayfarm), rayfarm::renderer.
install(TARGETS renderer EXPORT rayfarm DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library)
install(DIRECTORY common DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/rayfarm COMPONENT library
        FILES_MATCHING PATTERN "*.h" PATTERN "scene_arrays.inc" PATTERN "*-inl.h" EXCLUDE PATTERN rayfarm.h EXCLUDE
        PATTERN description/formats EXCLUDE)
install(FILES common/rayfarm.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/rayfarm COMPONENT library)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/rayfarm)
install(EXPORT rayfarm NAMESPACE rayfarm:: FILE rayfarmTargets.cmake DESTINATION ${package} COMPONENT library)
configure_package_config_file(cmake/rayfarmConfig.cmake.in rayfarmConfig.cmake INSTALL_DESTINATION ${package})
# The interface of 0.x may change with x.
write_basic_package_version_file(rayfarmConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/rayfarmConfig.cmake ${PROJECT_BINARY_DIR}/rayfarmConfigVersion.cmake
        DESTINATION ${package} COMPONENT library)

include(cmake/package.cmake)
