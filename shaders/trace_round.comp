#version 450 core
// The same as trace.comp where some receivers see all round (visibility.glsl).
#define TOPS 0
#define ROUND
#include "trace.glsl"
