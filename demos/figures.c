#include "figures.h"

#include "options.h"
#include "report.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* A column of lines that grows downwards. */
typedef struct lines {
	char text[1024];
	size_t length;
	int count;
	size_t widest;
} lines;

#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
static void
add(lines *l, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	const size_t room = sizeof l->text - l->length;
	const int wanted = vsnprintf(l->text + l->length, room, format, arguments);
	va_end(arguments);
	if (wanted < 0 || (size_t)wanted + 2 > room) {
		l->text[l->length] = '\0';
		return;
	}
	l->length += (size_t)wanted;
	l->widest = (size_t)wanted > l->widest ? (size_t)wanted : l->widest;
	l->text[l->length++] = '\n';
	l->text[l->length] = '\0';
	l->count++;
}

static const char *layer_name(gi_overlay layer)
{
	static const char *const names[] = {"",
					    "  wireframe",
					    "  dirty entries",
					    "  residual",
					    "  hierarchy",
					    "  what lights a leaf",
					    "  what a leaf sees",
					    "  what hides things from a leaf",
					    "  probes"};
	return names[layer];
}

static void add_passes(lines *l, const gi_report *r)
{
	char text[256] = "ms";
	size_t length = 2;
	for (int k = 0; k < GI_PASS_COUNT && length < sizeof text; k++) {
		/* Four passes a line: a line of all would be wider than the picture. */
		length += (size_t)snprintf(text + length, sizeof text - length, "  %s %.1f", gi_pass_name((gi_pass)k),
					   (double)r->pass_ms[k]);
		if (k % 4 == 3 || k == GI_PASS_COUNT - 1) {
			add(l, "%s", text);
			length = 2;
		}
	}
}

/* The certified bound is this many times the true distance: medians of scenes in docs/accuracy.md. */
static const double BOUND_OVER_DISTANCE[2] = {30, 100};

/* How long an update may take, what waits and what that is worth: what to expect, and the limit. */
static void add_waiting(lines *l, const figures *o)
{
	const gi_report *r = &o->report;
	const double bound = (double)r->stale_bound;
	if (o->target_fps > 0 && o->budget_ms > 0)
		add(l, "%.0f fps asked for: %.1f ms an update", o->target_fps, o->budget_ms);
	else if (o->target_fps > 0)
		add(l, "%.0f fps asked for: exact updates", o->target_fps);
	if (r->waiting_rows) {
		add(l, "rows that wait %.1f %%", 100 * (double)r->waiting_rows / r->leaves);
		add(l, "stale by %.2g to %.2g W/m2 expected, %.3g at most (certified)", bound / BOUND_OVER_DISTANCE[1],
		    bound / BOUND_OVER_DISTANCE[0], bound);
	} else if (o->target_fps > 0)
		add(l, "nothing waits");
}

static void add_figures(lines *l, const figures *o)
{
	const gi_report *r = &o->report;
	add(l, "%s  %s%s%s%s", o->title, options_mode_name(o->mode), layer_name(o->layer),
	    o->rebuild ? "  rebuilding" : "", o->paused ? "  paused" : "");
	add(l, "%.1f fps  frame %.1f ms  update %.1f ms", o->fps, o->frame_ms, o->update_ms);
	add_passes(l, r);
	add(l, "leaves %u  entries %llu (%.0f a leaf)", r->leaves, (unsigned long long)r->entries,
	    r->leaves ? (double)r->entries / r->leaves : 0);
	add(l, "dirty %.2f %%  rays %llu", r->entries ? 100 * (double)r->dirty_entries / (double)r->entries : 0,
	    (unsigned long long)r->rays);
	add(l, "sweeps %u (%s)  amplification %.1f", r->sweeps, report_method_name(r->method),
	    (double)r->amplification);
	add(l, "residual %.1e  bound %.1e W/m2, %.1e of it rounding", (double)r->residual, (double)r->solve_bound,
	    (double)r->rounding_bound);
	add_waiting(l, o);
	if (r->sampling_estimate > 0)
		add(l, "estimated error %.2g W/m2 (%.1f %%)", (double)r->sampling_estimate,
		    100 * (double)r->sampling_relative);
	add(l, "%s  (N  ,  .)", o->setting);
	add(l, "%s  memory %.1f MiB  H: keys", report_outcome_name(r->outcome), (double)r->gpu_bytes / (1 << 20));
	add(l, "%.60s", o->renderer);
}

/* The font is proportional: keys and what they do are two columns. */
static void add_help(lines *keys, lines *actions, const figures *o)
{
	static const char *const help[][2] = {
	    {"arrows, right drag", "move what moves"},
	    {"left drag", "turn the view"},
	    {"scroll", "nearer, farther"},
	    {"1  2  3  M", "direct, indirect, global, next"},
	    {"space", "pause"},
	    {"W", "wireframe of the leaves"},
	    {"D", "heat map of dirty entries"},
	    {"R", "heat map of the residual"},
	    {"T  [  ]", "nodes of the hierarchy, coarser, finer"},
	    {"L  V  K", "the leaf under the cursor: what lights it, what it sees, what hides"},
	    {"O", "no overlay"},
	    {"N  ,  .", "next setting, less, more"},
	    {"B", "build every frame from scratch"},
	    {"-  =", "darker, brighter"},
	    {"F5", "read the shaders again"},
	    {"H", "this list"},
	    {"Esc", "end"},
	};
	for (uint32_t k = 0; k < o->key_count; k++) {
		add(keys, "%s", o->keys[k][0]);
		add(actions, "%s", o->keys[k][1]);
	}
	if (o->has_receivers) {
		add(keys, "P");
		add(actions, "probes, in the colour of their light");
	}
	for (size_t k = o->can_move ? 0 : 1; k < sizeof help / sizeof *help; k++) {
		add(keys, "%s", help[k][0]);
		add(actions, "%s", help[k][1]);
	}
}

static const float MARGIN = 6, LINE = 12, KEY_COLUMN = 112;
static const float INK[4] = {1, 1, 1, 1};

/* A dark box behind so many lines; glyphs are at most 5.8 wide on average. */
static void show_box(engine_hud *hud, float top, float scale, float characters, int line_count)
{
	static const float shade[4] = {0, 0, 0, 0.5f};
	const float box[4] = {0, top, scale * (2 * MARGIN + 5.8f * characters),
			      scale * (2 * MARGIN + LINE * (float)line_count)};
	engine_hud_box(hud, box, shade);
}

static void show_figures(engine_hud *hud, const lines *l, float scale)
{
	show_box(hud, 0, scale, (float)l->widest, l->count);
	engine_hud_text(hud, scale * MARGIN, scale * MARGIN, scale, INK, "%s", l->text);
}

static void show_help(engine_hud *hud, const figures *o, float top, float scale)
{
	lines keys = {0}, actions = {0};
	add_help(&keys, &actions, o);
	show_box(hud, top, scale, KEY_COLUMN / 5.8f + (float)actions.widest, keys.count);
	engine_hud_text(hud, scale * MARGIN, top + scale * MARGIN, scale, INK, "%s", keys.text);
	engine_hud_text(hud, scale * (MARGIN + KEY_COLUMN), top + scale * MARGIN, scale, INK, "%s", actions.text);
}

void figures_text(engine_hud *hud, const figures *o, int height)
{
	const float scale = height >= 1000 ? 2 : height >= 800 ? 1.5f : 1;
	lines figures = {0};
	add_figures(&figures, o);
	show_figures(hud, &figures, scale);
	if (o->help)
		show_help(hud, o, scale * (LINE * (float)figures.count + 3 * MARGIN), scale);
}
