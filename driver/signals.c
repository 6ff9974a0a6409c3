/* SPDX-License-Identifier: GPL-2.0-or-later */
/* SIGINT and SIGTERM end long commands in an orderly way. */
#include "cli.h"

#include <signal.h>

/* Set by the first signal. */
static volatile sig_atomic_t stop_wanted;

static void on_signal(int number) {
  (void)number;
  stop_wanted = 1;
}

void cli_catch_signals(void) {
  struct sigaction action = {.sa_handler = on_signal, .sa_flags = SA_RESTART | (int)SA_RESETHAND};
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, NULL);
  sigaction(SIGTERM, &action, NULL);
}

bool cli_stop(void *data) {
  (void)data;
  return stop_wanted;
}
