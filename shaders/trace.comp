#version 450 core
// Visibility of the queued entries whose node is of one object, or the sky (trace.glsl). One thread an entry.
#define TOPS 0
#include "trace.glsl"
