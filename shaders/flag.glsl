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

// Can a segment from within a ball about `origin` to within one about `origin + direction` meet the object's box? At
// share t of its way it is within the radius between the two, so each side of the box bounds t.
bool crosses_bounds(uint object, vec3 origin, vec3 direction, float radius, float end_radius)
{
	vec3 o = rest_from_world(object, origin);
	vec3 d = rest_direction_from_world(object, direction);
	vec3 lower = objects[object].lower.xyz, upper = objects[object].upper.xyz;
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
bool crosses_cone(uint object, vec3 x, float radius, vec3 axis, float spread)
{
	vec4 ball = objects[object].sphere;
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
};

watch watch_of(uint leaf)
{
	uint mine = leaves[leaf].y, since = rows[leaf].z;
	bool moved = moved_since(mine, since);
	return watch(mine, since, moved, moved ? uvec2(objects[mine].bvh.w, objects[mine].extra.x) : frame.update.yz);
}

bool may_cross(watch w, gi_node_geometry p, uint node)
{
	vec4 ball = world[node].sphere;
	bool sky = (topology[node].range.w & GI_NODE_SKY) != 0u;
	for (uint k = w.suspects.x; k < w.suspects.y; k++) {
		uint object = suspects[k];
		if (!w.moved && !moved_since(object, w.since))
			continue;
		bool crosses = sky ? crosses_cone(object, p.sphere.xyz, p.sphere.w, ball.xyz, ball.w)
				   : crosses_bounds(object, p.sphere.xyz, ball.xyz - p.sphere.xyz, p.sphere.w, ball.w);
		if (crosses)
			return true;
	}
	return false;
}

uint samples_of(uvec4 entry)
{
	return (entry.w >> GI_ENTRY_SAMPLE_SHIFT) & GI_ENTRY_SAMPLE_MASK;
}

// Of an entry whose pair need not be cut again; p is the leaf in the world.
bool is_flagged(watch w, gi_node_geometry p, uvec4 entry)
{
	if (samples_of(entry) == 0u)
		return false; // form factor zero
	uint visible = entry.z & 0xFFFFu, blocker = entry.z >> 16u;
	bool blocker_moved = blocker == GI_BLOCKER_MIXED ||
			     (blocker != GI_BLOCKER_NONE && (w.moved ? blocker != w.mine : moved_since(blocker, w.since)));
	return blocker_moved || (visible != 0u && may_cross(w, p, entry.x));
}
