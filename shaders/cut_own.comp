#version 450 core
// The same for pairs of leaves of one object whose shape may change (cut.glsl). One thread a leaf.
#define KEEPS 0
#define OWN 1
#include "cut.glsl"
