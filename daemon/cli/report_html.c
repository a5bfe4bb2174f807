/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "report_html.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "report_assets.h"

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

bool html_data(FILE *out, const char *path, const char *type, const char *before)
{
	FILE *in = fopen(path, "re");
	if (!in)
		return false;
	fprintf(out, "%sdata:%s;base64,", before, type);
	put_base64(out, in);
	fclose(in);
	return true;
}

bool html_image(FILE *out, const char *path, const char *type, const char *description, const char *attributes)
{
	char before[128];
	snprintf(before, sizeof(before), "<img %s src=\"", attributes);
	if (!html_data(out, path, type, before))
		return false;
	fputs("\" alt=\"", out);
	html_text(out, description);
	fputs("\">", out);
	return true;
}

/* What a data: address in an attribute cannot hold as it is; a browser would drop line ends. */
static void put_svg_byte(FILE *out, int byte)
{
	switch (byte) {
	case '%':
		fputs("%25", out);
		break;
	case '#':
		fputs("%23", out);
		break;
	case '"':
		fputs("%22", out);
		break;
	case '&':
		fputs("&amp;", out);
		break;
	case '\n':
	case '\r':
	case '\t':
		fputc(' ', out);
		break;
	default:
		fputc(byte, out);
	}
}

bool html_svg(FILE *out, const char *path, const char *description)
{
	FILE *in = fopen(path, "re");
	if (!in)
		return false;
	fputs("<img decoding=\"async\" src=\"data:image/svg+xml,", out);
	for (int byte; (byte = fgetc(in)) != EOF;)
		put_svg_byte(out, byte);
	fclose(in);
	fputs("\" alt=\"", out);
	html_text(out, description);
	fputs("\">", out);
	return true;
}

void html_json_text(FILE *out, const char *text)
{
	fputc('"', out);
	for (; *text; text++) {
		const unsigned char byte = (unsigned char)*text;
		if (byte < 0x20 || strchr("\"\\<>&", byte))
			fprintf(out, "\\u%04x", byte);
		else
			fputc(byte, out);
	}
	fputc('"', out);
}

void html_table_begin(FILE *out, const char *label)
{
	fputs("<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"", out);
	html_text(out, label);
	fputs("\"><table>", out);
}

void html_table_end(FILE *out)
{
	fputs("</table></div>\n", out);
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
	fputs("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
		  "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>",
		  out);
	html_text(out, title);
	fprintf(out, "</title>\n<style>\n%s</style></head>\n<body>\n<h1>", report_page_css);
	html_text(out, title);
	fputs("</h1>\n", out);
}

void html_end(FILE *out)
{
	fputs("</body></html>\n", out);
}
