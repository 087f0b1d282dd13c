# Puts the text of data files into a library, so that a lone binary works; the files in data/ stay the source.
#
# voxtone_embed_files(<target> <symbol> <file>...)
#   defines  std::span<const voxtone::EmbeddedFile> voxtone::embedded::<symbol>()  (declare it where it is used; see
#   base/embedded_file.h), made again whenever a file changes. A name is the file's name without folder and extension.
function(voxtone_embed_files target symbol)
  set(output ${CMAKE_CURRENT_BINARY_DIR}/embedded_${symbol}.cpp)
  list(JOIN ARGN "|" files)
  add_custom_command(OUTPUT ${output}
                     COMMAND ${CMAKE_COMMAND} -DSYMBOL=${symbol} "-DFILES=${files}" -DOUTPUT=${output}
                             -P ${PROJECT_SOURCE_DIR}/cmake/embed_script.cmake
                     DEPENDS ${ARGN} ${PROJECT_SOURCE_DIR}/cmake/embed_script.cmake
                     COMMENT "Embedding ${symbol}" VERBATIM)
  target_sources(${target} PRIVATE ${output})
endfunction()
