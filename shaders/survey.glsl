// Under a budget: which rows something may have changed, what they may become for all that is known without a look at
// their entries, and how much that matters. Rows assessed since anything changed keep the bound they were given, made
// wider by how far B went since, where time is short. One thread a leaf.
//
// What is known: B of the scene, the row's H, and how much of it emitters can have: the form factors of those at rest,
// the reach of those that moved or whose leaf did.
#define READ_FRAME
#define READ_OBJECTS
#define READ_TOPOLOGY
#define READ_WORLD
#define READ_LEAVES
#define READ_MATERIALS
#define READ_SEGMENTS
#define READ_OBJECT_LISTS
#define READ_ROWS
#define READ_LINKS
#define READ_RADIOSITY
#define READ_LEAF_RADIOSITY
#define READ_PENDING
#define READ_LIGHT_BOUNDS
#define WRITE_CHOICES
#define WRITE_PENDING
#define WRITE_STATE
#include "buffers.glsl"
#include "dispatch.glsl"
#include "changed.glsl"
#include "facing.glsl"
#include "reach.glsl"
#include "sampling.glsl"
#include "view.glsl"
#include "priority.glsl"
#include "row_light.glsl"
#include "received.glsl"
#include "whole_row.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

// With more movers than this every row is taken to have one before it.
const uint MOST_MOVERS = 16u;

vec3 light_bound_of_all(uint what)
{
	uint at = GI_LIGHT_BOUND_WORDS * frame.counts.z + what;
	return uintBitsToFloat(uvec3(load_light_bound(at), load_light_bound(at + 1u), load_light_bound(at + 2u)));
}

// Bound on the weight of emitters in the row before it is closed, now and after refreshing.
float emitter_weight(uint leaf, shape p, uint mine, uint since)
{
	if (frame.budget.x > frame.budget.y)
		return 1.0;
	float sum = 0.0;
	for (uint k = frame.budget.x; k < frame.budget.y; k++) {
		uint source = load_listed_object(k);
		uvec4 segment = load_segment(segment_of(leaf, source));
		sum += (segment.y & GI_BLOCK_COUNT_MASK) > 0u ? FACTOR_SLACK * uintBitsToFloat(segment.w) : 0.0;
		if (pair_is_dirty(mine, source, since))
			sum += (object_bvh(source).z & GI_OBJECT_SKY) != 0u ? 1.0 : reach(p, source);
	}
	return min(sum, 1.0);
}

// About how much of what the leaf sees has to do with movers.
float share_of_movers(gi_node_geometry p, uint mine, uint since)
{
	if (moved_since(mine, since) || frame.update.z - frame.update.y > MOST_MOVERS)
		return 1.0;
	float share = 0.0;
	for (uint k = frame.update.y; k < frame.update.z; k++) {
		uint object = load_listed_object(k);
		vec4 ball = object_sphere(object);
		vec3 to = ball.xyz - p.sphere.xyz;
		float subtends = min(1.0, ball.w * ball.w / max(dot(to, to), 1e-30));
		share += object_changed(object).y > since ? 1.0 : moved_since(object, since) ? subtends : 0.0;
	}
	return min(share, 1.0);
}

// Of a row that was assessed since anything changed.
void go_on(uint leaf, inout gi_pending row, gi_material_data m, uint since)
{
	float rho = max(m.rho.x, max(m.rho.y, m.rho.z));
	row.bound.xyz += m.rho.xyz * 2.0 * row.bound.w * uintBitsToFloat(state.budget.step_bits);
	float off = expected_off(row.bound, rho);
	gi_node_geometry p = load_world(load_leaf(leaf).x);
	row.key.x = is_wanted(off) ? bucket_of(leaf, worth_of(off, p, row.key.y), since) : 0u;
	if (row.key.x > 0u)
		atomicAdd(choices[row.key.x], row.key.y);
}

// The most that things are bright: `dim` what emits nothing, or is seen in a mirror or through glass. Where such a one
// has light of its own both count.
void bounds_of_light(out vec3 dim, out vec3 all)
{
	dim = light_bound_of_all(GI_LIGHT_BOUND_OTHERS);
	all = light_bound_of_all(GI_LIGHT_BOUND_ALL);
#ifdef SPECULAR
	vec3 seen = frame.statics.y != 0u ? max(all, reflected_most()) : reflected_most();
	if (frame.statics.z != 0u) {
		dim += seen;
		all += seen;
	}
	dim = max(dim, reflected_most());
#endif
}

void bound_whole(uint leaf, inout gi_pending row, gi_material_data m, uvec4 header)
{
	uint mine = load_leaf(leaf).y, since = header.z;
	gi_node_geometry p = load_world(load_leaf(leaf).x);
	vec3 dim, all;
	bounds_of_light(dim, all);
	shape receiver = shape_of(p, topology_range(load_leaf(leaf).x).w);
	limits l = whole_row(received_by(leaf, m), dim, all, emitter_weight(leaf, receiver, mine, since));
	row.bound = vec4(m.rho.xyz * max(l.rise, l.fall), 1.0);
	float off = expected_off(row.bound, max(m.rho.x, max(m.rho.y, m.rho.z)));
	float worth = worth_of(off * share_of_movers(p, mine, since), p, 1u);
	uint bucket = is_wanted(off) ? bucket_of(leaf, worth, since) : 0u;
	row.key = uvec4(bucket, 0u, max(header.y & GI_BLOCK_COUNT_MASK, 1u), 0u);
	if (bucket > 0u)
		atomicAdd(choices[GI_CHOICE_ROWS + bucket], 1u);
}

void main()
{
	uint leaf = thread_number();
	if (leaf >= frame.rows.x)
		return;
	uvec4 header = load_row(leaf);
	uint newest = frame.budget.w;
	gi_pending row = load_pending(leaf);
	gi_material_data m = load_material(load_leaf(leaf).z);
	bool holds = row.key.w > header.z && row.key.w >= newest &&
		     (frame.update.w & (GI_UPDATE_TIMED | GI_UPDATE_MATERIAL)) == GI_UPDATE_TIMED;
	if (header.z >= newest)
		row.key = uvec4(0u);
	else if (holds)
		go_on(leaf, row, m, header.z);
	else
		bound_whole(leaf, row, m, header);
	pending[leaf].key = row.key;
	pending[leaf].bound = row.bound;
	// Receivers have none (stale.comp).
	pending[leaf].before = leaf < frame.counts.x ? vec4(load_leaf_radiosity(leaf).xyz, 0.0) : vec4(0.0);
}
