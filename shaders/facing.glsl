// How a source node lies to a receiver: whether any of its front can see any of the receiver's, and how squarely.

// Heights below this share of the distance are rounding: coplanar patches do not see each other. So are those below the
// second share of the coordinates: the patches may lie in one place, far from the origin.
const float HORIZON_SLACK = 1e-5;
const float POSITION_SLACK = 2.5e-7;

float sine_of(float cosine)
{
	return cosine >= 1.0 ? 0.0 : sqrt(max(0.0, 1.0 - cosine * cosine));
}

// A node's extent and normals. Normals that agree do not make a plane: squares one behind the other are as thick as
// they are apart.
struct shape {
	vec3 centre;
	vec3 axis;
	float cone;      // cosine of the half angle that its normals keep to about the axis; below 0: any direction
	float radius;
	float thickness; // over the radius (gi_shared.h)
};

shape shape_of(gi_node_geometry g, uint flags)
{
	float steps = float(flags >> GI_NODE_THICKNESS_SHIFT);
	return shape(g.sphere.xyz, g.axis.xyz, g.axis.w, g.sphere.w, steps / float(GI_NODE_THICKNESS_STEPS));
}

// How far a shape may reach from its centre along a direction at this angle to its axis: what two planes leave of its
// ball.
float reach_along(shape s, float cosine, float sine)
{
	return s.radius * (cosine <= s.thickness ? 1.0 : s.thickness * cosine + sine_of(s.thickness) * sine);
}

// The most that the way from any point of a to any of b goes along any of a's normals; `to` is that between the
// centres.
float most_along(shape a, shape b, vec3 to, float d)
{
	if (a.cone < 0.0)
		return d + a.radius + b.radius;
	float along = dot(a.axis, to), tilt = sine_of(a.cone);
	float across = sqrt(max(0.0, d * d - along * along));
	float between = along >= d * a.cone ? d : along * a.cone + across * tilt;
	// Of the normals that one farthest from b's axis, or in b's plane. The cosine between the axes of patches in
	// one place leaves nothing of their angle but its rounding.
	float cosine = abs(dot(a.axis, b.axis)), sine = length(cross(a.axis, b.axis));
	return between + reach_along(a, a.cone, tilt) +
	       reach_along(b, max(0.0, cosine * a.cone - sine * tilt), min(1.0, sine * a.cone + cosine * tilt));
}

struct facing {
	vec3 to;      // from the receiver's centre to the node's
	float d;      // its length
	float height; // the most that the node reaches above the receiver's plane
	float faced;  // the best that any normal of the node's cone faces any point of the receiver, times the distance
	bool unseen;
};

// Of a source with these flags for a receiver.
facing facing_of(shape receiver, gi_node_geometry g, uint flags)
{
	shape source = shape_of(g, flags);
	vec3 to = source.centre - receiver.centre;
	float d = length(to), slack = HORIZON_SLACK * (d + source.radius + receiver.radius) +
				      POSITION_SLACK * (length(source.centre) + length(receiver.centre));
	float height = most_along(receiver, source, to, d);
	float faced = source.cone < 0.0 ? d : most_along(source, receiver, -to, d);
	bool turned = faced <= slack;
	bool back = (flags & GI_NODE_BACK) != 0u;
	return facing(to, d, height, turned ? d : faced, height <= slack || (turned && !back));
}
