#version 450 core
// Form factors where every row is a leaf's or that of a receiver with a normal (factor.glsl). One thread an entry.
#include "factor.glsl"
