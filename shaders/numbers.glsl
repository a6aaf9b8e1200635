// Numbers that several shaders count by.
#ifndef NUMBERS_GLSL
#define NUMBERS_GLSL

const float PI = 3.14159265358979;
const float INVERSE_PI = 0.318309886183791;

// Stands for what is not known, or is too large to tell.
const float HUGE = 3e38;

// Makes a bound hold for all that: more than the rounding of a division (2.5 units in the last place) and of the few
// operations around it.
const float OUTWARD = 1.0 + 1.0 / 1048576.0;

// A source that subtends less than this (radius over distance) is taken as a point: the contour sum would lose digits.
const float POINT_SOURCE = 0.02;

// Closing raises no entry by more than this factor: what lies hidden wholly (a row inside a solid) stays dark.
const float CLOSE_RAISE = 2.0;

#endif
