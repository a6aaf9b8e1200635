#version 450 core
// Under a budget: what has to be refreshed of each row, what that takes, and a bound on what it changes. One thread a
// leaf.
//
// A closed row shares out a weight of 1. Let T be the sum of F V of its entries, D = |1 - T|, X and X' what the touched
// ones have of it and may have afterwards, U = T - X the rest. Entries that nothing touched keep F and V. Closing corrects
// all entries of a row one way, by 1 - T in sum before and by 1 - T' afterwards, with U <= T' <= U + X'. So of the untouched
// entries those that rise do so by no more than X + D, those that fall by no more than X' + D:
//
//     H rises by at most  gain + (X + D) B_firm + what emitters are raised by
//     H falls by at most  loss + (X' + D) B_firm + what emitters are raised or lowered by, and by no more than H
//
// gain: what the touched entries can bring, loss: what they bring now, B_firm: the brightest untouched entry but for
// emitters, which are corrected only when the others are at their limits. Where the row may not close, everything counts as
// touched.
#define USE_FRAME
#define USE_OBJECTS
#define USE_TOPOLOGY
#define USE_WORLD
#define USE_LEAVES
#define USE_MATERIALS
#define USE_SEGMENTS
#define USE_ENTRIES
#define USE_STATE
#define USE_SUSPECTS
#define USE_ROWS
#define USE_RADIOSITY
#define USE_LEAF_RADIOSITY
#define USE_CHOICES
#define USE_PENDING
#define USE_SHINE
#include "buffers.glsl"
#include "dispatch.glsl"
#include "changed.glsl"
#include "flag.glsl"
#include "facing.glsl"
#include "reach.glsl"
#include "sampling.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

// As closing has them (close.comp): no entry more than doubles, rows that lack more stay open, sums end this close to 1.
const float CLOSE_RAISE = 2.0;
const float OPEN_RAISE = 2.5; // and is scaled to what is missing of 1
const float CLOSES_ABOVE = 0.41;
const float CLOSE_SLACK = 4e-5;

// Emitters of more weight than this may have to be lowered for a row to close.
const float EMITTERS_MOVE_ABOVE = 0.9;

// After so many updates (and up to half as many more) a row goes first, whatever its bound.
const float OLDEST = 48.0;

struct part {
	float weight;
	float emitters; // part of weight
	vec3 brightest; // B of those that are no emitters
	vec3 brightest_emitter;
};

struct sums {
	part firm;            // untouched: F V, each taken as bright as the brightest of its object
	part touched;         // what they may weigh afterwards: F, or the most that a new cut may have
	float weight_before;  // F V of the touched
	vec3 gain, loss;      // touched: F B, and F V B now
	uint rays, entries;
};

void add(inout part p, float weight, vec3 b, bool emitter)
{
	p.weight += weight;
	if (emitter) {
		p.emitters += weight;
		p.brightest_emitter = max(p.brightest_emitter, b);
	} else {
		p.brightest = max(p.brightest, b);
	}
}

vec3 brightest(part p)
{
	return max(p.brightest, p.brightest_emitter);
}

vec3 shine_of(uint object)
{
	return vec3(uintBitsToFloat(shine[4u * object]), uintBitsToFloat(shine[4u * object + 1u]), uintBitsToFloat(shine[4u * object + 2u]));
}

// What a row has of one source object.
struct source_part {
	uint object;
	vec3 shine;   // the largest B that may come from it
	bool emits;   // some of it
};

source_part load_source(uint object)
{
	uint root = objects[object].nodes.x;
	bool sky = (objects[object].bvh.z & GI_OBJECT_SKY) != 0u;
	return source_part(object, sky ? radiosity[root].xyz : shine_of(object), (topology[root].range.w & GI_NODE_EMITTER) != 0u);
}

bool is_emitter(source_part from, uint node)
{
	return from.emits && (topology[node].range.w & GI_NODE_EMITTER) != 0u;
}

void add_entry(inout sums s, source_part from, uvec4 e, bool touched, bool stays)
{
	uint taken = samples_of(e);
	float f = uintBitsToFloat(e.y), v = taken > 0u ? f * float(bitCount(e.z & 0xFFFFu)) / float(taken) : 0.0;
	bool emitter = is_emitter(from, e.x);
	if (!touched) {
		if (v > 0.0)
			add(s.firm, v, from.shine, emitter);
		return;
	}
	vec3 b = (e.w & GI_ENTRY_BACK) != 0u ? vec3(0.0) : radiosity[e.x].xyz;
	s.weight_before += v;
	s.loss += v * b;
	s.rays += max(taken, 1u);
	s.entries++;
	add(s.touched, stays ? f : 0.0, b, emitter);
	s.gain += stays ? f * b : vec3(0.0);
}

// What a new cut of a source may bring. A leaf that moved is off by anything that is not an emitter's light.
void add_cut(inout sums s, source_part from, gi_node_geometry p, bool moved, uint count)
{
	bool sky = (objects[from.object].bvh.z & GI_OBJECT_SKY) != 0u;
	float f = sky || (moved && !from.emits) ? 1.0 : reach(p, from.object);
	if (f == 0.0)
		return;
	add(s.touched, f, from.shine, from.emits);
	s.gain += f * from.shine;
	s.rays += count == 0u ? 1u : 0u;
	s.entries += count == 0u ? 1u : 0u;
}

sums sum_row(uint leaf, watch w)
{
	part none = part(0.0, 0.0, vec3(0.0), vec3(0.0));
	sums s = sums(none, none, 0.0, vec3(0.0), vec3(0.0), 0u, 0u);
	gi_node_geometry p = world[leaves[leaf].x];
	for (uint source = 0u; source < frame.counts.z; source++) {
		uvec4 block = segments[leaf * frame.counts.z + source];
		uint count = block.y & GI_BLOCK_COUNT_MASK;
		bool cut = pair_is_dirty(w.mine, source, w.since);
		source_part from = load_source(source);
		for (uint k = 0u; k < count; k++) {
			uvec4 e = entries[block.x + k];
			add_entry(s, from, e, cut || is_flagged(w, p, e), !cut);
		}
		if (cut)
			add_cut(s, from, p, w.moved, count);
	}
	return s;
}

// xyz: bound on what refreshing the row changes of H; w: on the share of its weight that moves.
vec4 bound_of(sums s, vec3 h)
{
	float before = s.firm.weight + s.weight_before;
	// Whatever the row becomes: weights of 1 in sum, of which emitters have no more than raised and scaled.
	vec3 emitted = OPEN_RAISE * (s.firm.emitters * s.firm.brightest_emitter + s.touched.emitters * s.touched.brightest_emitter);
	vec3 dim = max(s.firm.brightest, s.touched.brightest);
	vec3 all = min(dim + emitted, max(brightest(s.firm), brightest(s.touched)));
	if (s.firm.weight < CLOSES_ABOVE || before < CLOSES_ABOVE)
		return vec4(max(all, h), 1.0);
	// Touched entries are raised too: none more than doubles, together they gain no more than the row lacks.
	float lacked = abs(1.0 - before);
	float raise_old = min((CLOSE_RAISE - 1.0) * s.weight_before, max(0.0, 1.0 - before));
	float raise_new = min((CLOSE_RAISE - 1.0) * s.touched.weight, max(0.0, 1.0 - s.firm.weight));
	float moved = min(1.0, max(s.weight_before, s.touched.weight) + lacked + max(raise_old, raise_new) + CLOSE_SLACK);
	// Emitters are raised by what the others at their limits leave, and lowered when they alone nearly fill the row.
	float others = s.firm.weight - s.firm.emitters;
	float lack = max(0.0, 1.0 - CLOSE_RAISE * others - s.firm.emitters);
	bool full = s.firm.emitters + s.touched.emitters > EMITTERS_MOVE_ABOVE;
	vec3 raised = min(lack, s.firm.emitters) * s.firm.brightest_emitter + min(lack, s.touched.emitters) * s.touched.brightest_emitter;
	vec3 lowered = (full ? s.firm.emitters : 0.0) * s.firm.brightest_emitter;
	vec3 gain = s.gain + raise_new * s.touched.brightest;
	vec3 loss = s.loss + raise_old * s.touched.brightest;
	vec3 rise = min(gain + (s.weight_before + lacked) * s.firm.brightest + raised, all);
	vec3 fall = min(loss + min(1.0, s.touched.weight + lacked) * s.firm.brightest + raised + lowered, h);
	return vec4(max(rise, fall) + CLOSE_SLACK * all, moved);
}

// Rows of like bounds are parted by a hash, so that a bucket never holds too many; old ones go first.
uint bucket_of(uint leaf, float bound, uint since)
{
	float age = float(frame.update.x - since);
	float random = unit_float(hash(leaf ^ hash(since)));
	if (age > OLDEST * (1.0 + 0.5 * random))
		return GI_BUCKETS - 1u;
	float largest = max(uintBitsToFloat(state[GI_STATE_DONE_B_MAX_BITS]), 1e-30);
	float octave = log2(max(bound / largest, exp2(-40.0))) + log2(age) + 2.0 * random;
	return uint(clamp(int(float(GI_BUCKETS_PER_OCTAVE) * (octave + 41.0)), 1, int(GI_BUCKETS) - 2));
}

void main()
{
	uint leaf = thread_number();
	if (leaf >= frame.counts.x)
		return;
	watch w = watch_of(leaf);
	vec3 b = leaf_radiosity[leaf].xyz;
	gi_pending row = gi_pending(uvec4(0u), vec4(0.0), vec4(b, 0.0));
	bool changed = false;
	for (uint k = frame.update.y; k < frame.update.z; k++)
		changed = changed || max(objects[suspects[k]].changed.x, objects[suspects[k]].changed.y) > w.since;
	if (changed) {
		sums s = sum_row(leaf, w);
		gi_material_data m = materials[leaves[leaf].z];
		vec3 h = mix(vec3(0.0), (b - m.exitance.xyz) / m.rho.xyz, greaterThan(m.rho.xyz, vec3(0.0)));
		vec4 bound = bound_of(s, max(h, vec3(0.0)));
		bound.xyz *= m.rho.xyz;
		// As it will count in the end (stale.comp), if B goes about as far as it went in the update before.
		float rho = max(m.rho.x, max(m.rho.y, m.rho.z));
		float more = 2.0 * bound.w * uintBitsToFloat(state[GI_STATE_STEP_BITS]) * rho;
		float largest = (max(bound.x, max(bound.y, bound.z)) + more) / (1.0 - rho);
		if (s.entries == 0u) {
			rows[leaf].z = frame.update.x; // nothing of it can have changed
		} else {
			row.bound = bound;
			row.key.yz = uvec2(s.rays, s.entries);
			bool wanted = frame.limit.y == 0.0 || largest > frame.limit.y * uintBitsToFloat(state[GI_STATE_DONE_B_MAX_BITS]);
			row.key.x = wanted ? bucket_of(leaf, largest, w.since) : 0u;
			if (wanted)
				atomicAdd(choices[row.key.x], s.rays);
		}
	}
	pending[leaf] = row;
}
