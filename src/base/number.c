/* SPDX-License-Identifier: BSD-3-Clause */
/* Numbers in files and options have a decimal point, whatever locale the program has chosen. */
#include "base_impl.h"

#include <locale.h>
#include <stdlib.h>

double optla_strtod_(const char *text, char **end)
{
	*end = (char *)text;
	const locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0);
	if (!c) return 0;
	const locale_t old = uselocale(c); /* of this thread alone */
	const double value = strtod(text, end);
	uselocale(old);
	freelocale(c);
	return value;
}

void optla_double_text_(double value, int digits, char *text, size_t bytes)
{
	snprintf(text, bytes, "%.*g", digits, value);
	for (char *c = text; *c; c++) /* the only other character that a number in "%g" holds is the locale's point */
		if (',' == *c) *c = '.';
}
