// What swept boxes (gi_shared.h) and others may have to do with a leaf. Conservative by more than rounding, of shapes
// and of where samples lie.

const float SWEPT_SLACK = 1e-4;

// The ball about a box.
vec4 ball_about(vec4 lower, vec4 upper)
{
	vec3 half_way = 0.5 * upper.xyz - 0.5 * lower.xyz;
	return vec4(lower.xyz + half_way, length(half_way) * (1.0 + SWEPT_SLACK));
}

// Does any of a ball reach before the leaf, whichever of the leaf's normals counts?
bool reaches_before(vec4 ball, gi_node_geometry leaf)
{
	vec3 to = ball.xyz - leaf.sphere.xyz;
	float d = length(to), along = dot(leaf.axis.xyz, to), cosine = leaf.axis.w;
	float tilt = sqrt(max(0.0, 1.0 - cosine * cosine)), across = sqrt(max(0.0, d * d - along * along));
	float between = cosine < 0.0 || along >= d * cosine ? d : along * cosine + across * tilt;
	float folded = cosine < 1.0 ? 2.0 * leaf.sphere.w : 0.0;
	return between + ball.w + folded > -SWEPT_SLACK * (d + ball.w + leaf.sphere.w);
}

// Can a ray from within the leaf's ball to a patch of sky, a direction and the chord to its edge, come into the ball?
// No sine is more than its chord.
bool cone_meets(vec4 ball, vec4 leaf, vec4 patch_of_sky)
{
	vec3 to = ball.xyz - leaf.xyz;
	float along = dot(to, patch_of_sky.xyz), d2 = dot(to, to), sine = patch_of_sky.w;
	float reach = ball.w + leaf.w + SWEPT_SLACK * (abs(to.x) + abs(to.y) + abs(to.z) + ball.w + leaf.w),
	      best = reach + along * sine;
	return sine >= 1.0 ||
	       (best >= 0.0 && along >= -reach && (d2 - along * along) * (1.0 - sine * sine) <= best * best);
}
