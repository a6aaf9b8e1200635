#version 450 core
// The gather of an ordinary sweep, in single precision: fast, and what it says of residuals is an estimate.
#define REAL float
#define REAL3 vec3
#define REAL4 vec4
#define SUM float
#define SUM4 vec4
#include "gather.glsl"
