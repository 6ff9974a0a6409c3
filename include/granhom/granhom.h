/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom: all public headers. */
#ifndef GRANHOM_H
#define GRANHOM_H
#define GH_VERSION "0.1.0"
#include "granhom/base.h"
#include "granhom/contact.h"
#include "granhom/control.h"
#include "granhom/crosscheck.h"
#include "granhom/direct.h"
#include "granhom/engine.h"
#include "granhom/farm.h"
#include "granhom/finish.h"
#include "granhom/io.h"
#include "granhom/lammps.h"
#include "granhom/limits.h"
#include "granhom/macro.h"
#include "granhom/mesh.h"
#include "granhom/micro.h"
#include "granhom/packing.h"
#include "granhom/report.h"
#include "granhom/results.h"
#include "granhom/scene.h"
#endif
