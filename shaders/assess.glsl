// Under a budget: what has to be refreshed of a row, what that takes, and a bound on what it changes, entry by entry.
// One thread a row in the list that enlist.comp made.
//
// A closed row shares out a weight of 1. Let T be the sum of F V of its entries, T' what it becomes. Closing gives what
// is missing to all entries one way (close.comp), 1 - T in sum before and 1 - T' afterwards. With b the B of an entry,
// beta and beta' the means of those that get it, and delta what each touched entry gains or loses of F V,
//
//     H' - H = sum of delta (b - beta') + (1 - T) (beta' - beta),   darkest <= beta, beta' <= brightest of the row
//
// An entry that was flagged gains at most F (1 - V) and loses at most F V, and what it keeps of these may come from
// another leaf of its node where it has several rays (trace.comp); of a source that is cut anew all goes, and as much
// comes as is in its reach. Emitters are corrected only when the others are at their limits: what they may be raised or
// lowered by counts on its own. Black sky gets its part where no ray saw it, too. A row that may not close may become
// anything.
//
// SPECULAR: what an entry sees in a mirror or through glass may be anything in the scene after whatever moved.
#define READ_FRAME
#define READ_OBJECTS
#define READ_TOPOLOGY
#define READ_WORLD
#define READ_LEAVES
#define READ_MATERIALS
#define READ_SEGMENTS
#define READ_ENTRIES
#define READ_TARGETS
#define READ_OBJECT_LISTS
#define READ_ROWS
#define READ_LINKS
#define READ_RADIOSITY
#define READ_LEAF_RADIOSITY
#define READ_LIGHT_BOUNDS
#define WRITE_ROWS
#define WRITE_CHOICES
#define WRITE_PENDING
#define WRITE_STATE
#include "buffers.glsl"
#include "dispatch.glsl"
#include "changed.glsl"
#include "entry.glsl"
#include "swept.glsl"
#include "flag.glsl"
#include "facing.glsl"
#include "reach.glsl"
#include "sampling.glsl"
#include "view.glsl"
#include "priority.glsl"
#include "row_light.glsl"
#include "received.glsl"
#include "whole_row.glsl"
#include "numbers.glsl"
#ifdef SPECULAR
#include "specular_entry.glsl"
#endif

layout(local_size_x = GI_GROUP_SIZE) in;

// As closing has them (close.comp): rows that lack a fifth when all entries have doubled (CLOSE_RAISE) stay open; above
// this weight none does. Sums end this close to 1.
const float CLOSES_ABOVE = 0.5;
const float CLOSE_SLACK = 4e-5;

// Emitters of more weight than this may have to be lowered for a row to close.
const float EMITTERS_MOVE_ABOVE = 0.9;

struct range {
	vec3 least, most;
};

const range NOTHING = range(vec3(3e38), vec3(0.0));

void include(inout range r, range b)
{
	r = range(min(r.least, b.least), max(r.most, b.most));
}

// Weight that entries lose or gain.
struct part {
	float others, emitters;
	vec3 low;  // sum of weight times the least B, of the others
	vec3 high; // sum of weight times the largest B, of all
};

float weight_of(part p)
{
	return p.others + p.emitters;
}

void add(inout part p, float weight, range b, bool emitter)
{
	p.others += emitter ? 0.0 : weight;
	p.emitters += emitter ? weight : 0.0;
	p.low += emitter ? vec3(0.0) : weight * b.least;
	p.high += weight * b.most;
}

struct sums {
	float firm_others, firm_emitters; // F V of the untouched
	part lost, gained;                // of the touched
	float kept;                       // what the touched may weigh afterwards
	float unseen;                     // F of the touched that closing may raise from nothing, black sky
	vec3 exchanged;                   // F V of the touched that may change leaves, times how far their B is apart
	range others, emitters;           // B of the entries, before and afterwards; of the firm, that of their objects
	uint rays, entries;
	uint had; // entries, touched or not
};

// What a row has of one source object.
struct source_part {
	uint object;
	range others;   // B of its leaves that are no emitters
	vec3 brightest; // B of all of them
	bool emits;     // some of it
	bool dark_sky;
	bool smooth_part; // mirrors or glass, in which anything may be seen
};

#ifdef SPECULAR
// Segments of a way through mirrors and glass, about.
const uint PATH_RAYS = 4u;

// The most that is seen in mirrors and through glass: what emitters give comes by photons, but where there are none.
vec3 brightest_seen()
{
	uint which = frame.statics.y != 0u ? GI_LIGHT_BOUND_ALL : GI_LIGHT_BOUND_OTHERS;
	uint at = GI_LIGHT_BOUND_WORDS * frame.counts.z + which;
	uvec3 most = uvec3(load_light_bound(at), load_light_bound(at + 1u), load_light_bound(at + 2u));
	return max(uintBitsToFloat(most), reflected_most());
}
#endif

source_part load_source(uint object)
{
	uint root = object_nodes(object).x, flags = topology_range(root).w;
	bool emits = (flags & GI_NODE_EMITTER) != 0u;
	bool sky = (object_bvh(object).z & GI_OBJECT_SKY) != 0u;
	source_part from = source_part(object, NOTHING, vec3(0.0), emits, sky, false);
	for (uint c = 0u; c < 3u; c++) {
		uint at = GI_LIGHT_BOUND_WORDS * object + c;
		from.others.most[c] = uintBitsToFloat(load_light_bound(at + GI_LIGHT_BOUND_OTHERS));
		from.brightest[c] = uintBitsToFloat(load_light_bound(at + GI_LIGHT_BOUND_ALL));
		from.others.least[c] =
		    (flags & GI_NODE_BACK) != 0u ? 0.0 : uintBitsToFloat(~load_light_bound(at + GI_LIGHT_BOUND_LEAST));
	}
#ifdef SPECULAR
	from.smooth_part = has_smooth(object);
	if (from.smooth_part) {
		from.others = range(vec3(0.0), from.others.most + brightest_seen());
		from.brightest += brightest_seen();
	}
#endif
	return from;
}

void add_entry(inout sums s, source_part from, uint at, uvec4 e, bool touched, bool stays, bool traced)
{
	uint taken = samples_of(e);
	float f = uintBitsToFloat(e.y), v = taken > 0u ? f * float(seen_of(e)) / float(taken) : 0.0;
	s.rays += traced ? max(taken, 1u) : 0u;
	s.entries += touched ? 1u : 0u;
	s.unseen += touched && v == 0.0 && from.dark_sky ? f : 0.0;
	if (v == 0.0 && !(touched && stays))
		return;
	bool emitter = from.emits && (topology_range(e.x).w & GI_NODE_EMITTER) != 0u;
	if (!touched) {
		s.firm_others += emitter ? 0.0 : v;
		s.firm_emitters += emitter ? v : 0.0;
		return;
	}
	uint target = load_target(at) & ~GI_TARGET_BLACK;
	vec3 own = (e.w & GI_ENTRY_BACK) != 0u ? vec3(0.0) : load_radiosity(target).xyz;
	range b = range(own, own);
	// The leaf whose light the entry takes may change, or is not known.
	bool any_leaf = (taken > 1u || target == e.x) && (e.w & GI_ENTRY_BACK) == 0u && topology_range(e.x).z > 1u;
	if (any_leaf || from.smooth_part) {
		b = range(from.others.least, emitter ? from.brightest : from.others.most);
		s.exchanged += v * (b.most - b.least);
	}
	if (emitter)
		include(s.emitters, b);
	else
		include(s.others, b);
	add(s.lost, v, b, emitter);
	if (stays) {
		add(s.gained, max(f - v, 0.0), b, emitter);
		s.kept += f;
	}
}

// What a new cut of a source may bring. A leaf that moved is off by anything that is not an emitter's light.
void add_cut(inout sums s, source_part from, shape p, bool moved, uint count)
{
	uint flags = object_bvh(from.object).z;
	bool sky = (flags & GI_OBJECT_SKY) != 0u;
	float f = (flags & GI_OBJECT_UNSEEN) != 0u ? 0.0 : sky || (moved && !from.emits) ? 1.0 : reach(p, from.object);
	if (f == 0.0)
		return;
	range b = range(from.others.least, from.brightest);
	add(s.gained, f, b, from.emits);
	s.kept += f;
	include(s.others, from.others);
	if (from.emits)
		include(s.emitters, b);
	// Of all static objects together a row has about as many entries as of everything.
	uint unknown = from.object == frame.swept.w ? max(state.rows.entries / frame.rows.x, 1u) : 1u;
	s.rays += count == 0u ? unknown : 0u;
	s.entries += count == 0u ? 1u : 0u;
}

sums sum_row(uint leaf, watch w)
{
	part none = part(0.0, 0.0, vec3(0.0), vec3(0.0));
	sums s = sums(0.0, 0.0, none, none, 0.0, 0.0, vec3(0.0), NOTHING, NOTHING, 0u, 0u, 0u);
	gi_node_geometry p = load_world(load_leaf(leaf).x);
	for (uint source = frame.swept.z; source < frame.counts.z; source++) {
		uvec4 block = load_segment(segment_of(leaf, source));
		uint count = block.y & GI_BLOCK_COUNT_MASK;
		s.had += count;
		bool cut = pair_is_dirty(w.mine, source, w.since), keeps = pair_keeps_nodes(w.mine, source, w.since);
		source_part from = load_source(source);
		float firm_others = s.firm_others, firm_emitters = s.firm_emitters;
		for (uint k = 0u; k < count; k++) {
			uvec4 e = load_entry(block.x + k);
			// Any node of the cut may be replaced by another; few are.
			bool traced = (cut && !keeps) || (e.w & GI_ENTRY_GONE) != 0u || is_flagged(w, p, e);
			bool followed = false;
#ifdef SPECULAR
			followed = from.smooth_part && sees_smooth(e, load_target(block.x + k));
			s.rays += followed ? PATH_RAYS : 0u;
#endif
			add_entry(s, from, block.x + k, e, cut || traced || followed, !cut, traced);
		}
		if (s.firm_others > firm_others || (from.dark_sky && count > 0u))
			include(s.others, from.others);
		if (s.firm_emitters > firm_emitters)
			include(s.emitters, range(from.others.least, from.brightest));
		if (cut)
			add_cut(s, from, shape_of(p, topology_range(load_leaf(leaf).x).w), w.moved, count);
	}
	return s;
}

// xyz: bound on what refreshing the row changes of H; w: on the share of its weight that moves.
vec4 bound_of(sums s, received r, bool open)
{
	float firm = s.firm_others + s.firm_emitters, lost = weight_of(s.lost);
	float emitters = s.firm_emitters + s.lost.emitters + s.gained.emitters;
	vec3 darkest = min(s.others.least, s.emitters.least), dim = s.others.most, bright = max(dim, s.emitters.most);
	limits whole = whole_row(r, dim, s.emitters.most, emitters);
	if (open || firm < CLOSES_ABOVE)
		return vec4(max(whole.rise, whole.fall), 1.0);
	float lacked = abs(1.0 - firm - lost);
	// Touched entries are raised too: none more than doubles, nor what was nothing by more than its form factor;
	// together they gain no more than the row lacks.
	float raise_old = min((CLOSE_RAISE - 1.0) * lost + s.unseen, max(0.0, 1.0 - firm - lost));
	float raise_new = min((CLOSE_RAISE - 1.0) * s.kept, max(0.0, 1.0 - firm));
	float moved = min(1.0, max(lost, s.kept) + lacked + max(raise_old, raise_new) + CLOSE_SLACK);
	// Emitters are raised by what the others at their limits leave, and lowered when they alone nearly fill the
	// row.
	float raised = min(emitters, max(0.0, 1.0 - CLOSE_RAISE * s.firm_others - s.firm_emitters));
	float lowered = emitters > EMITTERS_MOVE_ABOVE ? emitters : 0.0;
	vec3 dim_emitters = max(dim - s.emitters.least, vec3(0.0));
	vec3 either = lacked * max(dim - darkest, vec3(0.0)) + (raised + lowered) * (bright + dim_emitters) +
		      CLOSE_SLACK * whole.most;
	either += s.exchanged;
	vec3 rise = s.gained.high - weight_of(s.gained) * darkest + s.lost.others * dim - s.lost.low +
		    s.lost.emitters * dim_emitters;
	vec3 fall =
	    s.lost.high - lost * darkest + s.gained.others * dim - s.gained.low + s.gained.emitters * dim_emitters;
	return vec4(max(min(max(rise, 0.0) + either, whole.rise), min(max(fall, 0.0) + either, whole.fall)), moved);
}

void assess(uint leaf)
{
	sums s = sum_row(leaf, watch_of(leaf));
	uvec4 row = load_row(leaf);
	uint since = row.z;
	bool open = (row.w & GI_ROW_OPEN) != 0u;
	if (open) {
		s.entries = max(s.entries, 1u);
		s.rays = max(s.rays, 1u);
	}
	// A row of nothing yet will take about as much as others did.
	if (s.had == 0u && s.entries > 0u)
		s.rays = max(s.rays, state.rows.entries / frame.rows.x);
	if (s.entries == 0u) {
		rows[leaf].z = frame.update.x; // nothing of the row can have changed: it is current
		pending[leaf].key = uvec4(0u);
		return;
	}
	gi_material_data m = load_material(load_leaf(leaf).z);
	vec4 bound = bound_of(s, received_by(leaf, m), open);
	bound.xyz *= m.rho.xyz;
	float off = expected_off(bound, max(m.rho.x, max(m.rho.y, m.rho.z)));
	float worth = worth_of(off, load_world(load_leaf(leaf).x), s.rays);
	uint bucket = is_wanted(off) ? bucket_of(leaf, worth, since) : 0u;
	pending[leaf].key = uvec4(bucket, s.rays, s.entries, frame.update.x);
	pending[leaf].bound = bound;
	if (bucket > 0u)
		atomicAdd(choices[bucket], s.rays);
}

void main()
{
	uint k = spread_number(state.counts.assessed_rows);
	if (k < state.counts.assessed_rows)
		assess(choices[GI_CHOICE_CHOSEN + frame.rows.x + k]);
}
