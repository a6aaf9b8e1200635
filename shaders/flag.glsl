// Which entries between bodies at rest to each other may see differently now that something moved: those that a suspect
// hid, and visible ones whose segments may cross a suspect's new bounds. Conservative: what is not flagged would come
// out of the rays with the same bits.

// Every sample lies within this much more than the radii of its ends; covers rounding of a turn into the box's frame.
const float BOX_SLACK = 1e-4;

// Narrows the interval to where slope * t <= limit.
void keep_below(float slope, float limit, inout vec2 interval)
{
	if (slope > 0.0)
		interval.y = min(interval.y, limit / slope);
	else if (slope < 0.0)
		interval.x = max(interval.x, limit / slope);
	else if (limit < 0.0)
		interval.y = -1.0;
}

// What crossings ask of an object, loaded once for all entries of a row: loads are what they cost.
struct obstacle {
	bool counts;              // it moved since the row was refreshed, and is there
	vec4 row0, row1, row2;    // world_from_object
	vec3 lower, upper;
	vec4 ball;
};

obstacle load_obstacle(uint object, bool counts)
{
	counts = counts && (object_bvh(object).z & GI_OBJECT_UNSEEN) == 0u;
	return obstacle(counts, object_row0(object), object_row1(object), object_row2(object), object_lower(object).xyz,
			object_upper(object).xyz, object_sphere(object));
}

vec3 turned_into(obstacle o, vec3 d)
{
	return o.row0.xyz * d.x + o.row1.xyz * d.y + o.row2.xyz * d.z;
}

// Can a segment from within a ball about `origin` to within one about `origin + direction` meet the object's box? At
// share t of its way it is within the radius between the two, so each side of the box bounds t.
bool crosses_bounds(obstacle box, vec3 origin, vec3 direction, float radius, float end_radius)
{
	vec3 o = turned_into(box, origin - vec3(box.row0.w, box.row1.w, box.row2.w));
	vec3 d = turned_into(box, direction), lower = box.lower, upper = box.upper;
	float slack = BOX_SLACK * (length(o) + length(d) + length(upper - lower));
	float grown = radius + slack, growth = end_radius - radius;
	vec2 interval = vec2(0.0, 1.0);
	for (int k = 0; k < 3; k++) {
		keep_below(d[k] - growth, upper[k] - o[k] + grown, interval);
		keep_below(-d[k] - growth, o[k] - lower[k] + grown, interval);
	}
	return interval.x <= interval.y;
}

// Can the cone of directions about `axis` (half the chord of its edge: `spread`) from a ball about x meet the object's
// sphere?
bool crosses_cone(vec4 ball, vec3 x, float radius, vec3 axis, float spread)
{
	vec3 to = ball.xyz - x;
	float d = length(to), r = (ball.w + radius) * (1.0 + BOX_SLACK);
	if (d <= r)
		return true;
	float angle = acos(clamp(dot(to, axis) / d, -1.0, 1.0));
	return angle <= asin(min(1.0, r / d)) + 2.0 * asin(min(1.0, 0.5 * spread)) + BOX_SLACK;
}

// The suspects of a leaf's entries: the movers for a leaf at rest, its neighbours for one that moved.
struct watch {
	uint mine;     // the leaf's object
	uint since;    // the update that refreshed the row
	bool moved;    // the leaf moved since then
	uvec2 suspects;
	obstacle first; // of them: mostly there is no other
};

watch watch_of(uint leaf)
{
	uint mine = load_leaf(leaf).y, since = load_row(leaf).z;
	bool moved = moved_since(mine, since);
	uvec2 range = moved ? uvec2(object_bvh(mine).w, object_extra(mine).x) : frame.update.yz;
	uint object = range.x < range.y ? load_suspect(range.x) : mine;
	return watch(mine, since, moved, range, load_obstacle(object, range.x < range.y && (moved || moved_since(object, since))));
}

bool crosses(obstacle by, gi_node_geometry p, vec4 ball, bool sky)
{
	if (!by.counts)
		return false;
	return sky ? crosses_cone(by.ball, p.sphere.xyz, p.sphere.w, ball.xyz, ball.w)
		   : crosses_bounds(by, p.sphere.xyz, ball.xyz - p.sphere.xyz, p.sphere.w, ball.w);
}

bool may_cross(watch w, gi_node_geometry p, uint node)
{
	vec4 ball = load_sphere(node);
	bool sky = (load_range(node).w & GI_NODE_SKY) != 0u;
	bool found = crosses(w.first, p, ball, sky);
	for (uint k = w.suspects.x + 1u; k < w.suspects.y && !found; k++)
		found = crosses(load_obstacle(load_suspect(k), w.moved || moved_since(load_suspect(k), w.since)), p, ball, sky);
	return found;
}

// Can something have hidden samples of the entry that was there when its row was refreshed, and is not there now?
bool was_crossed(watch w, gi_node_geometry p, uint node)
{
	vec4 ball = load_sphere(node);
	bool sky = (load_range(node).w & GI_NODE_SKY) != 0u, found = false;
	for (uint k = 0u; k < frame.trails.y && !found; k++) {
		vec4 lower = load_trail(k, 0u), upper = load_trail(k, 1u);
		vec3 half_way = 0.5 * upper.xyz - 0.5 * lower.xyz;
		obstacle box = obstacle(floatBitsToUint(lower.w) > w.since, vec4(1.0, 0.0, 0.0, 0.0), vec4(0.0, 1.0, 0.0, 0.0),
					vec4(0.0, 0.0, 1.0, 0.0), lower.xyz, upper.xyz, vec4(lower.xyz + half_way, length(half_way)));
		found = crosses(box, p, ball, sky);
	}
	return found;
}

// Of an entry whose pair need not be cut again; p is the leaf in the world.
bool is_flagged(watch w, gi_node_geometry p, uvec4 entry)
{
	if (samples_of(entry) == 0u)
		return false; // form factor zero
	uint visible = entry.z & 0xFFFFu, blocker = entry.z >> 16u;
	bool blocker_moved = blocker != GI_BLOCKER_NONE && blocker != GI_BLOCKER_MIXED &&
			     (w.moved ? blocker != w.mine : moved_since(blocker, w.since));
	// Which ones hid it is not known.
	if (blocker == GI_BLOCKER_MIXED)
		blocker_moved = w.moved || was_crossed(w, p, entry.x);
	return blocker_moved || (visible != 0u && may_cross(w, p, entry.x));
}
