# Writes OUT: a C++ file that defines the function NAME of the namespace NAMESPACE, declared in HEADER, which returns the
# bytes of FILE as std::span<const unsigned char>.
cmake_minimum_required(VERSION 3.25)

file(READ ${FILE} bytes HEX)
string(REGEX REPLACE "(................................)" "\\1\n" bytes "${bytes}")
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
get_filename_component(from ${FILE} NAME)
file(WRITE ${OUT} "// Generated from ${from}; do not edit.\n#include \"${HEADER}\"\n\nnamespace ${NAMESPACE} {\n"
  "std::span<const unsigned char> ${NAME}() {\n    static constexpr unsigned char kBytes[] = {\n${bytes}};\n"
  "    return kBytes;\n}\n}  // namespace ${NAMESPACE}\n")
