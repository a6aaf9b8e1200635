#version 450 core
// The gather in single precision, where light is scattered below surfaces and goes through mirrors or glass.
#define TRANSLUCENT
#define SPECULAR
#include "single.glsl"
#include "gather.glsl"
