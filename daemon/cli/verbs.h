/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The verbs of `pursuit`, one file each. argv[0] is the verb's name. Each gives
 * the exit status of the program back: 0, 1 failed, 2 used wrongly.
 */
#ifndef PURSUIT_CLI_VERBS_H
#define PURSUIT_CLI_VERBS_H

int verb_check_stream(int argc, char **argv);
int verb_demo(int argc, char **argv);
int verb_doctor(int argc, char **argv);
int verb_export(int argc, char **argv);
int verb_get(int argc, char **argv);
int verb_import(int argc, char **argv);
int verb_latency(int argc, char **argv);
int verb_profile(int argc, char **argv);
int verb_record(int argc, char **argv);
int verb_replay(int argc, char **argv);
int verb_report(int argc, char **argv);
int verb_set(int argc, char **argv);
int verb_status(int argc, char **argv);
int verb_top(int argc, char **argv);

#endif
