// Which entries between bodies at rest to each other may see differently now that something moved: those that a
// candidate hid, and visible ones whose segments may cross a candidate's new bounds. Conservative: what is not flagged
// would come out of the rays with the same bits.

// Every sample lies within this much more than the radii of its ends; covers rounding of a turn into the box's frame.
const float BOX_SLACK = 1e-4;

// Narrows the interval to where slope * t <= limit.
void keep_below(float slope, float limit, inout vec2 interval)
{
	float t = limit / slope;
	interval.y = slope > 0.0 ? min(interval.y, t) : slope == 0.0 && limit < 0.0 ? -1.0 : interval.y;
	interval.x = slope < 0.0 ? max(interval.x, t) : interval.x;
}

// What the test for crossings needs of an object, loaded once for all entries of a row: the loads are its price.
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

// How far a point lies below the upper sides of a box and above the lower ones, and rounding's share of that.
struct place {
	vec3 below, above;
	float slack;
};

place place_in(vec3 o, vec3 lower, vec3 upper)
{
	vec3 all = abs(o) + abs(upper - lower);
	return place(upper - o, o - lower, BOX_SLACK * (all.x + all.y + all.z));
}

// Can a segment from within a ball about a point to within one about the point and `direction`, in the box's frame,
// meet the box? At share t of its way it is within the radius between the two, so each side of the box bounds t.
bool crosses_box(place o, vec3 d, float radius, float end_radius)
{
	float grown = radius + o.slack + BOX_SLACK * (abs(d.x) + abs(d.y) + abs(d.z)), growth = end_radius - radius;
	vec2 interval = vec2(0.0, 1.0);
	for (int k = 0; k < 3; k++) {
		keep_below(d[k] - growth, o.below[k] + grown, interval);
		keep_below(-d[k] - growth, o.above[k] + grown, interval);
	}
	return interval.x <= interval.y;
}

place place_of(obstacle box, vec3 origin)
{
	return place_in(turned_into(box, origin - vec3(box.row0.w, box.row1.w, box.row2.w)), box.lower, box.upper);
}

// The candidates of a leaf's entries: the movers for a leaf at rest, its neighbours for one that moved.
struct watch {
	uint mine;     // the leaf's object
	uint since;    // the update that refreshed the row
	bool moved;    // the leaf moved since then
	bool statics;  // some static object changed since then
	uvec2 candidates;
	obstacle first; // of them: mostly there is no other
};

watch watch_of(uint leaf)
{
	uint mine = load_leaf(leaf).y, since = load_row(leaf).z;
	bool moved = moved_since(mine, since);
	uvec2 range = moved ? uvec2(object_bvh(mine).w, object_extra(mine).x) : frame.update.yz;
	uint object = range.x < range.y ? load_listed_object(range.x) : mine;
	bool statics = frame.swept.w != GI_NONE && moved_since(frame.swept.w, since);
	return watch(mine, since, moved, statics, range,
		     load_obstacle(object, range.x < range.y && (moved || moved_since(object, since))));
}

// Which objects hid an entry is not known; of static ones that is of no concern while they are what they were.
bool is_hidden_by_several(watch w, uint blocker)
{
	return blocker == GI_BLOCKER_MIXED || (blocker == GI_BLOCKER_STATICS && w.statics);
}

bool crosses(obstacle by, gi_node_geometry p, vec4 ball, bool sky)
{
	if (!by.counts)
		return false;
	return sky ? cone_meets(by.ball, p.sphere, ball)
		   : crosses_box(place_of(by, p.sphere.xyz), turned_into(by, ball.xyz - p.sphere.xyz), p.sphere.w,
				 ball.w);
}

bool may_cross(watch w, gi_node_geometry p, uint node)
{
	vec4 ball = world_sphere(node);
	bool sky = (topology_range(node).w & GI_NODE_SKY) != 0u;
	bool found = crosses(w.first, p, ball, sky);
	for (uint k = w.candidates.x + 1u; k < w.candidates.y && !found; k++)
		found = crosses(
		    load_obstacle(load_listed_object(k), w.moved || moved_since(load_listed_object(k), w.since)), p,
		    ball, sky);
	return found;
}

// Can something have hidden samples of the entry that was there when its row was refreshed, and is not there now?
bool was_crossed(watch w, gi_node_geometry p, uint node)
{
	vec4 ball = world_sphere(node);
	bool sky = (topology_range(node).w & GI_NODE_SKY) != 0u, found = false;
	for (uint k = 0u; k < frame.swept.y && !found; k++) {
		uvec4 change = load_swept_change(k);
		vec4 lower = load_swept_corner(k, 0u), upper = load_swept_corner(k, 1u);
		obstacle box =
		    obstacle(change.z != 0u && change.x > w.since, vec4(1.0, 0.0, 0.0, 0.0), vec4(0.0, 1.0, 0.0, 0.0),
			     vec4(0.0, 0.0, 1.0, 0.0), lower.xyz, upper.xyz, ball_about(lower, upper));
		found = crosses(box, p, ball, sky);
	}
	return found;
}

// Must an entry be traced again whose pair need not be cut again? p is the leaf in the world.
bool is_flagged(watch w, gi_node_geometry p, uvec4 entry)
{
	if (samples_of(entry) == 0u)
		return false; // form factor zero
	uint visible = entry.z & 0xFFFFu, blocker = entry.z >> 16u;
	bool blocker_moved = w.moved ? blocker != GI_BLOCKER_NONE && blocker != w.mine
				     : blocker < GI_BLOCKER_STATICS && moved_since(blocker, w.since);
	if (!w.moved && is_hidden_by_several(w, blocker))
		blocker_moved = was_crossed(w, p, entry.x);
	return blocker_moved || (visible != 0u && may_cross(w, p, entry.x));
}
