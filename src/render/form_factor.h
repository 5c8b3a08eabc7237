/* SPDX-License-Identifier: BSD-3-Clause */
/* Closed forms of diffuse exchange between rectangles whose sides follow the same axes.
   J. R. Ehlert, T. F. Smith, View factors for perpendicular and parallel rectangular plates, J. Thermophysics and Heat Transfer 7
   (1993); J. R. Howell, A Catalog of Radiation Heat Transfer Configuration Factors, B-3, B-4, C-11 to C-15. */
#ifndef OPTLA_FORM_FACTOR_H
#define OPTLA_FORM_FACTOR_H

/* Extents are {lower, upper} in metres. Results are exchange areas A_1 F_12 = A_2 F_21, in m². */

/* Planes that meet at a right angle in a line: a is the extent of either rectangle away from that line (>= 0), b along it. */
double optla_exchange_perpendicular_(const double a1[2], const double b1[2], const double a2[2], const double b2[2]);
/* Parallel planes at a distance > 0 that face each other. */
double optla_exchange_parallel_(const double a1[2], const double b1[2], const double a2[2], const double b2[2],
                                double distance_m);

/* Form factors F from a surface element at the origin to a rectangle: E = F B is the irradiance it gets from exitance B. */

/* Rectangle [0, a] x [0, b] parallel to the element, at a distance > 0. Odd in a and in b: other rectangles are sums over corners. */
double optla_point_parallel_(double a, double b, double distance_m);
/* Rectangle [0, height] x [0, side] in a plane perpendicular to the element's, at a distance > 0; height: along the element's normal
   (>= 0). Odd in side. */
double optla_point_perpendicular_(double height, double side, double distance_m);

#endif
