/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/x_mode.h"

#include <X11/extensions/Xrandr.h>
#include <math.h>

/* One output and what drives it. */
struct place {
	Display *display;
	XRRScreenResources *resources;
	XRROutputInfo *output;
	XRRCrtcInfo *crtc;
};

static double rate_of(const XRRModeInfo *info)
{
	const double pixels = (double)info->hTotal * (double)info->vTotal;
	return pixels > 0.0 ? (double)info->dotClock / pixels : 0.0;
}

static const XRRModeInfo *find_mode(const XRRScreenResources *resources, RRMode mode)
{
	for (int i = 0; i < resources->nmode; i++)
		if (resources->modes[i].id == mode)
			return &resources->modes[i];
	return NULL;
}

static bool set_mode(const struct place *place, RRCrtc crtc, RRMode mode)
{
	const XRRCrtcInfo *now = place->crtc;
	return XRRSetCrtcConfig(place->display, place->resources, crtc, CurrentTime, now->x, now->y, mode, now->rotation,
							now->outputs, now->noutput) == RRSetConfigSuccess;
}

/* A server that is gone answers nothing. */
static bool find_place(struct place *place, Display *display, RROutput output)
{
	*place = (struct place){.display = display};
	place->resources = XRRGetScreenResourcesCurrent(display, DefaultRootWindow(display));
	if (place->resources)
		place->output = XRRGetOutputInfo(display, place->resources, output);
	if (place->output && place->output->crtc)
		place->crtc = XRRGetCrtcInfo(display, place->resources, place->output->crtc);
	return place->crtc;
}

static void leave_place(struct place *place)
{
	if (place->crtc)
		XRRFreeCrtcInfo(place->crtc);
	if (place->output)
		XRRFreeOutputInfo(place->output);
	if (place->resources)
		XRRFreeScreenResources(place->resources);
}

/* Of those with the size of now; a mode of half frames or doubled lines has other rates than these. */
static const XRRModeInfo *best_mode(const struct place *place, const XRRModeInfo *now, double refresh_hz)
{
	const XRRModeInfo *best = now;
	for (int i = 0; i < place->output->nmode; i++) {
		const XRRModeInfo *info = find_mode(place->resources, place->output->modes[i]);
		if (info && info->width == now->width && info->height == now->height &&
			!(info->modeFlags & (RR_Interlace | RR_DoubleScan)) &&
			fabs(rate_of(info) - refresh_hz) < fabs(rate_of(best) - refresh_hz))
			best = info;
	}
	return best;
}

/* The guard comes first: there is no moment without one. */
static bool change(struct x_mode *mode, const struct place *place, RRMode now, RRMode best)
{
	const struct x_mode_guard_task task = {DisplayString(place->display), place->output->crtc, now, best};
	*mode = (struct x_mode){.crtc = place->output->crtc, .before = now, .now = best};
	x_mode_guard_start(&mode->guard, &task);
	if (set_mode(place, mode->crtc, best))
		return true;
	x_mode_guard_dismiss(&mode->guard);
	*mode = (struct x_mode){0};
	return false;
}

double x_mode_change(struct x_mode *mode, Display *display, XID output, double refresh_hz)
{
	struct place place;
	double rate = 0.0;
	x_mode_restore(mode, display);
	const XRRModeInfo *now = find_place(&place, display, output) ? find_mode(place.resources, place.crtc->mode) : NULL;
	if (now) {
		const XRRModeInfo *best = best_mode(&place, now, refresh_hz);
		rate = rate_of(best != now && change(mode, &place, now->id, best->id) ? best : now);
	}
	leave_place(&place);
	return rate;
}

void x_mode_restore(struct x_mode *mode, Display *display)
{
	struct place place = {.display = display};
	if (!mode->crtc)
		return;
	place.resources = XRRGetScreenResourcesCurrent(display, DefaultRootWindow(display));
	if (place.resources)
		place.crtc = XRRGetCrtcInfo(display, place.resources, mode->crtc);
	const bool answered = place.crtc;
	if (answered && place.crtc->mode == mode->now)
		set_mode(&place, mode->crtc, mode->before);
	leave_place(&place);
	if (answered)
		x_mode_guard_dismiss(&mode->guard);
	x_mode_abandon(mode);
}

void x_mode_abandon(struct x_mode *mode)
{
	x_mode_guard_call(&mode->guard);
	*mode = (struct x_mode){0};
}
