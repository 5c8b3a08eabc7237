/* SPDX-License-Identifier: BSD-3-Clause */
/* optla demo: what Optla is for, on a scene that needs no files - and on a recorded rig, if one is given - as a page of pictures. */
#include "demo_scene.h"
#include "inputs.h"
#include "verbs.h"

#include "report/page.h"

#include <math.h>
#include <string.h>

typedef struct {
	size_t size;
	const char *sensor;
} demo_options;

static const demo_options demo_defaults = {sizeof demo_defaults, "dslr-14bit"};
static const optla_option demo_fields[] = {
    {"sensor", offsetof(demo_options, sensor), OPTLA_OPTION_STRING, "NAME", 0, 0, NULL,
     "Sensor that takes the photos, see the list of sensors."},
};
static const optla_option_table demo_table = {"demo", sizeof(demo_options), &demo_defaults, demo_fields, CLI_COUNT(demo_fields)};

/* ---- lights on a grid ---- */

static optla_status new_light(const demo_scene *s, double **light)
{
	return optla_figure_doubles_(s->figure, s->info.nlights, light);
}

/* A disc: centre and radius as fractions of the grid's width. */
static void add_disc(const demo_scene *s, double x, double y, double radius, double value, double *light)
{
	const size_t w = s->info.light_width, h = s->info.light_height;
	for (size_t k = 0; k < w * h; k++) {
		const double dx = ((double)(k % w) + 0.5) / (double)w - x, dy = ((double)(k / w) + 0.5) / (double)h - y;
		if (dx * dx + dy * dy <= radius * radius) light[k] += value;
	}
}

static void add_stripes(const demo_scene *s, double period, double *light)
{
	const size_t w = s->info.light_width, h = s->info.light_height;
	for (size_t k = 0; k < w * h; k++) light[k] += 0.5 + 0.5 * cos(2 * 3.14159265358979 * (double)(k % w) / (double)w / period);
}

static optla_status corner_section(optla_figure *figure, const char *sensor, const demo_expect *expect)
{
	optla_rig *projector, *screen;
	demo_scene scenes[2], *with_projector = &scenes[0], *with_screen = &scenes[1];
	OPTLA_TRY(optla_lab_corner_(figure, 48, 32, false, &projector));
	OPTLA_TRY(optla_lab_screen_(figure, &screen));
	OPTLA_TRY(demo_scene_init(with_projector, figure, projector, sensor, expect));
	OPTLA_TRY(demo_scene_init(with_screen, figure, screen, sensor, expect));
	double *disc, *stripes, *two;
	OPTLA_TRY(new_light(with_screen, &disc));
	OPTLA_TRY(new_light(with_screen, &stripes));
	OPTLA_TRY(new_light(with_screen, &two));
	add_disc(with_screen, 0.7, 0.3, 0.15, 1, disc);
	add_stripes(with_screen, 0.5, stripes);
	add_disc(with_screen, 0.25, 0.35, 0.12, 1, two);
	add_disc(with_screen, 0.8, 0.7, 0.1, 0.6, two);
	optla_figure_say_(figure,
	                  "Three walls, one of them red, with all light that goes to and fro between them. A camera of %zu x %zu "
	                  "pixels looks at them; "
	                  "a projector of %zu x %zu pixels lights them, or a screen does. What the camera sees is T times what they "
	                  "show, and T is known "
	                  "exactly, so every result can be judged.",
	                  with_screen->info.width, with_screen->info.height, with_screen->info.light_width,
	                  with_screen->info.light_height);
	OPTLA_TRY(demo_dual(with_projector));
	OPTLA_TRY(demo_capture(with_screen, 20));
	const demo_light lights[] = {{disc, "a bright spot"}, {stripes, "stripes"}};
	OPTLA_TRY(demo_relight(with_screen, lights, CLI_COUNT(lights)));
	const demo_light hidden = {two, "Two spots of unlike strength, found from one photo of the walls."};
	OPTLA_TRY(demo_invert(with_screen, &hidden, 20));
	demo_say_cost(scenes, 2);
	return OPTLA_OK;
}

static optla_status recorded_section(optla_figure *figure, optla_rig *rig, const char *sensor, const demo_expect *expect)
{
	demo_scene s;
	OPTLA_TRY(demo_scene_init(&s, figure, rig, sensor, expect));
	double *one, *some, *other;
	OPTLA_TRY(new_light(&s, &one));
	OPTLA_TRY(new_light(&s, &some));
	OPTLA_TRY(new_light(&s, &other));
	const size_t n = s.info.nlights;
	one[n / 5] = 1;
	for (size_t k = 0; k < n; k++) some[k] = k % 7 == 0;
	other[n / 2] = 1;
	other[n - 1 - n / 8] = 0.5;
	optla_figure_say_(figure,
	                  "'%s': %zu photos, %zu x %zu pixels with %zu channels, %zu of them in the mask. Photos of patterns are "
	                  "made of the recorded ones, "
	                  "through the sensor '%s'.",
	                  s.info.name, s.info.nphotos, s.info.width, s.info.height, s.info.channels, s.info.npixels, sensor);
	OPTLA_TRY(demo_capture(&s, (int)optla_min_(20, n)));
	const demo_light lights[] = {{one, "one light"}, {some, "every seventh light"}};
	OPTLA_TRY(demo_relight(&s, lights, CLI_COUNT(lights)));
	const demo_light hidden = {other, "Two lights, found from one photo."};
	OPTLA_TRY(demo_invert(&s, &hidden, (int)optla_min_(20, n)));
	demo_say_cost(&s, 1);
	return OPTLA_OK;
}

/* ---- the page ---- */

static const demo_expect unknown = {INFINITY, INFINITY, -INFINITY, INFINITY};

typedef struct {
	cli_run *run;
	const char *dir, *sensor, *rig_path; /* rig_path NULL: the ball, if its photos are there */
	bool known;                          /* default sensor: the numbers of the built-in scenes are known */
	json_t *sections;
	size_t failed;
} demo_page;

static void take_numbers(demo_page *page, const optla_figure *figure)
{
	json_t *list = json_object();
	for (size_t k = 0; k < figure->numbers.count; k++) {
		const optla_number *n = &figure->numbers.item[k];
		cli_json_number(list, n->name, n->value);
		cli_say(page->run, "  %-66s %.4g %s\n", n->name, n->value, n->unit);
	}
	json_object_set_new(page->sections, figure->id, list);
	page->failed += optla_numbers_failed_(&figure->numbers);
}

static void destroy_rig(optla_ctx *ctx, void *object)
{
	(void)ctx;
	optla_rig *rig = object;
	optla_rig_destroy(&rig);
}

static optla_status recorded(demo_page *page, optla_figure *figure)
{
	static const demo_expect ball = {.capture_error = 0.2, .capture_over_best = 1.2, .relit_psnr_db = 28, .inverse_error = 0.25};
	optla_rig *rig = NULL;
	if (page->rig_path) {
		OPTLA_TRY(cli_open_rig(page->run, page->rig_path, &rig));
		OPTLA_TRY(optla_figure_hold_(figure, rig, destroy_rig));
	} else
		OPTLA_TRY(optla_lab_ball_(figure, &rig));
	return rig ? recorded_section(figure, rig, page->sensor, page->rig_path || !page->known ? &unknown : &ball) : OPTLA_OK;
}

enum { CORNER, RECORDED, SECTIONS };
static const optla_page_entry entries[SECTIONS] = {{"corner", "A corner with inter-reflections"}, {"recorded", "Real photos"}};

static optla_status section(demo_page *page, int which)
{
	static const demo_expect corner = {.capture_error = 0.08, .capture_over_best = 2, .relit_psnr_db = 28, .inverse_error = 0.04};
	optla_figure figure;
	const optla_reproduce_options options = {
	    .size = sizeof options, .out_dir = page->dir, .data_dir = page->run->shared.data, .seed = page->run->shared.seed};
	const double began_s = optla_now_s_();
	OPTLA_TRY(optla_figure_init_(&figure, page->run->ctx, entries[which].id, entries[which].title, &options));
	cli_say(page->run, "%s\n", entries[which].title);
	optla_status status =
	    which == CORNER ? corner_section(&figure, page->sensor, page->known ? &corner : &unknown) : recorded(page, &figure);
	if (!status) status = optla_page_save_section_(&figure, optla_now_s_() - began_s);
	if (!status) take_numbers(page, &figure);
	optla_figure_clear_(&figure);
	return status;
}

static optla_status write_page(demo_page *page)
{
	const bool photos = page->rig_path || page->run->shared.data;
	OPTLA_TRY(section(page, CORNER));
	if (photos) OPTLA_TRY(section(page, RECORDED));
	return optla_page_save_(
	    page->run->ctx, page->dir, "Optla: light transport as linear algebra",
	    "A scene that a projector lights and a camera sees is a matrix T that multiplies: photo = T × pattern. One "
	    "can compute with T without knowing it, for each photo is a product. Everything on this page was made by "
	    "<code>optla demo</code> from photos that went through the model of a real camera's sensor: noise, "
	    "quantisation, saturation.",
	    entries, photos ? 2 : 1);
}

static optla_status run_demo(cli_run *run)
{
	const demo_options *o = run->options;
	demo_page page = {.run = run,
	                  .dir = run->shared.out ? run->shared.out : "out/demo",
	                  .sensor = o->sensor,
	                  .rig_path = run->narguments ? run->arguments[0] : NULL,
	                  .known = !cli_given(run, "sensor"),
	                  .sections = json_object()};
	json_object_set_new(run->numbers, "sections", page.sections);
	if (!optla_sensor_preset(o->sensor))
		return cli_fail(run, OPTLA_ERR_ARG, "option 'sensor': there is no sensor '%s' ('optla help demo' lists them)", o->sensor);
	OPTLA_TRY(write_page(&page));
	cli_text(run, "page", page.dir);
	cli_number(run, "not_ok", (double)page.failed);
	cli_say(run, "The page is %s/index.html\n", page.dir);
	run->failed = page.failed > 0;
	if (page.failed) optla_log_(run->ctx, 0, "%zu numbers are not within their range, see the page", page.failed);
	return OPTLA_OK;
}

static const cli_argument arguments[] = {
    {"RIG", "A recorded rig to show as well; without it, and with --data, the photos of a ball in DIR/diligent-ball.", true,
     false}};
static const cli_group groups[] = {{&demo_table, 0, NULL, "Options"}};
static const cli_topic topics[] = {{"Sensors", optla_sensor_preset_name}};
static const cli_example examples[] = {
    {"optla demo", "Takes no files and some seconds; writes out/demo/index.html."},
    {"optla demo --data ../shared/data -o out/ball", "On real photos too."},
};

const cli_verb cli_verb_demo = {
    .name = "demo",
    .summary = "show what Optla does, on a page with pictures",
    .description = "Captures the light transport of a built-in scene through a simulated sensor, relights it, finds hidden "
                   "lights, swaps camera and "
                   "projector; with photos at hand it does the same on those. Writes pictures, curves and a page.\n\n"
                   "Exit status 1 if a result is worse than it should be (with the default sensor).",
    .out = "Folder of the page (default: out/demo).",
    .arguments = arguments,
    .narguments = CLI_COUNT(arguments),
    .options_size = sizeof(demo_options),
    .groups = groups,
    .ngroups = CLI_COUNT(groups),
    .topics = topics,
    .ntopics = CLI_COUNT(topics),
    .examples = examples,
    .nexamples = CLI_COUNT(examples),
    .run = run_demo,
};
