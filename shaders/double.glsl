// Sums in double precision.
#define REAL double
#define REAL3 dvec3
#define REAL4 dvec4
#define ROUNDING_OF_REAL 1.1102230246251565e-16lf
#define SLACK_OF_REAL 1e-12lf
