/* The structures that both compilers read are laid out as shaders count them: in texels of four words (buffers.glsl),
 * in uniform blocks without gaps. A structure of gi_shared.h or shade_shared.h that is not here is a mistake. */
#include "gi_shared.h"
#include "shade_shared.h"

#include <stddef.h>

enum { TEXEL_BYTES = 16 };

#define ASSERT_TEXELS(structure, count)                                                                                \
	_Static_assert(sizeof(structure) == (count)*TEXEL_BYTES, "buffers.glsl reads other texels")
ASSERT_TEXELS(gi_node_geometry, 3);
ASSERT_TEXELS(gi_node_spread, 2);
ASSERT_TEXELS(gi_node_topology, 2);
ASSERT_TEXELS(gi_bvh_node, 2);
ASSERT_TEXELS(gi_primitive, 4);
ASSERT_TEXELS(gi_object_data, 14);
ASSERT_TEXELS(gi_material_data, 2);
ASSERT_TEXELS(gi_frame, 19);
ASSERT_TEXELS(gi_pending, 3);
ASSERT_TEXELS(gi_move, 2);
ASSERT_TEXELS(gi_path_slot, 5);
ASSERT_TEXELS(gi_smooth_material, 2);
ASSERT_TEXELS(gi_caustic_pair, 3);
ASSERT_TEXELS(gi_photon, 2);
ASSERT_TEXELS(gi_punctual_light, 5);
ASSERT_TEXELS(gi_estimate_leaf, 3);
ASSERT_TEXELS(gi_lamp, 9 + 4 + GI_LAMP_SAMPLE_MAX + 3);
ASSERT_TEXELS(gi_punctual_view, 5 + 7 + 4);
/* Parts of the state are whole texels, one after the other: so they lie in storage and uniform blocks as in C. */
ASSERT_TEXELS(gi_groups, 1);
ASSERT_TEXELS(gi_state_counts, 3);
ASSERT_TEXELS(gi_state_refresh, 2);
ASSERT_TEXELS(gi_state_rows, 1);
ASSERT_TEXELS(gi_state_budget, 1);
ASSERT_TEXELS(gi_state_solve, 8);
ASSERT_TEXELS(gi_state_found, 4);
ASSERT_TEXELS(gi_state_emitted, 2);
ASSERT_TEXELS(gi_state_start, 7);
ASSERT_TEXELS(gi_state_estimate, 1);
ASSERT_TEXELS(gi_state, 3 + 2 + 1 + 1 + 8 + 4 + 2 + 7 + 1 + 13);
_Static_assert(offsetof(gi_state_solve, scale) == 7 * TEXEL_BYTES, "a vec4 begins where one may");
#undef ASSERT_TEXELS

_Static_assert(sizeof(gi_lamp) % 256 == 0 && sizeof(gi_punctual_view) % 256 == 0,
	       "where OpenGL promises that uniform blocks may begin");
