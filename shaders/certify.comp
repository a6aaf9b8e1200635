#version 450 core
// The gather of a certifying sweep, in double precision: what it says of residuals bounds them, rounding included.
#define CERTIFY
#define REAL double
#define REAL3 dvec3
#define REAL4 dvec4
#define SUM double
#define SUM4 dvec4
#include "gather.glsl"
