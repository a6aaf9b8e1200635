// Sums in single precision: those of n terms are off by n 2^-24 at most.
#define REAL float
#define REAL3 vec3
#define REAL4 vec4
#define ROUNDING_OF_REAL float(ROUNDING)
#define SLACK_OF_REAL 1e-6
