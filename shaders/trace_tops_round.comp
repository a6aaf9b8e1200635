#version 450 core
// The same as trace_tops.comp where some receivers see all round (visibility.glsl).
#define TOPS 1
#define ROUND
#include "trace.glsl"
