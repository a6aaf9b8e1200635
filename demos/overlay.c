#include "overlay.h"

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
static void add(lines *l, const char *format, ...)
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
	static const char *const names[] = {"", "  wireframe", "  dirty entries", "  residual"};
	return names[layer];
}

static void add_passes(lines *l, const gi_report *r)
{
	char text[256] = "ms";
	size_t length = 2;
	for (int k = 0; k < GI_PASS_COUNT && length < sizeof text; k++) {
		/* Four passes a line: a line of all would be wider than the picture. */
		length += (size_t)snprintf(text + length, sizeof text - length, "  %s %.1f", gi_pass_name((gi_pass)k), (double)r->pass_ms[k]);
		if (k % 4 == 3 || k == GI_PASS_COUNT - 1) {
			add(l, "%s", text);
			length = 2;
		}
	}
}

static void add_figures(lines *l, const overlay *o)
{
	const gi_report *r = &o->report;
	add(l, "%s  %s%s%s%s", o->title, options_mode_name(o->mode), layer_name(o->layer), o->rebuild ? "  rebuilding" : "",
	    o->paused ? "  paused" : "");
	add(l, "%.1f fps  frame %.1f ms  update %.1f ms", o->fps, o->frame_ms, o->update_ms);
	add_passes(l, r);
	add(l, "leaves %u  entries %llu (%.0f a leaf)", r->leaves, (unsigned long long)r->entries,
	    r->leaves ? (double)r->entries / r->leaves : 0);
	add(l, "dirty %.2f %%  rays %llu", r->entries ? 100 * (double)r->dirty_entries / (double)r->entries : 0,
	    (unsigned long long)r->rays);
	add(l, "sweeps %u  residual %.1e  bound %.1e W/m2", r->sweeps, (double)r->residual, (double)r->solve_bound);
	add(l, "%s  memory %.1f MiB  H: keys", report_outcome_name(r->outcome), (double)r->gpu_bytes / (1 << 20));
	add(l, "%.60s", o->renderer);
}

static void add_help(lines *l, const overlay *o)
{
	add(l, "left drag    turn the view");
	add(l, "scroll       nearer, farther");
	if (o->can_move)
		add(l, "arrows, right drag  move the figure");
	add(l, "1 2 3, M     direct, indirect, global; next");
	add(l, "space        pause");
	add(l, "W            wireframe of the leaves");
	add(l, "D            heat map of dirty entries");
	add(l, "R            heat map of the residual");
	add(l, "O            no overlay");
	add(l, "B            build every frame from scratch");
	add(l, "- =          darker, brighter");
	add(l, "H            this list");
	add(l, "Esc          end");
}

/* Glyphs of the font are at most 7 wide and lines 12 high, times scale. */
static void show(engine_hud *hud, const lines *l, float top, float scale)
{
	static const float shade[4] = {0, 0, 0, 0.55f}, ink[4] = {1, 1, 1, 1};
	const float margin = 6 * scale;
	engine_hud_box(hud, (float[4]){0, top, 2 * margin + 6.2f * scale * (float)l->widest, 2 * margin + 12 * scale * (float)l->count}, shade);
	engine_hud_text(hud, margin, top + margin, scale, ink, "%s", l->text);
}

void overlay_text(engine_hud *hud, const overlay *o, int height)
{
	const float scale = height >= 1000 ? 2 : height >= 640 ? 1.5f : 1;
	lines figures = {0}, help = {0};
	add_figures(&figures, o);
	show(hud, &figures, 0, scale);
	if (!o->help)
		return;
	add_help(&help, o);
	show(hud, &help, (12 * (float)figures.count + 20) * scale, scale);
}
