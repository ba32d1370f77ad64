# SPDX-License-Identifier: Apache-2.0
# cmake -DDIST=folder -DPLACEHOLDER=file -DOUTPUT=file.cpp -P embed_pages.cmake
# Writes the C++ source that embeds each file below DIST, or PLACEHOLDER as /index.html if DIST has
# no index.html. The source names each file's hash, so it changes exactly when a file does; it is
# left alone otherwise, so that nothing is compiled again.

set(root ${DIST})
set(placeholder FALSE)
if(EXISTS ${DIST}/index.html)
  file(GLOB_RECURSE names LIST_DIRECTORIES false RELATIVE ${DIST} ${DIST}/*)
else()
  set(placeholder TRUE)
  get_filename_component(root ${PLACEHOLDER} DIRECTORY)
  get_filename_component(names ${PLACEHOLDER} NAME)
endif()
# The table is searched by bytes; a locale's order would not do.
list(SORT names COMPARE STRING CASE SENSITIVE)

set(blobs "")
set(symbols "")
set(table "")
set(number 0)
foreach(name IN LISTS names)
  if(name MATCHES "[\"\\\\\r\n]")
    message(FATAL_ERROR "${root}/${name}: its name cannot be embedded (rename it)")
  endif()
  file(SHA256 ${root}/${name} hash)
  string(SUBSTRING ${hash} 0 32 etag)
  set(url /${name})
  if(placeholder)
    set(url /index.html)
  endif()
  set(symbol goldthread_page_${number})
  string(APPEND blobs
    "asm(R\"(.section .rodata\n${symbol}:\n.incbin \"${root}/${name}\"\n${symbol}_end:\n.byte 0\n.previous)\");  // ${hash}\n")
  string(APPEND symbols "extern const char ${symbol}[], ${symbol}_end[];\n")
  string(APPEND table
    "    {\"${url}\", \"\\\"${etag}\\\"\", {${symbol}, ${symbol}_end}},\n")
  math(EXPR number "${number} + 1")
endforeach()

set(source "// SPDX-License-Identifier: Apache-2.0
// Made by embed_pages.cmake.
#include \"compositor/gateway/pages.h\"

${blobs}
extern \"C\" {
${symbols}}

namespace goldthread {

std::span<const EmbeddedPage> embedded_pages() {
  static const EmbeddedPage pages[] = {
${table}  };
  return pages;
}

}  // namespace goldthread
")
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "${source}" @ONLY)
