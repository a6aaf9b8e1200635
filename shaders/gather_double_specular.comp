#version 450 core
#define SPECULAR
// The gather in double precision, for where single precision would keep the bound above the tolerance (check.comp).
#define REAL double
#define REAL3 dvec3
#define REAL4 dvec4
#define ROUNDING_OF_REAL 1.1102230246251565e-16lf
#define SLACK_OF_REAL 1e-12lf
#include "gather.glsl"
