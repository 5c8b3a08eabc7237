/* SPDX-License-Identifier: BSD-3-Clause */
#include "render/form_factor.h"

#include <math.h>

#define TWO_PI 6.28318530717958647692

/* Sum over the 16 pairs of limits with sign (-1)^(i+j+k+l) of a function of the pair in a and the pair in b. */
static double alternate(double (*g)(double, double, double, double, double), const double a1[2], const double b1[2],
                        const double a2[2], const double b2[2], double distance)
{
	double sum = 0;
	for (int i = 0; i < 2; i++)
		for (int j = 0; j < 2; j++)
			for (int k = 0; k < 2; k++)
				for (int l = 0; l < 2; l++)
					sum +=
					    (i + j + k + l) % 2 ? -g(a1[i], b1[j], a2[k], b2[l], distance) : g(a1[i], b1[j], a2[k], b2[l], distance);
	return sum / TWO_PI;
}

/* d √s atan(d/√s) - (s - d²) ln(s + d²)/4, s = a1² + a2², d = b1 - b2; both limits at 0 are 0 in the sum. */
static double perpendicular_term(double a1, double b1, double a2, double b2, double unused)
{
	(void)unused;
	const double s = a1 * a1 + a2 * a2, d = b1 - b2, q = s + d * d, root = sqrt(s);
	const double angle = root > 0 ? d * root * atan(d / root) : 0;
	return q > 0 ? angle - (s - d * d) * log(q) / 4 : 0;
}

double optla_exchange_perpendicular_(const double a1[2], const double b1[2], const double a2[2], const double b2[2])
{
	return alternate(perpendicular_term, a1, b1, a2, b2, 0);
}

/* p √(q²+z²) atan(p/√(q²+z²)) + q √(p²+z²) atan(q/√(p²+z²)) - z² ln(p²+q²+z²)/2, p = a1 - a2, q = b1 - b2 */
static double parallel_term(double a1, double b1, double a2, double b2, double z)
{
	const double p = a1 - a2, q = b1 - b2, rp = sqrt(p * p + z * z), rq = sqrt(q * q + z * z);
	return p * rq * atan(p / rq) + q * rp * atan(q / rp) - z * z / 2 * log(p * p + q * q + z * z);
}

double optla_exchange_parallel_(const double a1[2], const double b1[2], const double a2[2], const double b2[2], double distance_m)
{
	return alternate(parallel_term, a1, b1, a2, b2, distance_m);
}

double optla_point_parallel_(double a, double b, double c)
{
	const double ra = sqrt(c * c + a * a), rb = sqrt(c * c + b * b);
	return (a / ra * atan(b / ra) + b / rb * atan(a / rb)) / TWO_PI;
}

/* (1/π) ∫∫ h c / (c² + s² + h²)² dh ds, integrated over h first */
double optla_point_perpendicular_(double height, double side, double c)
{
	const double r = sqrt(c * c + height * height);
	return (atan(side / c) - c / r * atan(side / r)) / TWO_PI;
}
