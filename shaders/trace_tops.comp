#version 450 core
// Visibility of the queued entries whose node is of several static objects (trace.glsl). One thread an entry.
#define TOPS 1
#include "trace.glsl"
