/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "report_html.h"

#include <math.h>
#include <stdint.h>

static const char style[] =
	"body{font:15px/1.45 system-ui,sans-serif;margin:2em auto;max-width:1240px;padding:0 1em;color:#1a1a1a;"
	"background:#fff}\nh1{font-size:1.7em}h2{margin-top:2.2em;border-bottom:1px solid #ccc;padding-bottom:.2em}\n"
	"table{border-collapse:collapse;margin:1em 0;font-variant-numeric:tabular-nums}\n"
	"th,td{padding:.22em .6em;text-align:right;border-bottom:1px solid #e4e4e4}\n"
	"th{border-bottom:2px solid #999;font-weight:600;vertical-align:bottom}\n"
	"td:first-child,th:first-child{text-align:left;white-space:nowrap}\n"
	"td.text{text-align:left}.best{background:#d7f0dd;font-weight:600}.bad{background:#fbe0d8}\n"
	".wide{overflow-x:auto;font-size:.85em}.wide th{max-width:6em}.note{color:#555;max-width:60em}\n"
	"figure{display:inline-block;margin:.4em .6em .6em 0;vertical-align:top}figcaption{font-size:.85em;color:#333}\n"
	"img{max-width:100%;image-rendering:auto}img.pixels{image-rendering:pixelated}\n"
	"summary{cursor:pointer;font-weight:600;margin:.6em 0}\n";

void html_text(FILE *out, const char *text)
{
	for (; *text; text++) {
		switch (*text) {
		case '&':
			fputs("&amp;", out);
			break;
		case '<':
			fputs("&lt;", out);
			break;
		case '>':
			fputs("&gt;", out);
			break;
		case '"':
			fputs("&quot;", out);
			break;
		default:
			fputc(*text, out);
		}
	}
}

/* RFC 4648, 4. */
static void put_base64(FILE *out, FILE *in)
{
	static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
	uint8_t bytes[3];
	for (size_t count = 3; count == 3;) {
		count = fread(bytes, 1, 3, in);
		if (count == 0)
			return;
		const uint32_t word = (uint32_t)bytes[0] << 16 | (count > 1 ? (uint32_t)bytes[1] << 8 : 0u) |
							  (count > 2 ? (uint32_t)bytes[2] : 0u);
		for (unsigned i = 0; i < 4; i++)
			fputc(i <= count ? digits[word >> (18 - 6 * i) & 63u] : '=', out);
	}
}

bool html_image(FILE *out, const char *path, const char *type, const char *description, const char *attributes)
{
	FILE *in = fopen(path, "re");
	if (!in)
		return false;
	fprintf(out, "<img %s alt=\"", attributes);
	html_text(out, description);
	fprintf(out, "\" src=\"data:%s;base64,", type);
	put_base64(out, in);
	fputs("\">", out);
	fclose(in);
	return true;
}

void html_number(FILE *out, double value, int digits, const char *mark)
{
	fprintf(out, "<td%s%s%s>", mark ? " class=\"" : "", mark ? mark : "", mark ? "\"" : "");
	if (isfinite(value))
		fprintf(out, "%.*f", digits, value);
	else
		fputs("–", out);
	fputs("</td>", out);
}

void html_begin(FILE *out, const char *title)
{
	fputs("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<title>", out);
	html_text(out, title);
	fprintf(out, "</title>\n<style>\n%s</style></head>\n<body>\n<h1>", style);
	html_text(out, title);
	fputs("</h1>\n", out);
}

void html_end(FILE *out)
{
	fputs("</body></html>\n", out);
}
