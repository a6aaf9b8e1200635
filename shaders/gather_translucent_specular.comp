#version 450 core
// The gather in single precision, where light is scattered below surfaces and goes through mirrors or glass.
#define TRANSLUCENT
#define SPECULAR
#define REAL float
#define REAL3 vec3
#define REAL4 vec4
#define ROUNDING_OF_REAL float(ROUNDING)
#define SLACK_OF_REAL 1e-6
#include "gather.glsl"
