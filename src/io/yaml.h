/* SPDX-License-Identifier: GPL-2.0-or-later */
/* A YAML document in memory: what reading and changing it share. */
#ifndef GRANHOM_IO_YAML_H
#define GRANHOM_IO_YAML_H

#include "io/file.h"

#include <yaml.h>

struct gh_yaml {
  gh_context *ctx;
  char *path;
  yaml_document_t document;
};

/* NULL for an absent value. Valid until the document grows. */
const yaml_node_t *gh_yaml_look(gh_yaml_node node);
/* "a map", "a list", "missing", ...: for messages. */
const char *gh_yaml_kind(gh_yaml_node node);

#endif
