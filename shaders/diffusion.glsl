// Light below the surface of translucent objects (subsurface.h): sums over the links of a row of values, irradiances of
// leaves and their means over clusters. In double precision, for values are rounded once more than light elsewhere.

struct diffused {
	dvec3 light, amplified; // sums of weight * value, of its rgb and of its fourth channel
	dvec3 weight;
	uint count;
};

diffused diffuse(uvec4 row)
{
	diffused d = diffused(dvec3(0.0lf), dvec3(0.0lf), dvec3(0.0lf), row.y);
	for (uint k = row.x; k < row.x + row.y; k++) {
		uvec4 link = load_diffusion_link(k);
		dvec3 weight = dvec3(uintBitsToFloat(link.yzw));
		dvec4 value = dvec4(load_diffusion_value(link.x));
		d.light += weight * value.xyz;
		d.amplified += weight * value.w;
		d.weight += weight;
	}
	return d;
}
