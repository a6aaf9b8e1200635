/* Structures and constants shared by the C side and the shaders; read by both compilers.
 *
 * Only vec4 and uvec4 members: their layout is the C layout, in storage blocks, in uniform blocks and as texels of
 * buffer textures, which buffers.glsl counts. gi/src/layout.c asserts how many there are.
 */
#ifndef GI_SHARED_H
#define GI_SHARED_H

#ifdef GL_core_profile
#define GI_VEC4 vec4
#define GI_UVEC4 uvec4
#define GI_STRUCT(name) struct name
#define GI_END(name) ;
#else
#include <stdint.h>
typedef struct gi_vec4 {
	float x, y, z, w;
} gi_vec4;
typedef struct gi_uvec4 {
	uint32_t x, y, z, w;
} gi_uvec4;
#define GI_VEC4 gi_vec4
#define GI_UVEC4 gi_uvec4
#define GI_STRUCT(name) typedef struct name
#define GI_END(name) name;
#endif

/* "No node, no vertex, no object." */
#define GI_NONE 0xFFFFFFFFu

/* Flags of a node (gi_node_topology.range.w). In bits 8..11, of an emitter: how much finer than others it is cut, as a
 * power of two (emitters.c). From bit 16 on how thick it is: how far its leaves reach from the plane through its sphere's
 * centre that its axis is normal to, over the radius, in 65535ths, rounded up; 0: all of it lies in that plane. */
#define GI_NODE_LEAF 1u     /* one leaf, no children */
#define GI_NODE_POLYGON 2u  /* has four corners; a cluster above the base faces only where a quad covers it */
#define GI_NODE_FLAT 4u     /* the corners' two triangles are exactly the surface of its leaves */
#define GI_NODE_EMITTER 8u  /* some leaf below it emits; set by the scene, not by the hierarchy */
#define GI_NODE_BACK 16u    /* its back can be seen from somewhere: the object is not a closed outward surface */
#define GI_NODE_SKY 32u     /* a patch at infinity: corners and sphere centre are directions */
#define GI_NODE_LAMP 64u    /* what it emits is drawn per pixel (lamp.c) and no part of the leaves' indirect light */
#define GI_NODE_TOP 128u    /* of several static objects (statics.h): in the world's frame, its two children behind it */
#define GI_NODE_SMOOTH 4096u   /* some leaf below it is a mirror or glass; set by the scene */
#define GI_NODE_FINER_SHIFT 8u
#define GI_NODE_FINER_MOST 15u
#define GI_NODE_THICKNESS_SHIFT 16u
#define GI_NODE_THICKNESS_STEPS 65535u

/* Where a node is. One copy in the object's rest frame, one in the world.
 *
 *   //--------------- 16B ---------------
 *   sphere.xyz bounding-sphere centre          sphere.w radius
 *   axis.xyz   unit mean normal                axis.w   cosine of the normal cone's half angle (-1: any direction)
 *   moment.xyz sum of area * normal of leaves  moment.w area
 */
GI_STRUCT(gi_node_geometry) {
	GI_VEC4 sphere;
	GI_VEC4 axis;
	GI_VEC4 moment;
} GI_END(gi_node_geometry)

/* How the normals of a node spread: what it shows to a direction, front sides alone, is
 *
 *     P(d) = (S(d) + moment . d) / 2,   S(d) = sum of area |n . d| = about shape * sqrt(area * d' T d),   T = sum of area n n'
 *
 * exact for a flat node (shape 1) and for normals all round (shape 0.866); in the rest frame.
 *
 *   //--------------- 16B ---------------
 *   diagonal.xyz T xx yy zz    diagonal.w 0
 *   mixed.xyz    T xy yz zx    mixed.w shape
 */
GI_STRUCT(gi_node_spread) {
	GI_VEC4 diagonal;
	GI_VEC4 mixed;
} GI_END(gi_node_spread)

/* What a node is. Nodes lie in depth-first order: the first child of node n is n + 1, the node after its subtree is
 * `skip`.
 *
 *   //--------------- 16B ---------------
 *   range.x skip    range.y first leaf    range.z leaf count    range.w GI_NODE_ flags and thickness
 *   corners: vertex numbers, counter-clockwise; GI_NONE for a cluster that no quad covers; a triangle repeats its third corner
 *   corners of a top: x its id, y the update that last changed it or something below it
 */
GI_STRUCT(gi_node_topology) {
	GI_UVEC4 range;
	GI_UVEC4 corners;
} GI_END(gi_node_topology)

/* The same as gi_bvh_node in one uvec4, as rays read it: bounds in sixteenths of a word on a grid over the whole tree's
 * box, rounded outward, one cell more; then the skip, or for a leaf GI_PACKED_LEAF and its primitive (its skip is the
 * next node).
 *
 *   x lower.x | lower.y << 16    y lower.z | upper.x << 16    z upper.y | upper.z << 16    w link
 */
#define GI_PACKED_LEAF 0x80000000u
#define GI_PACKED_CELLS 65535.0f

/* A node of an object's bounding volume hierarchy, depth-first with skip links: go to n + 1 when the box is hit, to
 * `skip` when not; no stack. In the object's rest frame.
 *
 *   //--------------- 16B ---------------
 *   lower.xyz    lower.w skip, as uint bits
 *   upper.xyz    upper.w primitive number when a leaf, else GI_NONE, as uint bits
 */
GI_STRUCT(gi_bvh_node) {
	GI_VEC4 lower;
	GI_VEC4 upper;
} GI_END(gi_bvh_node)

/* What rays meet: a quad, as the two triangles a b c and a c d, standing for leaves of its object, one after the other.
 *
 *   //--------------- 16B ---------------
 *   a.xyz  a.w first leaf, as uint bits
 *   b.xyz  b.w rank, as uint bits
 *   c.xyz  c.w |ab x ac|
 *   d.xyz  d.w |ac x ad|
 *
 * Every primitive of a scene has a rank of its own. Of two that lie in one place and look the same way the one of higher
 * rank is met.
 */
GI_STRUCT(gi_primitive) {
	GI_VEC4 a;
	GI_VEC4 b;
	GI_VEC4 c;
	GI_VEC4 d;
} GI_END(gi_primitive)

/* An object of the scene. Slots are dense; the sky, when there is one, is the last.
 *
 *   //--------------- 16B ---------------
 *   row0..row2  rows of the matrix world_from_object: rotation, then translation in w
 *   lower.xyz upper.xyz  bounds in the rest frame
 *   grid.xyz  where the grid of its packed BVH begins    cells.xyz  cells per metre
 *   sphere.xyz  centre of the world bounding sphere    sphere.w radius
 *   plane.xyz  normal of the world plane that all its surface lies in, plane.w  its height along it; 0: in no plane
 *   nodes.x root    nodes.y end node    nodes.z first leaf    nodes.w end leaf
 *   bvh.x root    bvh.y end    bvh.z GI_OBJECT_ flags    bvh.w first neighbour
 *   extra.x end neighbour    extra.y first vertex    extra.z end vertex    extra.w place among what was swept, from 1; 0: none
 *   changed.x update that last moved it    changed.y update that last lit or put it out
 *   ids.x added to the number of a leaf gives its id, ids.y likewise of a node
 *
 * Numbers are dense and change from commit to commit, ids never do. Samples are drawn by them.
 *
 * Neighbours are the objects whose boxes overlap its own, listed for movers only: they alone may have changed what its
 * entries see of itself.
 */
GI_STRUCT(gi_object_data) {
	GI_VEC4 row0;
	GI_VEC4 row1;
	GI_VEC4 row2;
	GI_VEC4 lower;
	GI_VEC4 upper;
	GI_VEC4 grid;
	GI_VEC4 cells;
	GI_VEC4 sphere;
	GI_VEC4 plane;
	GI_UVEC4 nodes;
	GI_UVEC4 bvh;
	GI_UVEC4 extra;
	GI_UVEC4 changed;
	GI_UVEC4 ids;
} GI_END(gi_object_data)

#define GI_OBJECT_SKY 2u
#define GI_OBJECT_FLAT 4u /* all its surface in one plane: it cannot hide itself */
#define GI_OBJECT_STATICS 16u /* no object: all static ones as one source */
#define GI_OBJECT_UNSEEN 8u /* hidden or destroyed: it keeps its place and takes part in nothing */

/* A leaf: x node, y object slot, z material, w rank of its primitive.
 * A material: rho, then exitance; exitance.w of a translucent object's is what is added to its number for the one that pixels
 * are lit by, which is black. */
GI_STRUCT(gi_material_data) {
	GI_VEC4 rho;
	GI_VEC4 exitance;
} GI_END(gi_material_data)

/* A run of threads: threads [first, first of the next) work on pair (object, other); offset is added to the thread's
 * number in the run. Runs are sorted by first; the last one ends at the dispatch's thread count.
 *   x first    y object    z other    w offset
 */

/* What one frame's dispatches need to know.
 *
 *   //--------------- 16B ---------------
 *   counts: leaves, nodes, object slots, vertices
 *   limits: entry pool, queue, most samples of a near leaf, of an emitter
 *   tolerance: form factor, of emitters, of sky patches, of the solve
 *   work: pose runs, pose threads, cut runs, cut threads
 *   grid, cells: of the packed TLAS, as of an object's
 *   misc: TLAS nodes, large nodes, light vertices, 1 where the sky shines
 *   update: its number, first and end of the movers in the lists of objects, GI_UPDATE_ flags
 *   inner: first and end of a second TLAS, of the objects that may lie between two others; slot of a sky that does not shine;
 *          1 where flagged entries are marked
 *   limit: x rays an update may take, y tolerance on what a waiting row may be off by, of the largest light reflected
 *   budget: first and end of the emitting objects in the lists of objects (first > end: too many for a list), rows that an
 *            update may assess, the newest update that moved, lit or put out an object
 *   ceiling: largest E / (1 - rho) of rgb, which no B exceeds; largest 1 / (1 - rho)
 *
 *   swept: in the lists of objects, in fours of words, where what was swept begins; how many; the first slot that is a source, and
 *          that of the static objects as one, GI_NONE: there is none
 *
 *   statics: primitives of static objects, which are the first ones; 1 where links through mirrors and glass may bring what
 *            something emits; 1 where rows may sum to more than 1 (specular_rows.h); 0
 *
 *   view_x, view_y, view_w: rows of the camera's matrix from the world to clip space, where GI_UPDATE_VIEWED
 *   view_eye: where it is; of a parallel projection the way to it, w 0
 *
 * Swept is, of each object that moved since some row was refreshed and of what went, GI_SWEPT_PARTS vec4:
 *   as uint bits: the update that saw it move; its slot, GI_NONE of what went; 1 where a box of where it was follows; 0
 *   lower corner of the world box of where it was
 *   upper corner
 *   lower corner of the world box of all that, and of where it is
 *   upper corner
 *
 * Movers are the objects that moved, were lit or put out since some row was refreshed.
 */
GI_STRUCT(gi_frame) {
	GI_UVEC4 counts;
	GI_UVEC4 limits;
	GI_VEC4 tolerance;
	GI_UVEC4 work;
	GI_UVEC4 misc;
	GI_VEC4 grid;
	GI_VEC4 cells;
	GI_UVEC4 update;
	GI_UVEC4 inner;
	GI_VEC4 limit;
	GI_UVEC4 budget;
	GI_VEC4 ceiling;
	GI_UVEC4 swept;
	GI_UVEC4 statics;
	GI_VEC4 view_x, view_y, view_w, view_eye;
} GI_END(gi_frame)

#define GI_SWEPT_PARTS 5u

#define GI_UPDATE_REBUILD 1u   /* every row from nothing */
#define GI_UPDATE_PART 2u      /* only the rows in the list of the chosen */
#define GI_UPDATE_TIMED 4u     /* no more than fits, however old rows become */
#define GI_UPDATE_MATERIAL 8u  /* some material has other values than in the solve before */
#define GI_UPDATE_VIEWED 16u    /* a camera says which rows count */
#define GI_UPDATE_BY_ROWS 32u    /* R / rho of some leaves is not what arrives: light scattered below surfaces */

/* A row under a budget (survey.comp, assess.comp).
 *
 *   //--------------- 16B ---------------
 *   key.x bucket of its priority, to be assessed or to be refreshed; 0: need not be
 *   key.y rays it takes    key.z dirty entries, or how many may be    key.w update that assessed it, 0: none that still holds
 *   bound.xyz bound on what refreshing it changes of its leaf's B, at the B before the solve
 *   bound.w   bound on the share of the row's weight that moves
 *   before.xyz B before the solve
 */
GI_STRUCT(gi_pending) {
	GI_UVEC4 key;
	GI_VEC4 bound;
	GI_VEC4 before;
} GI_END(gi_pending)

#define GI_BUCKETS 1024u
#define GI_BUCKETS_PER_OCTAVE 16u

/* Of an object under a budget, and behind the last one of the whole scene, words of three channels each as float bits: the
 * largest B of its leaves that emit nothing, the largest of all, the complement of the least. */
#define GI_LIGHT_BOUND_OTHERS 0u
#define GI_LIGHT_BOUND_ALL 3u
#define GI_LIGHT_BOUND_LEAST 6u
#define GI_LIGHT_BOUND_WORDS 9u

/* The buffer of choices: rays of the rows in each bucket, rows to assess in each bucket, the chosen leaves, those to assess. */
#define GI_CHOICE_ROWS GI_BUCKETS
#define GI_CHOICE_CHOSEN (2u * GI_BUCKETS)

/* An entry of a row, in the segment of its (leaf, source object) pair.
 *   x node
 *   y form factor, as float bits; GI_ENTRY_FLAGGED
 *   z visible samples as a mask in bits 0..15, GI_BLOCKER_ or slot of the object that hides the others in bits 16..31
 *   w leaf in bits 0..22, samples taken in bits 24..28, GI_ENTRY_GONE, GI_ENTRY_BACK and what the node is
 */
#define GI_ENTRY_LEAF_MASK 0x007FFFFFu
#define GI_ENTRY_SAMPLE_SHIFT 24u
#define GI_ENTRY_SAMPLE_MASK 0x1Fu
#define GI_ENTRY_FLAGGED 0x80000000u /* in y: it is queued to be retested; never set outside an update */
#define GI_ENTRY_EMITTER 0x00800000u
#define GI_ENTRY_EXACT 0x20000000u /* a polygon or a patch of sky, whose form factors are hardly off */
#define GI_ENTRY_BACK 0x80000000u
#define GI_ENTRY_GONE 0x40000000u /* its node was changed or went; x is the node whose B its link takes: to be cut anew */
#define GI_BLOCKER_STATICS 0xFFFDu /* static objects, one or several: nothing else changes that */
#define GI_BLOCKER_MIXED 0xFFFEu /* several objects */
#define GI_BLOCKER_NONE 0xFFFFu

/* Behind an entry's target, the node whose B it takes: what is there neither emits nor reflects. */
#define GI_TARGET_BLACK 0x80000000u

/* A link, what the solve multiplies: x node, y weight as float bits. A row's first ones may be light through mirrors and glass
 * (specular_path.comp), each in the place of two: x the node where its path ended and these bits, y z w a weight for each channel. */
#define GI_LINK_SPECULAR 0x80000000u
#define GI_LINK_PHOTONS 0x40000000u /* what the node emits comes by photons (caustics.c): the link has what it reflects */
#define GI_LINK_NODE 0x3FFFFFFFu

/* A segment, the cut of one object in one row: x and y a block of entries; as float bits (close.comp) z the share of its
 * samples that see their object, w the sum of the form factors of entries that are no backs.
 *
 * Where no sample sees the object, z is GI_SEGMENT_FACE and the number of a primitive that may hide it (covered.comp), GI_SEGMENT_NO_FACE or
 * more: none was found, or none looked for.
 *
 * A block of a pool: x offset, y count in bits 0..23, size class in bits 24..31 (255: no block). Class c holds 4 << c.
 */
#define GI_SEGMENT_FACE 0x80000000u
#define GI_SEGMENT_NO_FACE 0x007FFFFFu
#define GI_SEGMENT_UNKNOWN 0xFF000000u /* all of z, GI_SEGMENT_FACE too; rows of nothing have it, and as a float it is below 0 */
#define GI_BLOCK_COUNT_MASK 0x00FFFFFFu
#define GI_BLOCK_NO_CLASS 255u
#define GI_BLOCK_CLASSES 22u
#define GI_BLOCK_SMALLEST 4u

/* Row header of a leaf: x link offset, y count and class as a block, z update that last
 * refreshed it, w row sum bits, and GI_ROW_OPEN. */
#define GI_ROW_OPEN 0x80000000u /* it lost what it saw of an object that went: it is to be closed again */

/* Where an object of the scene before a commit is now (renumber.comp).
 *
 *   //--------------- 16B ---------------
 *   before.x first leaf    before.y end leaf    before.z first node    before.w end node
 *   now.x slot, GI_NONE: it went    now.y added to leaves    now.z added to nodes    now.w 0
 *
 * And where each node is now, a word each: GI_NONE: it went, or is a top that changed.
 */
GI_STRUCT(gi_move) {
	GI_UVEC4 before;
	GI_UVEC4 now;
} GI_END(gi_move)

/* What the GPU counts and decides; the head of the state buffer, copied out as the frame's report. Unsigned words;
 * *_BITS are floats >= 0, whose bits order as the floats do, so that atomicMax works on them. */
#define GI_STATE_NEW 0u            /* queue entries cut anew */
#define GI_STATE_QUEUED 1u         /* the same plus flagged ones */
#define GI_STATE_RAYS 2u
#define GI_STATE_DIRTY_ROWS 3u
#define GI_STATE_OVERFLOW 4u       /* a pool or the queue was full */
#define GI_STATE_ENTRIES 5u        /* in all rows; kept over frames */
#define GI_STATE_LINKS 6u          /* likewise */
#define GI_STATE_NOT_FINITE 7u
#define GI_STATE_SWEEPS 8u
#define GI_STATE_VERDICT 9u        /* GI_SOLVE_ */
/* What the solve remembers from sweep to sweep, and from frame to frame while nothing moves (check.comp). */
#define GI_STATE_OMEGA_BITS 10u    /* of the next sweep (gather.glsl); 1 is Jacobi */
#define GI_STATE_REACH_BITS 11u    /* amplification Chebyshev is set up for; 0 before it is */
#define GI_STATE_ELLIPSE 12u       /* how often its ellipse was widened; kept over frames */
#define GI_STATE_WINDOW 13u        /* sweeps since the progress was last judged */
#define GI_STATE_WINDOW_BITS 14u   /* the residual then */
#define GI_STATE_SEEN_BITS 15u     /* amplification as of the sweep before, over whatever rows */
#define GI_STATE_AMPLIFICATION_BITS 16u /* least that any sweep over these rows saw */
#define GI_STATE_JACOBI_SWEEPS 17u /* those Jacobi would take for this frame, as last foretold */
#define GI_STATE_ROUNDING_BITS 18u
#define GI_STATE_BOUND_BITS 19u    /* largest of rgb */
#define GI_STATE_BOUND_RELATIVE_BITS 20u
#define GI_STATE_DONE_RESIDUAL_BITS 21u /* largest of rgb, of the last sweep */
#define GI_STATE_DONE_Q_BITS 22u
#define GI_STATE_DONE_B_MAX_BITS 23u
/* Group counts for indirect dispatches, 3 words each. */
#define GI_STATE_ARGS_FACTOR 24u
#define GI_STATE_ARGS_TRACE 27u
#define GI_STATE_ARGS_GATHER 30u
#define GI_STATE_ARGS_HAND_OVER 33u
#define GI_STATE_ARGS_CHECK 39u
#define GI_STATE_ARGS_RECYCLE 42u
#define GI_STATE_ARGS_DOUBLE 45u
/* What the sweep now running found: largest values, then least ones (gather.glsl). */
#define GI_STATE_RESIDUAL_BITS 48u
#define GI_STATE_R_MAX_BITS 49u    /* 3: rgb, largest reflected light */
#define GI_STATE_B_MAX_BITS 52u
#define GI_STATE_V_MAX_BITS 53u
#define GI_STATE_WRITE_BITS 54u    /* how far R as stored is from T R, and B from E + R */
#define GI_STATE_STRAY_BITS 55u    /* the same, of the light that the leaf reflects */
#define GI_STATE_KAPPA_BITS 56u    /* residual over M u */
#define GI_STATE_SPREAD_BITS 57u   /* (I - M) u, of the light that the leaf reflects */
#define GI_STATE_NOISE_BITS 58u    /* what rounding alone can leave of the residual, over M u */
#define GI_STATE_GAP_BITS 59u      /* 1 - rho * row sum */
#define GI_STATE_DESCENT_BITS 60u  /* (M v)_i */
#define GI_STATE_LARGEST 11u       /* words of largest values, from GI_STATE_RESIDUAL_BITS on */
#define GI_STATE_LEAST 2u          /* words of least values, from GI_STATE_GAP_BITS on */
/* How the next one goes. */
#define GI_STATE_MANNER 61u        /* GI_MANNER_ */
#define GI_STATE_ACTION 62u        /* GI_ACTION_ bits: what the next gather does besides, or instead */
#define GI_STATE_KEPT_BITS 63u     /* residual of the R that was kept, by the sweep that kept it */
#define GI_STATE_FAILINGS 64u      /* how often Chebyshev failed in this solve */
#define GI_STATE_THETA_BITS 65u    /* u = R + sqrt(scale R) + theta * scale * v */
#define GI_STATE_SCALE_BITS 66u    /* 3: largest reflected light before it; kept over frames */
#define GI_STATE_DIRECT_BITS 69u   /* 3: largest light first reflected (emitted.comp) */
#define GI_STATE_CEILING_BITS 72u  /* 3: no reflected light is more */
#define GI_STATE_START 75u         /* GI_START_ */
/* How the start that weigh.comp found compares with the best multiple of 1. */
#define GI_STATE_WARM_MEAN_BITS 76u /* 3: mean flux of its residual, W/m2 */
#define GI_STATE_WARM_MOST_BITS 79u /* 3: largest residual */
#define GI_STATE_COLD_MEAN_BITS 82u /* 3: the same of the multiple of 1 */
#define GI_STATE_FACTOR_BITS 85u   /* 4: what becomes of R and v of before */
#define GI_STATE_RECALLS 89u       /* how often in this frame a kept R came back, each in the place of a sweep */
#define GI_STATE_LIFT_BITS 90u     /* 3: how much of v is added to R */
#define GI_STATE_BASE_BITS 93u     /* 3: and of 1 */
#define GI_STATE_COLD_MOST_BITS 96u /* 3: largest residual of the multiple of 1 */
/* Rows under a budget. */
#define GI_STATE_WAITING_ROWS 111u    /* not refreshed although something of them may have changed */
#define GI_STATE_WAITING_ENTRIES 112u /* their dirty entries */
#define GI_STATE_LATE_ROWS 113u       /* those of them that wait for lack of budget alone */
#define GI_STATE_STALE_BITS 114u      /* largest bound on what a waiting row is off by */
#define GI_STATE_STEP_BITS 115u       /* largest |B - B before the solve| */
#define GI_STATE_CHOSEN 116u          /* rows to refresh */
#define GI_STATE_THRESHOLD 117u       /* lowest bucket that is refreshed */
#define GI_STATE_ARGS_CHOSEN 118u     /* group counts, 3 words: a thread a chosen row */
#define GI_STATE_ARGS_PAIRS 121u      /* 3 words: a thread a chosen row and object */
#define GI_STATE_ASSESSED 106u        /* rows to assess */
#define GI_STATE_ASSESS_THRESHOLD 107u /* lowest bucket that is assessed */
#define GI_STATE_ARGS_ASSESS 108u     /* 3 words: some threads a row to assess */
#define GI_STATE_CHOSEN_RAYS 124u     /* those that chosen rows are thought to take */
#define GI_STATE_CHANGED_ROWS 128u    /* rows to close */
#define GI_STATE_ARGS_CLOSE 129u      /* 3 words: a thread each */
#define GI_STATE_CONCERNED_ROWS 101u  /* rows to look at for entries to flag */
#define GI_STATE_ARGS_FLAG 125u       /* 3 words: a thread each */
/* What the estimate's leaves say (estimate_mean.comp); as float bits but for the last. */
#define GI_STATE_ESTIMATE_SQUARED 103u /* area mean of |H error|^2, (W/m2)^2; below 0 where noise hides it */
#define GI_STATE_ESTIMATE_POWER 104u   /* area mean of |H|^2 */
#define GI_STATE_ESTIMATE_RAYS 105u
#define GI_STATE_ESTIMATE_LOCAL 102u   /* area mean of |H error|^2 over each leaf's own |H|^2, as float bits too */
#define GI_STATE_SPECULAR_PATHS 100u   /* entries that see a mirror or glass, to be followed */
#define GI_STATE_ARGS_SPECULAR 36u     /* group counts, 3 words: a thread each */
#define GI_STATE_WANTED 99u            /* how many smallest blocks a pool that was full lacked */
#define GI_STATE_WORDS 132u

/* GI_STATE_VERDICT. */
#define GI_SOLVE_CONVERGED 0u
#define GI_SOLVE_GOES_ON 1u
#define GI_SOLVE_ROUNDING 2u       /* more sweeps in single precision bring nothing */

/* GI_STATE_MANNER. */
#define GI_MANNER_JACOBI 0u
#define GI_MANNER_CHEBYSHEV 1u
#define GI_MANNER_POLISH 2u        /* near to what rounding leaves: damped sweeps take its noise away */
#define GI_MANNER_GIVEN_UP 3u      /* no ellipse did for these rows: Jacobi to the end */

/* GI_STATE_ACTION. */
#define GI_ACTION_KEEP 1u          /* a sweep, which keeps the R it begins with */
#define GI_ACTION_RECALL 2u        /* no sweep: the R that was kept comes back */
#define GI_ACTION_SCALE 4u         /* no sweep: what the last sweep makes of the start that weigh.comp found */
#define GI_ACTION_COLD 8u          /* no sweep: R is the light first reflected, v is 1 */

/* GI_STATE_START: what the sweep to come, or just done, begins the solve with; weigh.comp looks at it. */
#define GI_START_NONE 0u           /* it begins none */
#define GI_START_WARM 1u           /* R of before */
#define GI_START_COLD 2u           /* the light first reflected */

/* The buffer of leaf radiosity, a part after the other, each a vec4 per leaf; that of node radiosity, a vec4 per node. */
#define GI_LEAF_B 0u               /* B, W/m2; w: what its row sums to less than 1 */
#define GI_LEAF_R 1u               /* R = B - E, v */
#define GI_LEAF_BEFORE 2u          /* R, v before the last sweep */
#define GI_LEAF_KEPT 3u            /* R, v to come back to */
#define GI_LEAF_EMITTED 4u         /* irradiance by exitance; w: 0 */
#define GI_LEAF_UNDRAWN 5u         /* that of it which is not drawn per pixel; w: area, m2 */
#define GI_LEAF_PARTS 6u
#define GI_NODE_B 0u
#define GI_NODE_R 1u
#define GI_NODE_PARTS 2u

/* What is dark: light reflected below this share of the largest. Errors count relative to the light there or, where it is
 * less, to this. */
#define GI_DARK_SHARE 1e-5f

/* Words a leaf of GI_BIND_TOUCHED (touched.glsl). */
#define GI_TOUCHED_PARTS 4u

/* An allocator: bump pointer, pending count, then free counts per class; its lists are in the buffer behind it. */
#define GI_POOL_BUMP 0u
#define GI_POOL_PENDING 1u
#define GI_POOL_LIMIT 2u           /* elements */
#define GI_POOL_LIST 3u            /* where the free lists begin, in words */
#define GI_POOL_FREE 4u            /* GI_BLOCK_CLASSES signed counts */
#define GI_POOL_PENDING_LIST 32u   /* GI_POOL_PENDING_MAX pairs: offset, class */
#define GI_POOL_PENDING_MAX 131072u

/* A buffer is bound as a storage block at its number and as a texture at unit GI_TEXEL_UNIT + number; the frame as a uniform block. */
#define GI_TEXEL_UNIT 4
#define GI_BIND_COUNT 37

#define GI_BIND_FRAME 0
#define GI_BIND_OBJECTS 1
#define GI_BIND_TOPOLOGY 2
#define GI_BIND_REST 3
#define GI_BIND_WORLD 4
#define GI_BIND_VERTICES_REST 5
#define GI_BIND_VERTICES_WORLD 6
#define GI_BIND_LEAVES 7
#define GI_BIND_MATERIALS 8
#define GI_BIND_BVH 9
#define GI_BIND_PRIMITIVES 10
#define GI_BIND_TLAS 11
#define GI_BIND_SEGMENTS 12
#define GI_BIND_ENTRIES 13
#define GI_BIND_ENTRY_POOL 14
#define GI_BIND_QUEUE 15
#define GI_BIND_ROWS 16
#define GI_BIND_LINKS 17
#define GI_BIND_LINK_POOL 18
#define GI_BIND_RADIOSITY 19       /* GI_NODE_PARTS: area means of leaves */
#define GI_BIND_LEAF_RADIOSITY 20  /* GI_LEAF_PARTS */
#define GI_BIND_NODE_EXITANCE 21   /* vec4 per node: area mean of E */
#define GI_BIND_STATE 22
#define GI_BIND_RUNS 23            /* uvec4: pose runs, then cut runs */
#define GI_BIND_OBJECT_LISTS 24        /* uint: the movers, each mover's neighbours, the emitting objects; what was swept */
#define GI_BIND_LARGE_NODES 25      /* nodes of more than GI_LARGE_NODE_LEAVES leaves */
#define GI_BIND_LEAF_INDIRECT 26   /* vec4 per leaf */
#define GI_BIND_LIGHT_LINKS 27     /* uvec2 per (light vertex, leaf): leaf, weight bits */
#define GI_BIND_LIGHT_FIRST 28     /* uint per light vertex, plus one */
#define GI_BIND_LIGHT 29           /* vec4 per light vertex */
#define GI_BIND_TOUCHED 30         /* GI_TOUCHED_PARTS uint per leaf (touched.glsl) */
#define GI_BIND_SPREAD 31
#define GI_BIND_CHOICES 32         /* uint: GI_CHOICE_ */
#define GI_BIND_PENDING 33         /* gi_pending per leaf */
#define GI_BIND_LIGHT_BOUNDS 34           /* GI_LIGHT_BOUND_WORDS uint per object slot, and for all */
#define GI_BIND_TARGETS 35         /* uint per entry: the node whose B it takes (trace.glsl), GI_TARGET_BLACK */
#define GI_BIND_LEAF_QUADS 36      /* four vec4 per leaf: its corners at rest; in the first one's w the area of its object up to and with it */

/* A commit's own (renumber.comp): the rows of before, and what became of objects. */
#define GI_BIND_OLD_SEGMENTS GI_BIND_LARGE_NODES
#define GI_BIND_OLD_ROWS GI_BIND_LIGHT_LINKS
#define GI_BIND_MOVES GI_BIND_RUNS             /* gi_move per object slot before */
#define GI_BIND_NODE_MOVES GI_BIND_OBJECT_LISTS    /* uint per node before */

/* Rows that are lent (lend.comp): uvec2, the leaf and the one that lends. */
#define GI_BIND_LOANS GI_BIND_LARGE_NODES

/* Path tracing (paths.comp) reads no rows: it takes numbers of theirs, which every update binds again. */
#define GI_BIND_PATH_SLOTS GI_BIND_SEGMENTS    /* gi_path_slot per thread */
#define GI_BIND_PATH_GOING GI_BIND_QUEUE       /* uint: 1 while a slot has a vertex to go */
#define GI_BIND_PATH_LIGHTS GI_BIND_ENTRIES    /* 3 uvec4 per emitting triangle, in the world */
#define GI_BIND_PATH_SOBOL GI_BIND_ENTRY_POOL  /* GI_SOBOL_DIMENSIONS * 32 direction numbers, bits reversed */

/* An emitting triangle: its corners as float bits, and in the fourth words
 *   0 top of its slice of the 32-bit line, inclusive: slices are as wide as triangles are powerful    1 material    2 a leaf of its primitive */
#define GI_SOBOL_DIMENSIONS 7u

/* Where a thread's paths are between two dispatches.
 *
 *   //--------------- 16B ---------------
 *   origin.xyz  the vertex, lifted off its surface   origin.w  its path's number, a whole number below 2^24
 *   normal.xyz  there                                normal.w  its number along the path
 *   throughput.xyz                                   throughput.w 1: at a mirror or glass, normal is the direction it goes on in
 *   found.xyz   irradiance that the path found so far found.w 0
 *   sum.xyz     that of the slot's paths before it   sum.w 0
 */
GI_STRUCT(gi_path_slot) {
	GI_VEC4 origin;
	GI_VEC4 normal;
	GI_VEC4 throughput;
	GI_VEC4 found;
	GI_VEC4 sum;
} GI_END(gi_path_slot)

/* Mirrors and glass, of scenes that have any (specular.c, caustics.c): in places of what their dispatches do not read. */
#define GI_BIND_SMOOTH GI_BIND_SPREAD            /* uvec4 per primitive: normals at its corners (smooth.h) */
#define GI_BIND_SMOOTH_MATERIALS GI_BIND_CHOICES /* gi_smooth_material per material */
#define GI_BIND_CORNER_LIGHTS GI_BIND_ROWS       /* uvec4 per leaf: the light vertices at its corners */
#define GI_BIND_PHOTONS GI_BIND_PENDING          /* gi_photon, those of a pair one after the other */
#define GI_BIND_CAUSTIC_PAIRS GI_BIND_LIGHT_BOUNDS      /* gi_caustic_pair */
#define GI_BIND_CAUSTIC_PATHS GI_BIND_ENTRY_POOL /* GI_CAUSTIC_PATH_WORDS uint per pair */
#define GI_BIND_CAUSTIC_SUMS GI_BIND_LINK_POOL   /* 3 uint per leaf: flux in steps of gi_caustic_pair.power.w */
#define GI_BIND_CAUSTIC_LIGHT GI_BIND_QUEUE      /* vec4 per leaf: irradiance through mirrors and glass, W/m2 */
#define GI_BIND_SPECULAR_ENDS GI_BIND_PENDING    /* uvec2 per entry that sees a mirror or glass: as x of a link through it, and what of the
						  * light arrives, ten bits a channel; of this update alone */
#define GI_BIND_CAUSTIC_CELLS GI_BIND_TARGETS    /* uint: photons per cell of a hashed grid, level by level */

/* Translucent objects, of scenes that have any (diffusion.c): in places of what a solve does not read. Rows: those of leaves, of
 * small clusters, of large ones; x first link, y links, of a leaf z its number. */
#define GI_BIND_DIFFUSION_ROWS GI_BIND_SPREAD    /* uvec4 per value */
#define GI_BIND_DIFFUSION_LINKS GI_BIND_CHOICES  /* uvec4: value, bits of three weights (subsurface.h) */
#define GI_BIND_DIFFUSION_VALUES GI_BIND_PENDING /* vec4 per value: what enters there, W/m2; the same of v */

/* The smooth part of a material: specular, and in w the index of refraction; transmittance. */
GI_STRUCT(gi_smooth_material) {
	GI_VEC4 specular;
	GI_VEC4 transmittance;
} GI_END(gi_smooth_material)

/* An emitting object and a mirror or glass object.
 *
 *   //--------------- 16B ---------------
 *   sphere       bounding sphere of the smooth object, world
 *   power.x      of the emitter, the largest channel, W    power.y 0
 *   power.z      1 where all of it is to be traced anew    power.w W that one step of the sums is worth
 *   lights.x     first of the emitter's triangles          lights.y their end
 *   lights.z     slot of the emitter                       lights.w slot of the smooth object
 */
GI_STRUCT(gi_caustic_pair) {
	GI_VEC4 sphere;
	GI_VEC4 power;
	GI_UVEC4 lights;
} GI_END(gi_caustic_pair)

/* Of a pair: the box of all its paths, lower and upper corner as ordered words; how many photons were there before this update, and
 * how many are now: the first ones. */
#define GI_CAUSTIC_BEFORE 6u
#define GI_CAUSTIC_NOW 7u
#define GI_CAUSTIC_PATH_WORDS 8u

/* Where a photon arrived.
 *
 *   //--------------- 16B ---------------
 *   place.xyz world position    place.w leaf, as uint bits; GI_NONE: it was absorbed, or lost
 *   flux.rgb  W, were it the only one of its pair    flux.w  radius that it is drawn with, metres
 */
GI_STRUCT(gi_photon) {
	GI_VEC4 place;
	GI_VEC4 flux;
} GI_END(gi_photon)

#define GI_CAUSTIC_LEVELS 8u      /* of the grid, each twice as coarse as the one before */
#define GI_CAUSTIC_CELLS 65536u   /* of a level */

/* The estimate's own, in places whose owners its dispatches do not read; rows_bind and scene_bind bring those back. */
#define GI_BIND_ESTIMATE_ITEMS GI_BIND_RUNS          /* uvec4 per item: an entry between a point of a leaf and a leaf */
#define GI_BIND_ESTIMATE_SHARES GI_BIND_OBJECT_LISTS     /* float per item: what its F V counts */
#define GI_BIND_ESTIMATE_CHANCES GI_BIND_LARGE_NODES  /* vec2 per leaf: end of its part of [0,1], the part */
#define GI_BIND_ESTIMATE_RESULTS GI_BIND_LIGHT_LINKS /* gi_estimate_leaf per chosen leaf */

/* A chosen leaf has this many items in all, in independent groups. */
#define GI_ESTIMATE_ITEMS 512u
#define GI_ESTIMATE_GROUPS 4u
#define GI_ESTIMATE_GROUP_ITEMS (GI_ESTIMATE_ITEMS / GI_ESTIMATE_GROUPS)

/* A leaf that the estimate looked at.
 *
 *   //--------------- 16B ---------------
 *   light.xyz H by its row    light.w 1 where the row is closed
 *   error.x area share over chance    error.y |H error|^2    error.z rays, as uint bits    error.w leaf, as uint bits
 *   bias.xyz H's error, with the noise of the samples    bias.w part of H that is reflected and arrives again
 */
GI_STRUCT(gi_estimate_leaf) {
	GI_VEC4 light;
	GI_VEC4 error;
	GI_VEC4 bias;
} GI_END(gi_estimate_leaf)

#define GI_LARGE_NODE_LEAVES 64u

#endif
