#version 450 core
// Under a budget: what has to be refreshed of each row, what that takes, and a bound on what it changes. One thread a
// leaf.
//
// A closed row shares out a weight of 1. Let T be the sum of F V of its entries, T' what it becomes. Closing gives what
// is missing to all entries one way (close.comp), 1 - T in sum before and 1 - T' afterwards. With b the B of an entry, beta
// and beta' the means of those that get it, and delta what each touched entry gains or loses of F V,
//
//     H' - H = sum of delta (b - beta') + (1 - T) (beta' - beta),   darkest <= beta, beta' <= brightest of the row
//
// An entry that was flagged gains at most F (1 - V) and loses at most F V; of a source that is cut anew all goes, and as
// much comes as is in its reach. Emitters are corrected only when the others are at their limits: what they may be
// raised or lowered by counts on its own. A row that may not close may become anything.
#define READ_FRAME
#define READ_OBJECTS
#define READ_TOPOLOGY
#define READ_WORLD
#define READ_LEAVES
#define READ_MATERIALS
#define READ_SEGMENTS
#define READ_ENTRIES
#define READ_TARGETS
#define READ_SUSPECTS
#define READ_ROWS
#define READ_RADIOSITY
#define READ_PENDING
#define READ_SHINE
#define WRITE_ROWS
#define WRITE_CHOICES
#define WRITE_PENDING
#define WRITE_STATE
#include "buffers.glsl"
#include "dispatch.glsl"
#include "changed.glsl"
#include "entry.glsl"
#include "flag.glsl"
#include "facing.glsl"
#include "reach.glsl"
#include "sampling.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

// As closing has them (close.comp): no entry more than doubles, and rows that lack a fifth when all have doubled stay open;
// above this weight none does. Sums end this close to 1.
const float CLOSE_RAISE = 2.0;
const float OPEN_RAISE = 2.5; // and is scaled to what is missing of 1
const float CLOSES_ABOVE = 0.5;
const float CLOSE_SLACK = 4e-5;

// Emitters of more weight than this may have to be lowered for a row to close.
const float EMITTERS_MOVE_ABOVE = 0.9;

// After so many updates (and up to half as many more) a row goes first, whatever its bound.
const float OLDEST = 48.0;

// More than the rounding of the sum of a row's links.
const float SUM_SLACK = 1e-5;

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
	range others, emitters;           // B of the entries, before and afterwards; of the firm, that of their objects
	uint rays, entries;
};

// What a row has of one source object.
struct source_part {
	uint object;
	range others;   // B of its leaves that are no emitters
	vec3 brightest; // B of all of them
	bool emits;     // some of it
};

source_part load_source(uint object)
{
	uint root = object_nodes(object).x, flags = load_range(root).w;
	bool emits = (flags & GI_NODE_EMITTER) != 0u;
	vec3 b = load_radiosity(root).xyz;
	if ((object_bvh(object).z & GI_OBJECT_SKY) != 0u)
		return source_part(object, range(b, emits ? vec3(0.0) : b), b, emits);
	source_part from = source_part(object, NOTHING, vec3(0.0), emits);
	for (uint c = 0u; c < 3u; c++) {
		uint at = GI_SHINE_WORDS * object + c;
		from.others.most[c] = uintBitsToFloat(load_shine(at + GI_SHINE_OTHERS));
		from.brightest[c] = uintBitsToFloat(load_shine(at + GI_SHINE_ALL));
		from.others.least[c] = (flags & GI_NODE_BACK) != 0u ? 0.0 : uintBitsToFloat(~load_shine(at + GI_SHINE_LEAST));
	}
	return from;
}

void add_entry(inout sums s, source_part from, uint at, uvec4 e, bool touched, bool stays)
{
	uint taken = samples_of(e);
	float f = uintBitsToFloat(e.y), v = taken > 0u ? f * float(seen_of(e)) / float(taken) : 0.0;
	s.rays += touched ? max(taken, 1u) : 0u;
	s.entries += touched ? 1u : 0u;
	if (v == 0.0 && !(touched && stays))
		return;
	bool emitter = from.emits && (load_range(e.x).w & GI_NODE_EMITTER) != 0u;
	if (!touched) {
		s.firm_others += emitter ? 0.0 : v;
		s.firm_emitters += emitter ? v : 0.0;
		return;
	}
	vec3 mean = (e.w & GI_ENTRY_BACK) != 0u ? vec3(0.0) : load_radiosity(load_target(at)).xyz;
	range b = range(mean, mean);
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
void add_cut(inout sums s, source_part from, gi_node_geometry p, bool moved, uint count)
{
	bool sky = (object_bvh(from.object).z & GI_OBJECT_SKY) != 0u;
	float f = sky || (moved && !from.emits) ? 1.0 : reach(p, from.object);
	if (f == 0.0)
		return;
	range b = range(from.others.least, from.brightest);
	add(s.gained, f, b, from.emits);
	s.kept += f;
	include(s.others, from.others);
	if (from.emits)
		include(s.emitters, b);
	s.rays += count == 0u ? 1u : 0u;
	s.entries += count == 0u ? 1u : 0u;
}

sums sum_row(uint leaf, watch w)
{
	part none = part(0.0, 0.0, vec3(0.0), vec3(0.0));
	sums s = sums(0.0, 0.0, none, none, 0.0, NOTHING, NOTHING, 0u, 0u);
	gi_node_geometry p = load_world(load_leaf(leaf).x);
	for (uint source = 0u; source < frame.counts.z; source++) {
		uvec4 block = load_segment(leaf * frame.counts.z + source);
		uint count = block.y & GI_BLOCK_COUNT_MASK;
		bool cut = pair_is_dirty(w.mine, source, w.since);
		source_part from = load_source(source);
		float firm_others = s.firm_others, firm_emitters = s.firm_emitters;
		for (uint k = 0u; k < count; k++) {
			uvec4 e = load_entry(block.x + k);
			add_entry(s, from, block.x + k, e, cut || is_flagged(w, p, e), !cut);
		}
		if (s.firm_others > firm_others)
			include(s.others, from.others);
		if (s.firm_emitters > firm_emitters)
			include(s.emitters, range(from.others.least, from.brightest));
		if (cut)
			add_cut(s, from, p, w.moved, count);
	}
	return s;
}

// xyz: bound on what refreshing the row changes of H; w: on the share of its weight that moves.
vec4 bound_of(sums s, vec3 h)
{
	float firm = s.firm_others + s.firm_emitters, lost = weight_of(s.lost);
	float emitters = s.firm_emitters + s.lost.emitters + s.gained.emitters;
	vec3 darkest = min(s.others.least, s.emitters.least), dim = s.others.most, bright = max(dim, s.emitters.most);
	// Whatever the row becomes: weights of 1 in sum, of which emitters have no more than raised and scaled.
	vec3 most = min(dim + OPEN_RAISE * emitters * s.emitters.most, bright);
	vec3 rise_limit = max(most - h, vec3(0.0)) + SUM_SLACK * h, fall_limit = h * (1.0 + SUM_SLACK);
	if (firm < CLOSES_ABOVE)
		return vec4(max(rise_limit, fall_limit), 1.0);
	float lacked = abs(1.0 - firm - lost);
	// Touched entries are raised too: none more than doubles, together they gain no more than the row lacks.
	float raise_old = min((CLOSE_RAISE - 1.0) * lost, max(0.0, 1.0 - firm - lost));
	float raise_new = min((CLOSE_RAISE - 1.0) * s.kept, max(0.0, 1.0 - firm));
	float moved = min(1.0, max(lost, s.kept) + lacked + max(raise_old, raise_new) + CLOSE_SLACK);
	// Emitters are raised by what the others at their limits leave, and lowered when they alone nearly fill the row.
	float raised = min(emitters, max(0.0, 1.0 - CLOSE_RAISE * s.firm_others - s.firm_emitters));
	float lowered = emitters > EMITTERS_MOVE_ABOVE ? emitters : 0.0;
	vec3 dim_emitters = max(dim - s.emitters.least, vec3(0.0));
	vec3 either = lacked * max(dim - darkest, vec3(0.0)) + (raised + lowered) * (bright + dim_emitters) + CLOSE_SLACK * most;
	vec3 rise = s.gained.high - weight_of(s.gained) * darkest + s.lost.others * dim - s.lost.low +
		    s.lost.emitters * dim_emitters;
	vec3 fall = s.lost.high - lost * darkest + s.gained.others * dim - s.gained.low + s.gained.emitters * dim_emitters;
	return vec4(max(min(max(rise, 0.0) + either, rise_limit), min(max(fall, 0.0) + either, fall_limit)), moved);
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
	vec3 h = load_pending(leaf).bound.xyz;
	gi_pending row = gi_pending(uvec4(0u), vec4(0.0), load_pending(leaf).before);
	bool changed = false;
	for (uint k = frame.update.y; k < frame.update.z; k++)
		changed = changed || max(object_changed(load_suspect(k)).x, object_changed(load_suspect(k)).y) > w.since;
	if (changed) {
		sums s = sum_row(leaf, w);
		gi_material_data m = load_material(load_leaf(leaf).z);
		vec4 bound = bound_of(s, h);
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
