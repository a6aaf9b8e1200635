// H of a leaf by its row, at B as the solve before left it.
#include "packed_light.glsl"

struct received {
	vec3 h;
	vec3 slack; // how far off that may be
};

// By the solve, B = E + rho H but for its residual: what is stored lies within BOUND of the solution of the rows, and
// |T B - B| = |M (B* - B)| <= 2 BOUND. That holds as long as E and rho are those of the solve, which knows no
// receivers. What lights without a surface bring is no row's.
received received_by(uint leaf, gi_material_data m)
{
	if (leaf >= frame.counts.x || (frame.update.w & (GI_UPDATE_MATERIAL | GI_UPDATE_BY_ROWS)) != 0u)
		return received(light_of_row(leaf), vec3(0.0));
	vec3 rho = max(m.rho.xyz, vec3(1e-20));
	float slack;
	vec3 by_lights = unpack_light(load_leaf_part(GI_LEAF_EMITTED, leaf).w, slack);
	return received(load_leaf_part(GI_LEAF_R, leaf).xyz / rho - by_lights,
			2.0 * state.solve.bound / rho + slack);
}
