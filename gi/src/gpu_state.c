/* The host's drawing state: kept aside while the library draws, and given back as it was. */
#include "gpu_draw.h"

#include <gi_gl.h>

/* On or off while the library draws. Not here: GL_FRAMEBUFFER_SRGB and GL_DITHER, which say how the host's framebuffer
 * holds what is drawn. */
static const struct {
	GLenum name;
	bool wanted;
} CAPABILITIES[GPU_CAPABILITIES] = {
    {GL_DEPTH_TEST, true},           {GL_CULL_FACE, true},
    {GL_STENCIL_TEST, false},        {GL_POLYGON_OFFSET_FILL, false},
    {GL_DEPTH_CLAMP, false},         {GL_RASTERIZER_DISCARD, false},
    {GL_PRIMITIVE_RESTART, false},   {GL_PRIMITIVE_RESTART_FIXED_INDEX, false},
    {GL_COLOR_LOGIC_OP, false},      {GL_SAMPLE_ALPHA_TO_COVERAGE, false},
    {GL_SAMPLE_ALPHA_TO_ONE, false}, {GL_SAMPLE_COVERAGE, false},
    {GL_SAMPLE_MASK, false},         {GL_LINE_SMOOTH, false},
    {GL_POLYGON_SMOOTH, false},      {GL_CLIP_DISTANCE0, false},
    {GL_CLIP_DISTANCE1, false},      {GL_CLIP_DISTANCE2, false},
    {GL_CLIP_DISTANCE3, false},      {GL_CLIP_DISTANCE4, false},
    {GL_CLIP_DISTANCE5, false},      {GL_CLIP_DISTANCE6, false},
    {GL_CLIP_DISTANCE7, false},
};

static const GLenum VALUES[GPU_STATE_VALUES] = {
    [GPU_STATE_FRAMEBUFFER] = GL_DRAW_FRAMEBUFFER_BINDING,
    [GPU_STATE_DEPTH_FUNCTION] = GL_DEPTH_FUNC,
    [GPU_STATE_DEPTH_MASK] = GL_DEPTH_WRITEMASK,
    [GPU_STATE_CULL_FACE] = GL_CULL_FACE_MODE,
    [GPU_STATE_FRONT_FACE] = GL_FRONT_FACE,
    [GPU_STATE_PROVOKING_VERTEX] = GL_PROVOKING_VERTEX,
    [GPU_STATE_CLIP_ORIGIN] = GL_CLIP_ORIGIN,
    [GPU_STATE_CLIP_DEPTH] = GL_CLIP_DEPTH_MODE,
};

/* Of draw buffer 0. */
static const GLenum BLEND_VALUES[GPU_BLEND_VALUES] = {GL_BLEND_SRC_RGB,      GL_BLEND_DST_RGB,
						      GL_BLEND_SRC_ALPHA,    GL_BLEND_DST_ALPHA,
						      GL_BLEND_EQUATION_RGB, GL_BLEND_EQUATION_ALPHA};

static void set(const gpu *g, GLenum capability, bool on)
{
	if (on)
		g->gl->Enable(capability);
	else
		g->gl->Disable(capability);
}

static void set_indexed(const gpu *g, GLenum capability, GLuint index, bool on)
{
	if (on)
		g->gl->Enablei(capability, index);
	else
		g->gl->Disablei(capability, index);
}

static void remember(const gpu *g, gpu_draw_state *s)
{
	for (int k = 0; k < GPU_CAPABILITIES; k++)
		s->capabilities[k] = g->gl->IsEnabled(CAPABILITIES[k].name) == GL_TRUE;
	for (int k = 0; k < GPU_STATE_VALUES; k++)
		g->gl->GetIntegerv(VALUES[k], &s->values[k]);
	for (int k = 0; k < GPU_BLEND_VALUES; k++)
		g->gl->GetIntegeri_v(BLEND_VALUES[k], 0, &s->blend_values[k]);
	for (GLuint k = 0; k < GPU_DRAW_BUFFERS; k++) {
		GLboolean mask[4];
		g->gl->GetBooleani_v(GL_COLOR_WRITEMASK, k, mask);
		for (int c = 0; c < 4; c++)
			s->color_mask[k][c] = mask[c] == GL_TRUE;
		s->blend[k] = g->gl->IsEnabledi(GL_BLEND, k) == GL_TRUE;
	}
	s->scissor = g->gl->IsEnabledi(GL_SCISSOR_TEST, 0) == GL_TRUE;
	g->gl->GetIntegeri_v(GL_SCISSOR_BOX, 0, s->scissor_box);
	g->gl->GetFloati_v(GL_VIEWPORT, 0, s->viewport);
	g->gl->GetDoublei_v(GL_DEPTH_RANGE, 0, s->depth_range);
	g->gl->GetIntegerv(GL_POLYGON_MODE, s->polygon_mode);
	g->gl->GetFloatv(GL_LINE_WIDTH, &s->line_width);
}

void gpu_draw_begin(const gpu *g, gpu_draw_state *s)
{
	remember(g, s);
	for (int k = 0; k < GPU_CAPABILITIES; k++)
		set(g, CAPABILITIES[k].name, CAPABILITIES[k].wanted);
	for (GLuint k = 0; k < GPU_DRAW_BUFFERS; k++) {
		set_indexed(g, GL_BLEND, k, false);
		g->gl->ColorMaski(k, GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
	}
	set_indexed(g, GL_SCISSOR_TEST, 0, false);
	g->gl->BlendEquationi(0, GL_FUNC_ADD);
	g->gl->DepthMask(GL_TRUE);
	g->gl->DepthRangeIndexed(0, 0, 1);
	g->gl->PolygonMode(GL_FRONT_AND_BACK, GL_FILL);
	g->gl->ProvokingVertex(GL_LAST_VERTEX_CONVENTION);
	g->gl->LineWidth(1);
	g->gl->CullFace(GL_BACK);
	g->gl->FrontFace(GL_CCW);
	gpu_draw_convention(g, (gpu_convention){0});
}

void gpu_draw_end(const gpu *g, const gpu_draw_state *s)
{
	const int *v = s->values, *b = s->blend_values;
	for (int k = 0; k < GPU_CAPABILITIES; k++)
		set(g, CAPABILITIES[k].name, s->capabilities[k]);
	for (GLuint k = 0; k < GPU_DRAW_BUFFERS; k++) {
		const bool *mask = s->color_mask[k];
		g->gl->ColorMaski(k, mask[0], mask[1], mask[2], mask[3]);
		set_indexed(g, GL_BLEND, k, s->blend[k]);
	}
	g->gl->BlendFuncSeparatei(0, (GLenum)b[0], (GLenum)b[1], (GLenum)b[2], (GLenum)b[3]);
	g->gl->BlendEquationSeparatei(0, (GLenum)b[4], (GLenum)b[5]);
	set_indexed(g, GL_SCISSOR_TEST, 0, s->scissor);
	g->gl->ScissorIndexedv(0, s->scissor_box);
	g->gl->ViewportIndexedfv(0, s->viewport);
	g->gl->DepthRangeIndexed(0, s->depth_range[0], s->depth_range[1]);
	g->gl->PolygonMode(GL_FRONT_AND_BACK, (GLenum)s->polygon_mode[0]);
	g->gl->LineWidth(s->line_width);
	g->gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, (GLuint)v[GPU_STATE_FRAMEBUFFER]);
	g->gl->DepthFunc((GLenum)v[GPU_STATE_DEPTH_FUNCTION]);
	g->gl->DepthMask(v[GPU_STATE_DEPTH_MASK] != 0);
	g->gl->CullFace((GLenum)v[GPU_STATE_CULL_FACE]);
	g->gl->FrontFace((GLenum)v[GPU_STATE_FRONT_FACE]);
	g->gl->ProvokingVertex((GLenum)v[GPU_STATE_PROVOKING_VERTEX]);
	g->gl->ClipControl((GLenum)v[GPU_STATE_CLIP_ORIGIN], (GLenum)v[GPU_STATE_CLIP_DEPTH]);
}

void gpu_draw_convention(const gpu *g, gpu_convention c)
{
	g->gl->ClipControl(c.upper_left ? GL_UPPER_LEFT : GL_LOWER_LEFT,
			   c.zero_to_one ? GL_ZERO_TO_ONE : GL_NEGATIVE_ONE_TO_ONE);
	g->gl->DepthFunc(c.reversed ? GL_GREATER : GL_LESS);
}

/* Other draw buffers of the host than the first keep what they hold: the library's shaders have nothing for them. */
static void write_first_alone(const gpu *g, bool alone)
{
	for (GLuint k = 1; k < GPU_DRAW_BUFFERS; k++)
		g->gl->ColorMaski(k, !alone, !alone, !alone, !alone);
}

void gpu_draw_to_host(const gpu *g, const gpu_draw_state *s, uint32_t width, uint32_t height)
{
	g->gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, (GLuint)s->values[GPU_STATE_FRAMEBUFFER]);
	write_first_alone(g, true);
	set_indexed(g, GL_SCISSOR_TEST, 0, false);
	g->gl->ViewportIndexedf(0, s->viewport[0], s->viewport[1], (float)width, (float)height);
}

void gpu_draw_to_target(const gpu *g, const gpu_target *t, gpu_convention c)
{
	const GLfloat farthest = c.reversed ? 0 : 1;
	g->gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, t->framebuffer);
	write_first_alone(g, false);
	g->gl->ViewportIndexedf(0, 0, 0, (float)t->width, (float)t->height);
	if (t->depth)
		g->gl->ClearBufferfv(GL_DEPTH, 0, &farthest);
}

bool gpu_host_is_complete(const gpu *g)
{
	return g->gl->CheckFramebufferStatus(GL_DRAW_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

void gpu_draw_cull(const gpu *g, gpu_cull cull)
{
	set(g, GL_CULL_FACE, cull != GPU_CULL_NONE);
	g->gl->FrontFace(cull == GPU_CULL_MIRRORED_BACKS ? GL_CW : GL_CCW);
}

void gpu_draw_scissor(const gpu *g, const int lower[2], const int upper[2])
{
	set_indexed(g, GL_SCISSOR_TEST, 0, true);
	g->gl->ScissorIndexed(0, lower[0], lower[1], upper[0] - lower[0], upper[1] - lower[1]);
}

void gpu_draw_unscissored(const gpu *g)
{
	set_indexed(g, GL_SCISSOR_TEST, 0, false);
}

void gpu_draw_clip(const gpu *g, bool clip)
{
	for (GLenum k = 0; k < GPU_CLIP_DISTANCES; k++)
		set(g, GL_CLIP_DISTANCE0 + k, clip);
}

void gpu_draw_multiplied(const gpu *g, bool on, gpu_convention c)
{
	set_indexed(g, GL_BLEND, 0, on);
	g->gl->BlendFunci(0, on ? GL_ZERO : GL_ONE, on ? GL_SRC_COLOR : GL_ZERO);
	if (on)
		g->gl->DepthFunc(c.reversed ? GL_GEQUAL : GL_LEQUAL);
	else
		g->gl->DepthFunc(c.reversed ? GL_GREATER : GL_LESS);
	g->gl->DepthMask(!on);
}

void gpu_draw_added(const gpu *g, bool on)
{
	set_indexed(g, GL_BLEND, 0, on);
	g->gl->BlendFunci(0, GL_ONE, on ? GL_ONE : GL_ZERO);
	set(g, GL_DEPTH_TEST, !on);
}

void gpu_draw_added_in_front(const gpu *g, bool on, gpu_convention c)
{
	set_indexed(g, GL_BLEND, 0, on);
	g->gl->BlendFunci(0, GL_ONE, on ? GL_ONE : GL_ZERO);
	if (on)
		g->gl->DepthFunc(c.reversed ? GL_GEQUAL : GL_LEQUAL);
	else
		g->gl->DepthFunc(c.reversed ? GL_GREATER : GL_LESS);
	g->gl->DepthMask(!on);
}
