# Run by voxtone_embed_files: cmake -DSYMBOL=s "-DFILES=a|b" -DOUTPUT=o.cpp -P embed_script.cmake
cmake_minimum_required(VERSION 3.25)
string(REPLACE "|" ";" files "${FILES}")
set(entries "")
set(count 0)
foreach(file IN LISTS files)
  get_filename_component(name ${file} NAME_WE)
  file(READ ${file} text)
  if(text MATCHES "\\)voxtone\"")
    message(FATAL_ERROR "${file} contains the mark that ends an embedded text")
  endif()
  string(APPEND entries "    {\"${name}\", R\"voxtone(${text})voxtone\"},\n")
  math(EXPR count "${count}+1")
endforeach()
file(WRITE ${OUTPUT} "// Made by cmake/embed_script.cmake from files in data/.
#include <array>
#include <span>

#include \"base/embedded_file.h\"

namespace voxtone::embedded {

namespace {
constexpr std::array<EmbeddedFile, ${count}> files{{
${entries}}};
}  // namespace

std::span<const EmbeddedFile> ${SYMBOL}();
std::span<const EmbeddedFile> ${SYMBOL}() { return files; }

}  // namespace voxtone::embedded
")
