/* Structures and constants shared by the C side and the shaders; read by both compilers.
 *
 * Only vec4 and uvec4 members, and in gi_state parts of whole vec4: their layout is the C layout, in storage blocks, in
 * uniform blocks and as texels of buffer textures, which buffers.glsl counts. gi/src/layout.c asserts how many there
 * are.
 */
#ifndef GI_SHARED_H
#define GI_SHARED_H

#ifdef GL_core_profile
#include "buffer_numbers.glsl"
#define GI_VEC4 vec4
#define GI_UVEC4 uvec4
#define GI_UINT uint
#define GI_FLOAT float
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
#define GI_UINT uint32_t
#define GI_FLOAT float
#define GI_STRUCT(name) typedef struct name
#define GI_END(name) name;
#endif

/* "No node, no vertex, no object." */
#define GI_NONE 0xFFFFFFFFu

/* Flags of a node (gi_node_topology.range.w). In bits 8..11, of an emitter: how much finer than others it is cut, as
 * a power of two (emitters.c). From bit 16 on how thick it is: how far its leaves reach from the plane through its
 * sphere's centre that its axis is normal to, over the radius, in 65535ths, rounded up; 0: all of it lies in that
 * plane. */
#define GI_NODE_LEAF 1u     /* one leaf, no children */
#define GI_NODE_POLYGON 2u  /* has four corners; a cluster above the base faces only where a quad covers it */
#define GI_NODE_FLAT 4u     /* the corners' two triangles are exactly the surface of its leaves */
#define GI_NODE_EMITTER 8u  /* some leaf below it emits; set by the scene, not by the hierarchy */
#define GI_NODE_BACK 16u    /* its back can be seen from somewhere: the object is not a closed outward surface */
#define GI_NODE_SKY 32u     /* a patch at infinity: corners and sphere centre are directions */
#define GI_NODE_LAMP 64u    /* what it emits is drawn per pixel (lamp.c) and no part of the leaves' indirect light */
/* Of several static objects (statics.h): in the world's frame, its two children behind it. */
#define GI_NODE_TOP 128u
#define GI_NODE_SMOOTH 4096u   /* some leaf below it is a mirror or glass; set by the scene */
#define GI_NODE_PICTURE 8192u /* a patch of a sky with a picture; where GI_NODE_FINER is set, one of much light */
#define GI_NODE_FINER_SHIFT 8u
#define GI_NODE_FINER_MOST 15u
/* Of receivers, which are nobody's source: GI_NODE_FINER is how much finer their rows are cut, and in place of
 * GI_NODE_SMOOTH and _PICTURE stands how many rays an entry at the tolerance has, less one. */
#define GI_NODE_SAMPLES_SHIFT 12u
#define GI_NODE_SAMPLES_MOST 15u
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
 *     P(d) = (S(d) + moment . d) / 2,   S(d) = sum of area |n . d| = about shape * sqrt(area * d' T d),   T = sum of
 *         area n n'
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
 *   corners: vertex numbers, counter-clockwise; GI_NONE for a cluster that no quad covers; a triangle repeats its third
 *       corner
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
 * Every primitive of a scene has a rank of its own. Of two that lie in one place and look the same way the one of
 * higher rank is met.
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
 *   extra.x end neighbour    extra.y first vertex    extra.z end vertex    extra.w place among what was swept, from 1;
 *       0: none
 *   changed.x update that last moved it    changed.y update that last lit or put it out    changed.z update that last
 *       gave it another shape: that moved it, too
 *   ids.x added to the number of a leaf gives its id, ids.y likewise of a node; of a set of receivers, which has no
 *       tree: ids.z where their light begins, ids.w vec4 of it each
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
#define GI_OBJECT_LEAF_MATERIALS 32u /* leaves of one primitive may have materials of their own */
#define GI_OBJECT_UNSEEN 8u /* hidden or destroyed: it keeps its place and takes part in nothing */
#define GI_OBJECT_DEFORMS 64u /* its shape may change: pairs of its own leaves are cut by a shader of their own */

/* A leaf: x node, y object slot, z material, w rank of its primitive. A material: rho, then exitance; exitance.w of
 * a translucent object's is what is added to its number for the one that pixels are lit by, which is black. */
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
 *   rows: leaves and receivers, which have numbers behind those of leaves (receivers.h); 0; 0; 0
 *   limits: entry pool, queue, most samples of a near leaf, of an emitter
 *   tolerance: form factor, of emitters, of sky patches, of the solve
 *   work: pose runs, pose threads, cut runs, cut threads
 *   grid, cells: of the packed TLAS, as of an object's
 *   misc: TLAS nodes, large nodes, light vertices, 1 where the sky shines
 *   update: its number, first and end of the movers in the lists of objects, GI_UPDATE_ flags
 *   inner: first and end of a second TLAS, of the objects that may lie between two others; slot of a sky that does not
 *          shine; 1 where flagged entries are marked
 *   limit: x rays an update may take, y tolerance on what a waiting row may be off by, of the largest light reflected
 *   budget: first and end of the emitting objects in the lists of objects (first > end: too many for a list), rows that
 *           an update may assess, the newest update that moved, lit or put out an object
 *   ceiling: largest E / (1 - rho) of rgb, which no B exceeds; largest 1 / (1 - rho)
 *
 *   swept: in the lists of objects, in fours of words, where what was swept begins; how many; the first slot that is a
 *          source, and that of the static objects as one, GI_NONE: there is none
 *
 *   statics: primitives of static objects, which are the first ones; 1 where links through mirrors and glass may bring
 *            what something emits; 1 where rows may sum to more than 1 (specular_rows.h); threads of the cuts of own
 *            pairs, behind the cut threads
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
	GI_UVEC4 rows;
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
 *   key.y rays it takes    key.z dirty entries, or how many may be    key.w update that assessed it, 0: none that still
 *       holds
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

/* Of an object under a budget, and behind the last one of the whole scene, words of three channels each as float
 * bits: the largest B of its leaves that emit nothing, the largest of all, the complement of the least. */
#define GI_LIGHT_BOUND_OTHERS 0u
#define GI_LIGHT_BOUND_ALL 3u
#define GI_LIGHT_BOUND_LEAST 6u
#define GI_LIGHT_BOUND_WORDS 9u

/* The buffer of choices: rays of the rows in each bucket, rows to assess in each bucket, the chosen leaves, those to
 * assess. */
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
/* Its node was changed or went; x is the node whose B its link takes: to be cut anew. */
#define GI_ENTRY_GONE 0x40000000u
#define GI_BLOCKER_STATICS 0xFFFDu /* static objects, one or several: nothing else changes that */
#define GI_BLOCKER_MIXED 0xFFFEu /* several objects */
#define GI_BLOCKER_NONE 0xFFFFu

/* Behind an entry's target, the node whose B it takes: what is there neither emits nor reflects. */
#define GI_TARGET_BLACK 0x80000000u

/* A link, what the solve multiplies: x node, y weight as float bits. A row's first ones may be light through mirrors
 * and glass (specular_path.comp), each in the place of two: x the node where its path ended and these bits, y z w a
 * weight for each channel. */
#define GI_LINK_SPECULAR 0x80000000u
/* What the node emits comes by photons (caustics.c): the link has what it reflects. */
#define GI_LINK_PHOTONS 0x40000000u
#define GI_LINK_NODE 0x3FFFFFFFu

/* A segment, the cut of one object in one row: x and y a block of entries; as float bits (close.comp) z the share of
 * its samples that see their object, w the sum of the form factors of entries that are no backs.
 *
 * Where no sample sees the object, z is GI_SEGMENT_FACE and the number of a primitive that may hide it (covered.comp),
 * GI_SEGMENT_NO_FACE or more: none was found, or none looked for.
 *
 * A block of a pool: x offset, y count in bits 0..23, size class in bits 24..31 (255: no block). Class c holds 4 << c.
 */
#define GI_SEGMENT_FACE 0x80000000u
#define GI_SEGMENT_NO_FACE 0x007FFFFFu
/* All of z, GI_SEGMENT_FACE too; rows of nothing have it, and as a float it is below 0. */
#define GI_SEGMENT_UNKNOWN 0xFF000000u
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

/* ---- what the GPU counts and decides ----
 *
 * One structure, gi_state, lies in a buffer that passes write and read (buffers.glsl) and that is copied out as the
 * frame's report. *_bits are floats >= 0 that atomicMax and atomicMin work on: their bits order as the floats do. Every
 * part is whole in vec4, so that uniform blocks, storage blocks and C lay it out alike (gi/src/layout.c).
 */

/* Group counts of an indirect dispatch. */
GI_STRUCT(gi_groups) {
	GI_UINT x, y, z, unused;
} GI_END(gi_groups)

/* What an update does to rows; all 0 when it begins. */
GI_STRUCT(gi_state_counts) {
	GI_UINT new_entries;    /* cut anew, queued first */
	GI_UINT queued;         /* the same plus flagged ones */
	GI_UINT rays;
	GI_UINT dirty_rows;
	GI_UINT concerned_rows; /* to look at for entries to flag */
	GI_UINT changed_rows;   /* to close */
	GI_UINT assessed_rows;  /* under a budget: to assess */
	GI_UINT stale_bits;     /* largest bound on what a waiting row is off by */
	GI_UINT overflow;       /* 1: a pool or the queue was full */
	GI_UINT not_finite;     /* 1: a NaN or infinity appeared */
	GI_UINT specular_paths; /* entries that see a mirror or glass, to be followed */
	GI_UINT light_rays;     /* to lights without a surface */
} GI_END(gi_state_counts)

/* The same, of updates that refresh rows; others, of new light alone, leave them. */
GI_STRUCT(gi_state_refresh) {
	GI_UINT wanted;          /* how many smallest blocks a pool that was full lacked */
	GI_UINT chosen_rows;     /* under a budget: to refresh */
	GI_UINT chosen_rays;     /* that they are thought to take */
	GI_UINT waiting_rows;    /* not refreshed although something of them may have changed */
	GI_UINT waiting_entries; /* their dirty entries */
	GI_UINT late_rows;       /* those of them that wait for lack of budget alone */
	GI_UINT unused0, unused1;
} GI_END(gi_state_refresh)

/* Kept from update to update, until all rows are built anew. */
GI_STRUCT(gi_state_rows) {
	GI_UINT entries, links; /* in all rows */
	GI_UINT unused0, unused1;
} GI_END(gi_state_rows)

/* Under a budget. */
GI_STRUCT(gi_state_budget) {
	GI_UINT lowest_assessed; /* bucket that is assessed */
	GI_UINT lowest_chosen;   /* bucket that is refreshed */
	GI_UINT step_bits;       /* largest |B - B before the solve| */
	GI_UINT unused;
} GI_END(gi_state_budget)

/* What the solve remembers from sweep to sweep, and from frame to frame while nothing moves; check.comp alone writes
 * it, and weigh.comp what begins a solve. */
GI_STRUCT(gi_state_solve) {
	GI_UINT sweeps;
	GI_UINT verdict;        /* GI_SOLVE_ */
	GI_UINT manner;         /* GI_MANNER_ */
	GI_UINT action;         /* GI_ACTION_ bits: what the next gather does besides, or instead */
	GI_UINT start;          /* GI_START_ */
	GI_UINT in_double;      /* 1: the next gather sums in double precision */
	GI_UINT window;         /* sweeps since the progress was last judged */
	GI_UINT failings;       /* how often Chebyshev failed in this solve */
	GI_UINT recalls;        /* how often in this frame a kept R came back, each in the place of a sweep */
	GI_UINT ellipse;        /* how often Chebyshev's ellipse was widened; kept over frames */
	GI_UINT jacobi_sweeps;  /* those Jacobi would take for this frame, as last foretold */
	GI_UINT keeps_v;        /* 0: where a start is scaled, v begins anew from 1 */
	GI_FLOAT omega;         /* of the next sweep (gather.glsl); 1 is Jacobi */
	GI_FLOAT reach;         /* amplification Chebyshev is set up for; 0 before it is */
	GI_FLOAT window_residual; /* when the progress was last judged */
	GI_FLOAT kept_residual; /* of the R that was kept, by the sweep that kept it */
	GI_FLOAT seen;          /* amplification as of the sweep before, over whatever rows */
	GI_FLOAT amplification; /* least that any sweep over these rows saw */
	GI_FLOAT theta;         /* u = R + sqrt(scale R) + theta * scale * v */
	GI_FLOAT rounding;      /* what more sweeps cannot take from the bound */
	GI_FLOAT bound;         /* largest of rgb */
	GI_FLOAT bound_relative;
	GI_FLOAT residual;      /* largest of rgb, of the last sweep */
	GI_FLOAT contraction;   /* q of the last sweep */
	GI_FLOAT largest_b;     /* of the last sweep */
	GI_FLOAT unused0, unused1, unused2;
	GI_VEC4 scale;          /* rgb: largest reflected light before the sweep; kept over frames */
} GI_END(gi_state_solve)

/* What the sweep now running found, by gather.glsl: largest values, and the least ones of the last two. */
GI_STRUCT(gi_state_found) {
	GI_UVEC4 largest_r_bits; /* rgb: largest reflected light */
	GI_UINT largest_b_bits;
	GI_UINT largest_v_bits;
	GI_UINT residual_bits;
	GI_UINT kappa_bits;      /* residual over M u */
	GI_UINT noise_bits;      /* what rounding alone can leave of the residual, over M u */
	GI_UINT spread_bits;     /* (I - M) u, of the light that the leaf reflects */
	GI_UINT write_bits;      /* how far R as stored is from T R, and B from E + R */
	GI_UINT stray_bits;      /* the same, of the light that the leaf reflects */
	GI_UINT gap_bits;        /* least 1 - rho * row sum */
	GI_UINT descent_bits;    /* least (M v)_i */
	GI_UINT unused0, unused1;
} GI_END(gi_state_found)

/* What bounds reflected light, rgb (emitted.comp). */
GI_STRUCT(gi_state_emitted) {
	GI_UVEC4 direct_bits;  /* largest light first reflected */
	GI_UVEC4 ceiling_bits; /* no reflected light is more */
} GI_END(gi_state_emitted)

/* The start that weigh.comp found, and how it compares with the best multiple of 1; rgb. */
GI_STRUCT(gi_state_start) {
	GI_VEC4 warm_mean; /* mean flux of its residual, W/m2 */
	GI_VEC4 warm_most; /* largest residual */
	GI_VEC4 cold_mean; /* the same of the multiple of 1 */
	GI_VEC4 cold_most;
	GI_VEC4 factor;    /* what becomes of R of before */
	GI_VEC4 lift;      /* how much of v is added to R */
	GI_VEC4 base;      /* and of 1 */
} GI_END(gi_state_start)

/* What the estimate's leaves say (estimate_mean.comp). */
GI_STRUCT(gi_state_estimate) {
	GI_FLOAT squared; /* area mean of |H error|^2, (W/m2)^2; below 0 where noise hides it */
	GI_FLOAT power;   /* area mean of |H|^2 */
	GI_FLOAT local;   /* area mean of |H error|^2 over each leaf's own |H|^2 */
	GI_UINT rays;
} GI_END(gi_state_estimate)

GI_STRUCT(gi_state) {
	gi_state_counts counts;
	gi_state_refresh refresh;
	gi_state_rows rows;
	gi_state_budget budget;
	gi_state_solve solve;
	gi_state_found found;
	gi_state_emitted emitted;
	gi_state_start start;
	gi_state_estimate estimate;
	gi_groups factor;
	gi_groups flag;       /* a thread a row that something may concern */
	gi_groups trace;
	gi_groups close;      /* a thread a changed row */
	gi_groups recycle;
	gi_groups assess;     /* some threads a row to assess */
	gi_groups chosen;     /* a thread a chosen row */
	gi_groups pairs;      /* a thread a chosen row and object */
	gi_groups gather;
	gi_groups gather_double;
	gi_groups hand_over;
	gi_groups check;
	gi_groups specular;   /* a thread an entry that sees a mirror or glass */
} GI_END(gi_state)

/* gi_state_solve.verdict. */
#define GI_SOLVE_CONVERGED 0u
#define GI_SOLVE_GOES_ON 1u
#define GI_SOLVE_ROUNDING 2u       /* more sweeps in single precision bring nothing */

/* gi_state_solve.manner. */
#define GI_MANNER_JACOBI 0u
#define GI_MANNER_CHEBYSHEV 1u
#define GI_MANNER_POLISH 2u        /* near to what rounding leaves: damped sweeps take its noise away */
#define GI_MANNER_GIVEN_UP 3u      /* no ellipse did for these rows: Jacobi to the end */

/* gi_state_solve.action. */
#define GI_ACTION_KEEP 1u          /* a sweep, which keeps the R it begins with */
#define GI_ACTION_RECALL 2u        /* no sweep: the R that was kept comes back */
#define GI_ACTION_SCALE 4u         /* no sweep: what the last sweep makes of the start that weigh.comp found */
#define GI_ACTION_COLD 8u          /* no sweep: R is the light first reflected, v is 1 */

/* gi_state_solve.start: what the sweep to come, or just done, begins the solve with; weigh.comp looks at it. */
#define GI_START_NONE 0u           /* it begins none */
#define GI_START_WARM 1u           /* R of before */
#define GI_START_COLD 2u           /* the light first reflected */

/* The buffer of leaf radiosity, a part after the other, each a vec4 per leaf; that of node radiosity, a vec4 per
 * node. */
#define GI_LEAF_B 0u               /* B, W/m2; w: what its row sums to less than 1 */
#define GI_LEAF_R 1u               /* R = B - E, v */
#define GI_LEAF_BEFORE 2u          /* R, v before the last sweep */
#define GI_LEAF_KEPT 3u            /* R, v to come back to */
/* Irradiance by exitance, and by lights without a surface; w: the latter alone (packed_light.glsl) */
#define GI_LEAF_EMITTED 4u
#define GI_LEAF_UNDRAWN 5u         /* that of it which is not drawn per pixel; w: area, m2 */
#define GI_LEAF_PARTS 6u
#define GI_NODE_B 0u
#define GI_NODE_R 1u
#define GI_NODE_PARTS 2u

/* What is dark: light reflected below this share of the largest. Errors count relative to the light there or, where
 * it is less, to this. */
#define GI_DARK_SHARE 1e-5f

/* Words a leaf of the buffer TOUCHED (touched.glsl). */
#define GI_TOUCHED_PARTS 4u

/* An allocator: bump pointer, pending count, then free counts per class; its lists are in the buffer behind it. */
#define GI_POOL_BUMP 0u
#define GI_POOL_PENDING 1u
#define GI_POOL_LIMIT 2u           /* elements */
#define GI_POOL_LIST 3u            /* where the free lists begin, in words */
#define GI_POOL_FREE 4u            /* GI_BLOCK_CLASSES signed counts */
#define GI_POOL_PENDING_LIST 32u   /* GI_POOL_PENDING_MAX pairs: offset, class */
#define GI_POOL_PENDING_MAX 131072u

/* A buffer (buffer_list.h) is bound as a storage block at its number and as a texture at unit GI_TEXEL_UNIT +
 * number. */
#define GI_TEXEL_UNIT 4

/* Uniform blocks: the frame; the state as it was before a dispatch, or one lamp (shade_shared.h). */
#define GI_UNIFORM_FRAME 0
#define GI_UNIFORM_STATE 1
#define GI_UNIFORM_LAMP 1

/* An emitting triangle: its corners as float bits, and in the fourth words
 *   0 top of its slice of the 32-bit line, inclusive: slices are as wide as triangles are powerful    1 material
 *       2 a leaf of its primitive */
#define GI_SOBOL_DIMENSIONS 7u

/* Where a thread's paths are between two dispatches.
 *
 *   //--------------- 16B ---------------
 *   origin.xyz  the vertex, lifted off its surface   origin.w  its path's number, a whole number below 2^24
 *   normal.xyz  there                                normal.w  its number along the path
 *   throughput.xyz                                   throughput.w 1: at a mirror or glass, normal is the direction it
 *       goes on in
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

/* Of a pair: the box of all its paths, lower and upper corner as ordered words; how many photons were there before
 * this update, and how many are now: the first ones. */
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

/* A light without a surface (gi_light).
 *
 *   //--------------- 16B ---------------
 *   place.xyz  position; of a directional one the unit vector towards it
 *   place.w    radius, metres; of a directional one the tangent of its angular radius
 *   axis.xyz   unit direction that it shines in    axis.w  1 / range^2; 0: no range
 *   cone.x, y  clamp(cos * x + y, 0, 1)^2 is what a spot sends at that angle to its axis; 0, 1 of others    cone.zw  0
 *   color.xyz  radiant intensity, W/sr; of a directional one irradiance, W/m2    color.w  0
 *   kind.x     GI_PUNCTUAL_ flags    kind.y  its place in the list, by which samples are drawn    kind.zw  0
 */
GI_STRUCT(gi_punctual_light) {
	GI_VEC4 place;
	GI_VEC4 axis;
	GI_VEC4 cone;
	GI_VEC4 color;
	GI_UVEC4 kind;
} GI_END(gi_punctual_light)

#define GI_PUNCTUAL_THERE 1u        /* else its place is free */
#define GI_PUNCTUAL_ENABLED 2u
#define GI_PUNCTUAL_DIRECTIONAL 4u
#define GI_PUNCTUAL_MOVED 8u        /* all its rays are to be traced anew */
#define GI_PUNCTUAL_BY_LEAVES 16u   /* pictures have its direct light through the leaves */
#define GI_PUNCTUAL_BY_PIXELS 32u   /* pixel by pixel; neither: the host adds it, to receivers too */

/* What the light of intensity 1 brings to a leaf, were its rays to be traced first. */
#define GI_PUNCTUAL_UNKNOWN (-1.0f)

/* Of a leaf, vec4: irradiance from all of them, W/m2; that of it which pictures have through the leaves. Of a receiver
 * the first is that of those which no host draws. */
#define GI_PUNCTUAL_ALL 0u
#define GI_PUNCTUAL_SHOWN 1u
#define GI_PUNCTUAL_PARTS 2u

/* Of a leaf where there are such lights, vec4: what links bring of exitance (GI_LEAF_EMITTED without the lights), as a
 * float and what it lacks to the sum in double; that of it which is not drawn per pixel. */
#define GI_LINKED_HIGH 0u
#define GI_LINKED_LOW 1u
#define GI_LINKED_UNDRAWN 2u
#define GI_LINKED_PARTS 3u

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
