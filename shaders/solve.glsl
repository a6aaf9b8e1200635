// What B is stored in, and how far that is from the number meant: the model behind the certified bound (check.comp).
//
// A number x >= 0 is kept as the nearest float, which is off by at most 2^-24 x; below the least normal float as that
// float, for renderers differ in what they make of less. 2^-20 more covers the double-precision sum that x came from.

const float LEAST_NORMAL = 1.17549435e-38;
const double ROUNDING = 5.9604701e-8lf; // 2^-24 (1 + 2^-20)

vec4 to_single(vec4 x)
{
	return mix(x, max(x, vec4(LEAST_NORMAL)), greaterThan(x, vec4(0.0)));
}

vec4 to_single(dvec4 x)
{
	return mix(vec4(x), max(vec4(x), vec4(LEAST_NORMAL)), greaterThan(x, dvec4(0.0lf)));
}
