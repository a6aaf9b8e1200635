# Writes OUT, a C initialiser {byte, ..., 0} that holds the text of FILE: static const char text[] =\n#include "OUT"\n;
file(READ "${FILE}" hex HEX)
# Bytes, not a literal: compilers limit literals to 64 KiB.
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
file(WRITE "${OUT}" "{${bytes}0}\n")
