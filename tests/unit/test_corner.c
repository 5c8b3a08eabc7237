/* SPDX-License-Identifier: BSD-3-Clause */
/* The analytic corner against published form factors, conservation of energy, the white furnace and brute-force sums. */
#include "near.h"
#include "optla/rig.h"
#include "render/corner_impl.h"
#include "render/form_factor.h"
#include "render/radiosity.h"

#define PI 3.14159265358979323846

static const double unit[2] = {0, 1};

START_TEST(published_form_factors)
{
	/* Unit cube: opposite faces 0.199825, adjacent 0.200044 (Howell, C-11 and C-14 with X = Y = 1, H = W = 1). */
	near_abs(optla_exchange_parallel_(unit, unit, unit, unit, 1), 0.199825, 5e-7);
	near_abs(optla_exchange_perpendicular_(unit, unit, unit, unit), 0.200044, 5e-7);
	/* C-11 in its closed form, X = 2, Y = 0.5: a wall of 2 x 0.5 at distance 1. */
	const double X = 2, Y = 0.5, wide[2] = {0, X}, high[2] = {0, Y}, x2 = sqrt(1 + X * X), y2 = sqrt(1 + Y * Y);
	const double f =
	    2 / (PI * X * Y) *
	    (log(x2 * y2 / sqrt(1 + X * X + Y * Y)) + X * y2 * atan(X / y2) + Y * x2 * atan(Y / x2) - X * atan(X) - Y * atan(Y));
	near_rel(optla_exchange_parallel_(wide, high, wide, high, 1) / (X * Y), f, 1e-13);
	/* C-14 in its closed form, H = 0.7, W = 1.3. */
	const double H = 0.7, W = 1.3, tall[2] = {0, H}, deep[2] = {0, W}, h2 = H * H, w2 = W * W, s = sqrt(h2 + w2);
	const double g = (W * atan(1 / W) + H * atan(1 / H) - s * atan(1 / s) +
	                  0.25 * (log((1 + w2) * (1 + h2) / (1 + w2 + h2)) + w2 * log(w2 * (1 + w2 + h2) / ((1 + w2) * (w2 + h2))) +
	                          h2 * log(h2 * (1 + h2 + w2) / ((1 + h2) * (h2 + w2))))) /
	                 PI; /* W F */
	near_rel(optla_exchange_perpendicular_(deep, unit, tall, unit), g, 1e-13);
}
END_TEST

START_TEST(form_factors_are_the_integrals)
{
	/* Rectangles that don't touch: midpoint sums over 24^4 pairs; error h²/24 times second derivatives of the size of 1/distance². */
	const double a1[2] = {0.2, 0.5}, b1[2] = {-0.3, 0.4}, a2[2] = {0.3, 0.9}, b2[2] = {0.6, 1.1}, z = 0.8;
	enum { N = 24 };
	double perpendicular = 0, parallel = 0;
	for (int i = 0; i < N; i++)
		for (int j = 0; j < N; j++)
			for (int k = 0; k < N; k++)
				for (int l = 0; l < N; l++) {
					const double p = a1[0] + (i + 0.5) / N * (a1[1] - a1[0]), q = b1[0] + (j + 0.5) / N * (b1[1] - b1[0]),
					             r = a2[0] + (k + 0.5) / N * (a2[1] - a2[0]), t = b2[0] + (l + 0.5) / N * (b2[1] - b2[0]);
					const double d2 = p * p + r * r + (q - t) * (q - t), e2 = (p - r) * (p - r) + (q - t) * (q - t) + z * z;
					perpendicular += p * r / (PI * d2 * d2);
					parallel += z * z / (PI * e2 * e2);
				}
	const double cell = (a1[1] - a1[0]) * (b1[1] - b1[0]) * (a2[1] - a2[0]) * (b2[1] - b2[0]) / pow(N, 4);
	near_rel(optla_exchange_perpendicular_(a1, b1, a2, b2), perpendicular * cell, 1e-3);
	near_rel(optla_exchange_parallel_(a1, b1, a2, b2, z), parallel * cell, 1e-3);
	near_rel(optla_exchange_perpendicular_(a2, b2, a1, b1), optla_exchange_perpendicular_(a1, b1, a2, b2), 1e-12);
	near_rel(optla_exchange_parallel_(a2, b2, a1, b1, z), optla_exchange_parallel_(a1, b1, a2, b2, z), 1e-12);

	/* A point is the limit of a small rectangle: h = 1e-3, relative error of the order of h². */
	const double h = 1e-3, small[2] = {-h / 2, h / 2}, to_a[2] = {0, 0.7}, to_b[2] = {0, 0.4};
	near_rel(optla_point_parallel_(0.7, 0.4, z), optla_exchange_parallel_(small, small, to_a, to_b, z) / (h * h), 1e-5);
	const double small_z[2] = {z - h / 2, z + h / 2};
	near_rel(optla_point_perpendicular_(0.7, 0.4, z), optla_exchange_perpendicular_(small_z, small, to_a, to_b) / (h * h), 1e-5);
	near_rel(optla_point_parallel_(1e6, 1e6, z), 0.25, 1e-5); /* a quarter of the half space */
	near_rel(optla_point_perpendicular_(1e6, 1e6, z), 0.25, 1e-5);
}
END_TEST

/* The six walls of a unit box, n x n patches each: exchange areas by the closed forms. Wall w: axis w / 2, at w % 2. */
static void box_exchange(int n, double *exchange)
{
	const int count = 6 * n * n;
	for (int i = 0; i < count; i++)
		for (int j = 0; j < count; j++) {
			const int wall[2] = {i / (n * n), j / (n * n)}, cell[2] = {i % (n * n), j % (n * n)};
			double lo[2][3], hi[2][3];
			for (int k = 0; k < 2; k++) {
				const int axis = wall[k] / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
				lo[k][axis] = hi[k][axis] = wall[k] % 2;
				lo[k][u] = (double)(cell[k] % n) / n;
				lo[k][v] = (double)(cell[k] / n) / n;
				hi[k][u] = lo[k][u] + 1.0 / n;
				hi[k][v] = lo[k][v] + 1.0 / n;
			}
			const int a = wall[0] / 2, b = wall[1] / 2;
			double *out = &exchange[j * count + i];
			*out = 0;
			if (wall[0] == wall[1]) continue;
			if (a == b) {
				const int u = (a + 1) % 3, v = (a + 2) % 3;
				const double e[4][2] = {{lo[0][u], hi[0][u]}, {lo[0][v], hi[0][v]}, {lo[1][u], hi[1][u]}, {lo[1][v], hi[1][v]}};
				*out = optla_exchange_parallel_(e[0], e[1], e[2], e[3], 1);
				continue;
			}
			/* distance of i from wall j along b, of j from wall i along a */
			const int c = 3 - a - b;
			const double wj = wall[1] % 2, wi = wall[0] % 2;
			const double ei[2] = {fmin(fabs(lo[0][b] - wj), fabs(hi[0][b] - wj)), fmax(fabs(lo[0][b] - wj), fabs(hi[0][b] - wj))};
			const double ej[2] = {fmin(fabs(lo[1][a] - wi), fabs(hi[1][a] - wi)), fmax(fabs(lo[1][a] - wi), fabs(hi[1][a] - wi))};
			const double ci[2] = {lo[0][c], hi[0][c]}, cj[2] = {lo[1][c], hi[1][c]};
			*out = optla_exchange_perpendicular_(ei, ci, ej, cj);
		}
}

START_TEST(white_furnace)
{
	enum { N = 4, P = 6 * N * N };
	static double exchange[P * P], area[P], albedo[P], flux[P], exitance[P];
	optla_ctx *ctx = test_ctx(NULL, 1);
	box_exchange(N, exchange);
	for (int i = 0; i < P; i++) { /* a closed box sees only itself: rows sum to the area; 96 sums of 16 terms of rounding 1e-16 */
		double sum = 0;
		for (int j = 0; j < P; j++) sum += exchange[j * P + i];
		area[i] = 1.0 / (N * N);
		near_rel(sum, area[i], 1e-11);
	}
	const double rhos[] = {0.1, 0.5, 0.9};
	for (int k = 0; k < 3; k++) { /* irradiance 1 everywhere: exitance ρ + ρ² + ... = ρ/(1-ρ) */
		for (int i = 0; i < P; i++) {
			albedo[i] = rhos[k];
			flux[i] = area[i];
		}
		ok(optla_radiosity_solve_(ctx, exchange, area, albedo, P, flux, 1, exitance));
		for (int i = 0; i < P; i++) near_rel(exitance[i], rhos[k] / (1 - rhos[k]), 1e-10);
	}
	/* One bounce alone: albedo 1e-6, patch 3 lit. The second bounce is 1e-6 of the first. */
	for (int i = 0; i < P; i++) {
		albedo[i] = 1e-6;
		flux[i] = i == 3;
	}
	ok(optla_radiosity_solve_(ctx, exchange, area, albedo, P, flux, 1, exitance));
	near_rel(exitance[3], 1e-6 / area[3], 1e-10);
	for (int i = 0; i < P; i++)
		if (i != 3) near_abs(exitance[i], 1e-12 * exchange[3 * P + i] / area[i] / area[3], 1e-12 * 1e-4);
	for (int i = 0; i < P; i++) albedo[i] = i % 2 ? 0 : 1; /* black patches are no special case */
	ok(optla_radiosity_solve_(ctx, exchange, area, albedo, P, flux, 1, exitance));
	ck_assert_double_eq(exitance[1], 0);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(corner_keeps_energy)
{
	/* One watt on any patch: absorbed + escaped through the open side = 1. */
	optla_ctx *ctx = test_ctx(NULL, 2);
	optla_corner_desc d = optla_corner_defaults_;
	d.patches = 6;
	optla_corner c;
	optla_corner_init_(&d, &c);
	const size_t n = c.npatches;
	double *exchange = malloc(n * n * sizeof *exchange), *exitance = malloc(n * n * sizeof *exitance),
	       *flux = calloc(n * n, sizeof *flux), *area = malloc(n * sizeof *area), *albedo = malloc(n * sizeof *albedo);
	optla_corner_exchange_(ctx, &c, exchange);
	for (size_t i = 0; i < n; i++) {
		area[i] = optla_patch_area_(&c);
		albedo[i] = d.albedo[c.walls[i / 36]][1];
		flux[i * n + i] = 1;
	}
	ok(optla_radiosity_solve_(ctx, exchange, area, albedo, n, flux, n, exitance));
	for (size_t j = 0; j < n; j++) {
		double absorbed = 0, escaped = 0;
		for (size_t i = 0; i < n; i++) {
			const double out = exitance[j * n + i] * area[i];
			double seen = 0;
			for (size_t k = 0; k < n; k++) seen += exchange[k * n + i] / area[i];
			ck_assert_double_lt(seen, 1);
			absorbed += out * (1 - albedo[i]) / albedo[i];
			escaped += out * (1 - seen);
			/* reciprocity: (I - R F)⁻¹ R A⁻¹ is symmetric */
			near_rel(exitance[j * n + i], exitance[i * n + j], 1e-11);
		}
		near_rel(absorbed + escaped, 1, 1e-11);
	}
	/* What the open faces of the cube take: rows sum to the patch's area with them. */
	for (size_t i = 0; i < n; i++) {
		double extent[2][2], sum = 0;
		(void)optla_patch_extent_(&c, i, extent);
		for (size_t k = 0; k < n; k++) {
			ck_assert(exchange[k * n + i] == exchange[i * n + k]);
			sum += exchange[k * n + i];
		}
		const double far0[2] = {1 - extent[0][1], 1 - extent[0][0]}, far1[2] = {1 - extent[1][1], 1 - extent[1][0]};
		sum += optla_exchange_parallel_(extent[0], extent[1], unit, unit, 1) +
		       optla_exchange_perpendicular_(far0, extent[1], unit, unit) +
		       optla_exchange_perpendicular_(far1, extent[0], unit, unit);
		near_rel(sum, area[i], 1e-11);
	}
	free(albedo);
	free(area);
	free(flux);
	free(exitance);
	free(exchange);
	optla_ctx_destroy(&ctx);
}
END_TEST

static optla_corner_desc small_corner(size_t camera, size_t projector)
{
	optla_corner_desc d = optla_corner_defaults_;
	d.camera.width = camera;
	d.camera.height = camera + 2;
	d.projector.width = projector;
	d.projector.height = projector - 1;
	d.patches = 5;
	return d;
}

static double *matrix(optla_ctx *ctx, const optla_corner_desc *d, unsigned parts)
{
	double *t = malloc(3 * optla_corner_npixels_(d) * optla_corner_nlights_(d) * sizeof *t);
	ok(optla_corner_matrix_(ctx, d, parts, t));
	return t;
}

/* Direct light by S x S rays for each projector pixel, each carrying its share of the pixel's energy: green. */
static void brute_direct(const optla_corner_desc *d, int S, double *t)
{
	optla_pinhole cam, proj;
	optla_pinhole_init_(&d->camera, &cam);
	optla_pinhole_init_(&d->projector, &proj);
	const size_t npix = optla_corner_npixels_(d), nl = optla_corner_nlights_(d);
	double largest = 0;
	memset(t, 0, npix * nl * sizeof *t);
	for (size_t n = 0; n < nl; n++) {
		double energy = 0;
		for (int s = 0; s < S * S; s++) {
			const double uv[2] = {(double)(n % proj.width) - 0.5 + (s % S + 0.5) / S,
			                      (double)(n / proj.width) - 0.5 + (s / S + 0.5) / S};
			const double share = pow(optla_pinhole_cosine_(&proj, uv), 4) / (S * S);
			energy += share;
			double ray[3], best = INFINITY;
			int wall = -1;
			optla_pinhole_ray_(&proj, uv, ray);
			for (int w = 0; w < OPTLA_WALLS; w++) {
				const int a = optla_wall_normal_[w];
				const double along = -proj.position_m[a] / ray[a];
				if (d->wall[w] && along > 0 && along < best) best = along, wall = w;
			}
			if (wall < 0) continue;
			double x[3], to[3], r2 = 0, image[2], depth;
			bool inside = true;
			for (int k = 0; k < 3; k++) {
				x[k] = proj.position_m[k] + best * ray[k];
				inside = inside && x[k] < 1 && x[k] > -1e-9;
				to[k] = cam.position_m[k] - x[k];
				r2 += to[k] * to[k];
			}
			optla_pinhole_project_(&cam, x, image, &depth);
			const double px = floor(image[0] + 0.5), py = floor(image[1] + 0.5);
			if (!inside || px < 0 || py < 0 || px >= (double)cam.width || py >= (double)cam.height) continue;
			const double cos_surface = fabs(to[optla_wall_normal_[wall]]) / sqrt(r2), cos_camera = depth / sqrt(r2);
			t[n * npix + (size_t)py * cam.width + (size_t)px] +=
			    share * d->albedo[wall][1] / PI * cos_surface * PI / 4 * d->pupil_m * d->pupil_m * cos_camera / r2;
		}
		largest = fmax(largest, energy);
	}
	for (size_t k = 0; k < npix * nl; k++) t[k] /= largest;
}

START_TEST(direct_light_is_that_of_rays)
{
	optla_ctx *ctx = test_ctx(NULL, 2);
	const optla_corner_desc d = small_corner(9, 7);
	const size_t npix = optla_corner_npixels_(&d), nl = optla_corner_nlights_(&d);
	enum { S = 300 };
	double *t = matrix(ctx, &d, OPTLA_CORNER_DIRECT), *want = malloc(npix * nl * sizeof *want), scale = 0;
	brute_direct(&d, S, want);
	for (size_t k = 0; k < npix * nl; k++) scale = fmax(scale, want[k]);
	for (size_t n = 0; n < nl; n++) {
		double sum = 0, want_sum = 0;
		for (size_t m = 0; m < npix; m++) {
			/* A border of the footprint is missed by up to half a row of rays: four borders, 1/S each. */
			near_abs(t[(n * 3 + 1) * npix + m], want[n * npix + m], scale * 4 / S);
			sum += t[(n * 3 + 1) * npix + m];
			want_sum += want[n * npix + m];
		}
		near_abs(sum, want_sum, scale * 2 / S); /* only borders of walls and of the image remain */
		ck_assert_double_le(sum, 1);
	}
	free(want);
	free(t);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(direct_light_of_one_small_pixel_is_the_closed_form)
{
	/* A projector of one narrow pixel straight onto the back wall: T = ρ/π cosθ A cosα / r², energy 1, up to (0.1°)². */
	optla_ctx *ctx = test_ctx(NULL, 1);
	optla_corner_desc d = optla_corner_defaults_;
	d.projector = (optla_pinhole_desc){{0.5, 0.6, 1.5}, {0.5, 0.6, 0}, {0, 1, 0}, 0.1, 1, 1};
	d.camera = (optla_pinhole_desc){{0.9, 0.8, 2.0}, {0.5, 0.6, 0}, {0, 1, 0}, 40, 1, 1};
	/* the field of view of one pixel leaves wall corners beside it but not behind */
	double *t = matrix(ctx, &d, OPTLA_CORNER_DIRECT);
	const double r2 = 0.16 + 0.04 + 4, want = 0.80 / PI * 2 / sqrt(r2) * PI / 4 * 0.025 * 0.025 / r2;
	for (int c = 0; c < 3; c++) near_rel(t[c], want, 1e-5);
	free(t);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(bounced_light_adds_up_to_whole_walls)
{
	/* A projector that sees every wall whole cuts each into pieces; with an even density their exchange with a camera's piece must add
	   up to that piece's form factor to the wall, which has a closed form. Pieces that touch across an edge are among them. */
	optla_ctx *ctx = test_ctx(NULL, 2);
	optla_corner_desc d = small_corner(24, 40);
	d.projector.field_of_view_deg = 60;
	optla_corner c;
	optla_pieces camera = {0}, projector = {0};
	optla_corner_init_(&d, &c);
	ok(optla_pieces_cut_(ctx, &c, &c.camera, &camera));
	ok(optla_pieces_cut_(ctx, &c, &c.projector, &projector));
	double area[OPTLA_WALLS] = {0, 0, 0}, all = 0, all_want = 0, worst = 0;
	for (size_t j = 0; j < projector.npieces; j++) area[projector.pieces[j].wall] += projector.pieces[j].area_m2;
	for (int w = 0; w < OPTLA_WALLS; w++) near_rel(area[w], 1, 1e-12);
	for (size_t i = 0; i < camera.npieces; i++)
		for (int w = 0; w < OPTLA_WALLS; w++) {
			const optla_piece *p = &camera.pieces[i];
			if (w == p->wall) continue;
			double got = 0, want = 0;
			for (size_t j = 0; j < projector.npieces; j++) {
				const optla_piece *q = &projector.pieces[j];
				if (q->wall == w) got += optla_pieces_exchange_(&camera, p, &projector, q) * q->area_m2 / q->whole.weight;
			}
			const int np = optla_wall_normal_[p->wall], nw = optla_wall_normal_[w], side = 3 - np - nw;
			for (size_t k = p->first; k < p[1].first; k++) {
				const double *x = camera.fine[k].x;
				want += camera.fine[k].weight *
				        (optla_point_perpendicular_(1, 1 - x[side], x[nw]) - optla_point_perpendicular_(1, -x[side], x[nw]));
			}
			all += got;
			all_want += want;
			worst = fmax(worst, fabs(got / want - 1));
		}
	/* Next to an edge the integrand has a corner, which 16 points see to a few per cent; everywhere else, and in the sum, errors are
	   (radius/distance)² / 4 of one pair and of both signs. */
	printf("# bounced light: worst piece off by %.5f, all by %.5f\n", worst, fabs(all / all_want - 1));
	ck_assert_double_lt(worst, 0.05);
	ck_assert_double_lt(fabs(all / all_want - 1), 0.005);
	optla_pieces_free_(ctx, &projector);
	optla_pieces_free_(ctx, &camera);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(gathered_light_adds_up_to_whole_walls)
{
	/* F from a point to all patches of a wall is F to the wall: one patch or many make no difference. */
	optla_ctx *ctx = test_ctx(NULL, 2);
	optla_corner_desc d = small_corner(5, 4);
	const size_t npix = optla_corner_npixels_(&d);
	double sum[2][35];
	for (int k = 0; k < 2; k++) {
		optla_corner c;
		optla_pieces camera = {0};
		d.patches = k ? 7 : 1;
		optla_corner_init_(&d, &c);
		ok(optla_pieces_cut_(ctx, &c, &c.camera, &camera));
		double *gather = malloc(npix * c.npatches * sizeof *gather);
		optla_corner_gather_(ctx, &c, &camera, npix, 1, 2, gather);
		for (size_t m = 0; m < npix; m++) {
			sum[k][m] = 0;
			for (size_t a = 0; a < c.npatches; a++) {
				ck_assert_double_ge(gather[m * c.npatches + a], -1e-15);
				sum[k][m] += gather[m * c.npatches + a];
			}
		}
		free(gather);
		optla_pieces_free_(ctx, &camera);
	}
	near_array(sum[1], sum[0], npix, 1e-13);
	optla_ctx_destroy(&ctx);
}
END_TEST

/* ||a - b|| / ||b|| */
static double distance(const double *a, const double *b, size_t n)
{
	double d = 0, s = 0;
	for (size_t k = 0; k < n; k++) {
		d += (a[k] - b[k]) * (a[k] - b[k]);
		s += b[k] * b[k];
	}
	return sqrt(d / s);
}

START_TEST(indirect_light_converges_with_the_patches)
{
	optla_ctx *ctx = test_ctx(NULL, 2);
	optla_corner_desc d = small_corner(16, 12);
	double *t[3], *sum[3];
	const size_t npix = optla_corner_npixels_(&d), nl = optla_corner_nlights_(&d), count = 3 * npix * nl, patches[3] = {4, 8, 16};
	for (int k = 0; k < 3; k++) {
		d.patches = patches[k];
		t[k] = matrix(ctx, &d, OPTLA_CORNER_INDIRECT);
		sum[k] = calloc(3 * npix, sizeof *sum[k]);
		for (size_t i = 0; i < count; i++) sum[k][i % (3 * npix)] += t[k][i];
	}
	const double first = distance(t[0], t[1], count), second = distance(t[1], t[2], count);
	const double first_sum = distance(sum[0], sum[1], 3 * npix), second_sum = distance(sum[1], sum[2], 3 * npix);
	printf("# 4 to 8 patches: T %.4f, T1 %.4f; 8 to 16: T %.4f, T1 %.4f\n", first, first_sum, second, second_sum);
	/* Constants over patches are of first order in their size for light that arrives near an edge, of second order elsewhere, and T1 is
	   all of it smoothed. */
	ck_assert_double_lt(second, 0.7 * first);
	ck_assert_double_lt(second, 0.06);
	ck_assert_double_lt(second_sum, 0.5 * first_sum);
	ck_assert_double_lt(second_sum, 0.01);
	for (int k = 0; k < 3; k++) {
		free(sum[k]);
		free(t[k]);
	}
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(coaxial_transport_is_symmetric)
{
	optla_ctx *ctx = test_ctx(NULL, 2);
	optla_corner_desc d = small_corner(10, 8);
	d.coaxial = true;
	const size_t n = optla_corner_npixels_(&d);
	ck_assert_uint_eq(n, optla_corner_nlights_(&d));
	double *t = matrix(ctx, &d, OPTLA_CORNER_DIRECT | OPTLA_CORNER_INDIRECT), *direct = matrix(ctx, &d, OPTLA_CORNER_DIRECT);
	for (size_t c = 0; c < 3; c++)
		for (size_t j = 0; j < n; j++)
			for (size_t i = 0; i < n; i++) {
				ck_assert(t[j * 3 * n + c * n + i] == t[i * 3 * n + c * n + j]);
				/* no direct light leaves its pixel: camera and projector borders are the same */
				if (i != j) ck_assert_double_eq(direct[j * 3 * n + c * n + i], 0);
			}
	/* Without the symmetrising step the formulas are symmetric to rounding: the same corner as a stereo pair in one place. */
	optla_corner_desc pair = d;
	pair.coaxial = false;
	pair.projector = pair.camera;
	double *p = matrix(ctx, &pair, OPTLA_CORNER_DIRECT | OPTLA_CORNER_INDIRECT);
	ck_assert_double_lt(distance(p, t, 3 * n * n), 1e-13);
	free(p);
	free(direct);
	free(t);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(reciprocity_of_swapped_places)
{
	/* Camera and projector change places: T' = Tᵀ up to one factor, the ratio of what pupils and powers were normalised to. */
	optla_ctx *ctx = test_ctx(NULL, 2);
	const optla_corner_desc d = small_corner(9, 7);
	optla_corner_desc e = d;
	e.camera = d.projector;
	e.projector = d.camera;
	const size_t m = optla_corner_npixels_(&d), n = optla_corner_nlights_(&d);
	double *t = matrix(ctx, &d, 3), *u = matrix(ctx, &e, 3);
	double tu = 0, uu = 0;
	for (size_t j = 0; j < n; j++)
		for (size_t i = 0; i < m; i++) {
			const double a = t[(j * 3 + 2) * m + i], b = u[(i * 3 + 2) * n + j];
			tu += a * b;
			uu += b * b;
		}
	double worst = 0, scale = 0;
	for (size_t j = 0; j < n; j++)
		for (size_t i = 0; i < m; i++) {
			worst = fmax(worst, fabs(t[(j * 3 + 2) * m + i] - tu / uu * u[(i * 3 + 2) * n + j]));
			scale = fmax(scale, t[(j * 3 + 2) * m + i]);
		}
	/* direct light is integrated on the other image plane now: quadrature of degree 5 on pieces up to 15 cm */
	ck_assert_msg(worst < 1e-6 * scale, "off by %g of the largest", worst / scale);
	free(u);
	free(t);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(screen_lights_like_its_points)
{
	/* Direct light of screen patches by sums over points of the patch and of the pixel; then energy on the walls. */
	optla_ctx *ctx = test_ctx(NULL, 2);
	optla_corner_desc d = optla_corner_defaults_;
	d.camera = (optla_pinhole_desc){{0.62, 0.75, 2.3}, {0.42, 0.42, 0.2}, {0, 1, 0}, 24, 4, 4};
	d.screen_given = true;
	d.screen = (optla_screen_desc){1.3, {0.2, 0.9}, {0.1, 0.8}, 3, 2};
	d.patches = 4;
	double *t = matrix(ctx, &d, OPTLA_CORNER_DIRECT);
	optla_pinhole cam;
	optla_pinhole_init_(&d.camera, &cam);
	enum { S = 24 };
	for (size_t n = 0; n < 6; n++)
		for (size_t m = 0; m < 16; m++) {
			double sum = 0;
			for (int s = 0; s < S * S; s++) {
				const double uv[2] = {(double)(m % 4) - 0.5 + (s % S + 0.5) / S, (double)(m / 4) - 0.5 + (s / S + 0.5) / S};
				double x[3];
				int wall = -1;
				for (int w = 0; w < OPTLA_WALLS && wall < 0; w++) {
					optla_wall_hit_(&cam, w, uv, x);
					if (x[0] > -1e-12 && x[1] > -1e-12 && x[2] > -1e-12 && x[0] < 1 && x[1] < 1 && x[2] < 1) wall = w;
				}
				if (wall < 0) continue;
				double e = 0;
				for (int q = 0; q < 16; q++) {
					const double z = 0.1 + 0.7 / 3 * ((double)(n % 3) + (q % 4 + 0.5) / 4),
					             y = 0.9 - 0.35 * ((double)(n / 3) + (q / 4 + 0.5) / 4);
					const double to[3] = {1.3 - x[0], y - x[1], z - x[2]}, r2 = to[0] * to[0] + to[1] * to[1] + to[2] * to[2];
					e += to[0] * fabs(to[optla_wall_normal_[wall]]) / (PI * r2 * r2) / 16;
				}
				sum += e * d.albedo[wall][0] / PI * optla_pupil_weight_(&cam, uv) / (S * S);
			}
			sum *= PI / 4 * d.pupil_m * d.pupil_m;
			/* 4 x 4 points of a 23 x 35 cm patch at 30 cm or more: (h/r)²/24 ~ 0.4 %; wall borders inside a pixel: 1/S of the change there */
			near_rel(t[n * 48 + m], sum, 0.03);
		}
	optla_corner c;
	optla_corner_init_(&d, &c);
	double flux[6 * 48], closed[3] = {0, 0, 0};
	optla_screen_flux_(ctx, &c, flux);
	for (size_t n = 0; n < 6; n++) {
		double sum = 0;
		for (size_t a = 0; a < c.npatches; a++) sum += flux[n * c.npatches + a];
		for (size_t a = 0; a < c.npatches; a++) closed[a / 16] += flux[n * c.npatches + a] * 0.7 * 0.7 / 6;
		ck_assert(sum > 0.3 && sum < 1); /* energy that misses the walls through the open sides is lost */
	}
	const double sy[2] = {0.2, 0.9}, sz[2] = {0.1, 0.8}, away[2] = {0.3, 1.3};
	near_rel(closed[0], optla_exchange_perpendicular_(sy, sz, away, unit), 1e-11); /* floor, left, back: the whole screen */
	near_rel(closed[1], optla_exchange_parallel_(sy, sz, unit, unit, 1.3), 1e-11);
	near_rel(closed[2], optla_exchange_perpendicular_(sz, sy, away, unit), 1e-11);
	free(t);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(same_bytes_for_any_number_of_threads)
{
	optla_corner_desc d[2] = {small_corner(9, 7), small_corner(6, 5)};
	d[1].screen_given = true;
	d[1].camera = (optla_pinhole_desc){{0.62, 0.75, 2.3}, {0.42, 0.42, 0.2}, {0, 1, 0}, 24, 6, 6};
	d[1].screen = (optla_screen_desc){1.05, {0.1, 0.9}, {0.1, 0.9}, 5, 4};
	const int threads[3] = {1, 2, 7};
	for (int k = 0; k < 2; k++) {
		const size_t bytes = 3 * optla_corner_npixels_(&d[k]) * optla_corner_nlights_(&d[k]) * sizeof(double);
		double *first = NULL;
		for (int i = 0; i < 3; i++) {
			optla_ctx *ctx = test_ctx(NULL, threads[i]);
			double *t = matrix(ctx, &d[k], 3);
			if (first) ck_assert_mem_eq(t, first, bytes);
			if (first)
				free(t);
			else
				first = t;
			optla_ctx_destroy(&ctx);
		}
		free(first);
	}
}
END_TEST

static void refused(optla_ctx *ctx, error_store *e, optla_corner_desc d, const char *text)
{
	double t[1]; /* refused before it is written to */
	d.where = "r.yaml: ";
	status_is(optla_corner_matrix_(ctx, &d, 1, t), OPTLA_ERR_INPUT);
	ck_assert_msg(strstr(e->text, text) == e->text, "'%s' does not start with '%s'", e->text, text);
}

START_TEST(impossible_corners_are_refused)
{
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 1);
	const optla_corner_desc good = optla_corner_defaults_;
	optla_corner_desc d = good;
	d.wall[0] = d.wall[1] = false;
	refused(ctx, &e, d, "r.yaml: walls: a corner has two or three of floor, left, back, not 1");
	d = good;
	d.albedo[1][2] = 1.5;
	refused(ctx, &e, d, "r.yaml: walls: the albedo of 'left' is 1.5: allowed is 0 to 1");
	d = good;
	d.patches = 65;
	refused(ctx, &e, d, "r.yaml: patches is 65");
	d = good;
	d.pupil_m = 0;
	refused(ctx, &e, d, "r.yaml: pupil_m is 0 m");
	d = good;
	d.camera.position_m[1] = 0;
	refused(ctx, &e, d, "r.yaml: camera: y = 0 m is not in front of the wall 'floor'");
	d = good;
	d.projector.look_at_m[0] = 5;
	refused(ctx, &e, d, "r.yaml: projector: the corner (0, 0, 0) of the wall");
	d = good;
	memcpy(d.camera.look_at_m, d.camera.position_m, sizeof d.camera.look_at_m);
	refused(ctx, &e, d, "r.yaml: camera: it looks at its own position");
	d = good;
	for (int k = 0; k < 3; k++) d.camera.up[k] = d.camera.look_at_m[k] - d.camera.position_m[k];
	refused(ctx, &e, d, "r.yaml: camera: up");
	d = good;
	d.camera.field_of_view_deg = 171;
	refused(ctx, &e, d, "r.yaml: camera: field_of_view is 171 degrees");
	d = good;
	d.camera.width = d.camera.height = 0;
	refused(ctx, &e, d, "r.yaml: camera: size is 0 x 0");
	d = good;
	d.camera.position_m[0] = NAN;
	refused(ctx, &e, d, "r.yaml: camera: position, look_at and up must be finite");
	d = good;
	d.screen_given = true;
	d.screen = (optla_screen_desc){0.9, {0, 1}, {0, 1}, 4, 4};
	refused(ctx, &e, d, "r.yaml: screen: x is 0.9 m");
	d.screen.x_m = 1.05;
	refused(ctx, &e, d, "r.yaml: camera: x = 1.1 m is behind the screen");
	d.screen.x_m = 1.4;
	d.camera.field_of_view_deg = 70;
	refused(ctx, &e, d, "r.yaml: the camera sees the screen itself");
	d.screen.y_m[0] = 2;
	refused(ctx, &e, d, "r.yaml: screen: y is [2, 1] m");
	d.screen.y_m[0] = 0;
	d.coaxial = true;
	refused(ctx, &e, d, "r.yaml: screen: a coaxial corner has no screen");
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(two_walls_are_a_corner_too)
{
	optla_ctx *ctx = test_ctx(NULL, 1);
	optla_corner_desc d = small_corner(6, 5);
	d.wall[OPTLA_WALL_FLOOR] = false;
	double *two = matrix(ctx, &d, 3);
	const size_t npix = optla_corner_npixels_(&d), nl = optla_corner_nlights_(&d);
	d.wall[OPTLA_WALL_FLOOR] = true;
	for (int c = 0; c < 3; c++) d.albedo[OPTLA_WALL_FLOOR][c] = 0; /* a black floor is no floor, but for what it hides: nothing */
	double *black = matrix(ctx, &d, 3);
	near_array(two, black, 3 * npix * nl, 1e-12);
	free(black);
	free(two);
	optla_ctx_destroy(&ctx);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("corner");
	TCase *t = tcase_create("corner");
	tcase_set_timeout(t, 240);
	tcase_add_test(t, published_form_factors);
	tcase_add_test(t, form_factors_are_the_integrals);
	tcase_add_test(t, white_furnace);
	tcase_add_test(t, corner_keeps_energy);
	tcase_add_test(t, direct_light_is_that_of_rays);
	tcase_add_test(t, direct_light_of_one_small_pixel_is_the_closed_form);
	tcase_add_test(t, bounced_light_adds_up_to_whole_walls);
	tcase_add_test(t, gathered_light_adds_up_to_whole_walls);
	tcase_add_test(t, indirect_light_converges_with_the_patches);
	tcase_add_test(t, coaxial_transport_is_symmetric);
	tcase_add_test(t, reciprocity_of_swapped_places);
	tcase_add_test(t, screen_lights_like_its_points);
	tcase_add_test(t, same_bytes_for_any_number_of_threads);
	tcase_add_test(t, impossible_corners_are_refused);
	tcase_add_test(t, two_walls_are_a_corner_too);
	suite_add_tcase(s, t);
	return run_suite(s);
}
