# Manual pages, written by the program itself from its table of options (cli/program/manual.h) whenever it is linked.
set(manual ${PROJECT_BINARY_DIR}/man1)
add_custom_command(TARGET voxtone POST_BUILD COMMAND voxtone manual ${manual}
                   COMMENT "Writing the manual pages" VERBATIM)
install(DIRECTORY ${manual}/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program FILES_MATCHING PATTERN "*.1")
foreach(component "program" "core;EXCLUDE_FROM_ALL")
  install(FILES ${PROJECT_SOURCE_DIR}/data/completion/voxtone.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME voxtone
          COMPONENT ${component})
endforeach()
install(FILES ${PROJECT_SOURCE_DIR}/data/completion/_voxtone DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions COMPONENT program)
install(FILES ${PROJECT_SOURCE_DIR}/data/completion/_voxtone DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions
        COMPONENT core EXCLUDE_FROM_ALL)
