// How a source node lies to a receiver: whether any of its front can see any of the receiver's, and how squarely.

// Heights below this share of the distance are rounding: coplanar patches do not see each other.
const float HORIZON_SLACK = 1e-5;

float sine_of(float cosine)
{
	return cosine >= 1.0 ? 0.0 : sqrt(max(0.0, 1.0 - cosine * cosine));
}

// How far a surface of radius r whose normals lie in a cone reaches along a direction: a flat one only by its tilt.
float reach_along(float r, float cosine, float cone)
{
	return r * (cone < 0.0 ? 1.0 : min(1.0, sine_of(abs(cosine)) + sine_of(cone)));
}

struct facing {
	vec3 to;      // from the receiver's centre to the node's
	float d;      // its length
	float height; // the most that the node reaches above the receiver's plane
	float faced;  // the best that any normal of the node's cone faces any point of the receiver, times the distance
	bool unseen;
};

facing facing_of(gi_node_geometry p, gi_node_geometry g, uint flags)
{
	vec3 to = g.sphere.xyz - p.sphere.xyz;
	float d2 = dot(to, to), d = sqrt(d2);
	float slack = HORIZON_SLACK * (d + g.sphere.w + p.sphere.w);
	float cosine = dot(p.axis.xyz, g.axis.xyz);
	float height = dot(p.axis.xyz, to) + reach_along(g.sphere.w, cosine, g.axis.w) + (d + p.sphere.w) * sine_of(p.axis.w);
	float faced = d;
	if (g.axis.w >= 0.0) {
		float away = -dot(g.axis.xyz, to);
		float across = sqrt(max(0.0, d2 - away * away));
		float tilted = away >= d * g.axis.w ? d : away * g.axis.w + across * sine_of(g.axis.w);
		faced = tilted + g.sphere.w * sine_of(g.axis.w) + reach_along(p.sphere.w, cosine, p.axis.w);
	}
	bool turned = faced <= slack;
	bool back = (flags & GI_NODE_BACK) != 0u;
	return facing(to, d, height, turned ? d : faced, height <= slack || (turned && !back));
}
