#version 450 core
// The gather in double precision, for where single precision would keep the bound above the tolerance (check.comp).
#include "double.glsl"
#include "gather.glsl"
