#version 450 core
// The gather of the sweep that ends a solve under a budget of time: links are summed in single precision, which what it says
// of residuals counts with.
#define CERTIFY
#define SUM_IN_SINGLE
#define REAL double
#define REAL3 dvec3
#define REAL4 dvec4
#define SUM float
#define SUM4 vec4
#include "gather.glsl"
