#version 450 core
// Cuts: of each pair of a leaf and an object that has to be cut anew, all entries anew (cut.glsl). One thread a pair.
#define KEEPS 0
#include "cut.glsl"
