/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Frames of boundary grains: members, areas, and contacts that copies share (docs/explanation/frames.md).
 *
 * On the frame are the grains that the cell's boundary cuts. Edges under traction are cut open: the copies of a
 * grain on both sides move by themselves there. A contact counts one over the number of its copies, so that the energy
 * is that of the periodic cell where copies move alike. Elsewhere the cell stays periodic. */
#include "micro/internal.h"

#include "contact/frame.h"

#include <stdlib.h>
#include <string.h>

void gh_frame_destroy(gh_rve_frame **frame) {
  if (!frame || !*frame) return;
  gh_rve_frame *f = *frame;
  void *const arrays[] = {f->grain, f->image,  f->type,    f->x,      f->radius,   f->on,
                          f->edges, f->held,   f->fixed,   f->area,   f->contacts, f->friction,
                          f->force, f->moment, f->balance, f->support};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) free(arrays[k]);
  free(f);
  *frame = NULL;
}

/* ---- members ---- */

/* Side of each direction that a primary grain lies on: -1 low, 1 high, 0 none. */
typedef struct frame_sides {
  int (*side)[2];
  double inverse[4];
} frame_sides;

static gh_status sides_find(gh_context *ctx, const gh_packing *p, frame_sides *s) {
  GH_TRY(gh_alloc(ctx, (size_t)p->n, sizeof *s->side, &s->side));
  gh_inv2(p->cell, s->inverse);
  for (int i = 0; i < p->n; i++) {
    double at[2] = {p->x[2 * i] - p->low[0], p->x[2 * i + 1] - p->low[1]};
    gh_apply2(s->inverse, at, at);
    for (int k = 0; k < 2; k++) {
      const double height = 1 / hypot(s->inverse[2 * k], s->inverse[2 * k + 1]);
      const bool low = at[k] * height <= p->radius[i], high = (1 - at[k]) * height <= p->radius[i];
      if (low && high)
        return gh_fail(
            ctx, GH_INPUT,
            "grain %d of diameter %g reaches both edges of a cell %g wide: a frame needs a larger packing",
            p->id[i], 2 * p->radius[i], height);
      s->side[i][k] = low ? -1 : high ? 1 : 0;
    }
  }
  return GH_OK;
}

/* Copies that are members, besides the grain itself; with f they are put there. */
static int copies_add(const gh_rve_frame *of, const gh_packing *p, const frame_sides *s, gh_rve_frame *f) {
  int n = p->n;
  for (int i = 0; i < p->n; i++)
    for (int copy = 1; copy < 4; copy++) {
      const int shift[2] = {copy & 1, copy >> 1};
      bool there = true;
      for (int k = 0; k < 2; k++) there = there && (!shift[k] || (of->open[k] && s->side[i][k]));
      if (!there) continue;
      if (f) {
        f->grain[n] = i;
        for (int k = 0; k < 2; k++) f->image[n][k] = -shift[k] * s->side[i][k];
      }
      n++;
    }
  return n;
}

/* Whether a member lies on the low (0) or high (1) side of an open direction. */
static int member_side(const gh_rve_frame *f, const frame_sides *s, int m, int k) {
  const int side = s->side[f->grain[m]][k];
  return (side < 0) == (f->image[m][k] == 0) ? 0 : 1;
}

static gh_status frame_alloc(gh_context *ctx, gh_rve_frame *f) {
  const size_t n = (size_t)f->n, d = sizeof(double);
  GH_TRY(gh_alloc(ctx, n, sizeof(int), &f->grain));
  GH_TRY(gh_alloc(ctx, n, sizeof *f->image, &f->image));
  GH_TRY(gh_alloc(ctx, n, sizeof(int), &f->type));
  GH_TRY(gh_alloc(ctx, 2 * n, d, &f->x));
  GH_TRY(gh_alloc(ctx, n, d, &f->radius));
  GH_TRY(gh_alloc(ctx, n, 1, &f->on));
  GH_TRY(gh_alloc(ctx, n, 1, &f->edges));
  GH_TRY(gh_alloc(ctx, n, 1, &f->held));
  GH_TRY(gh_alloc(ctx, n, 1, &f->fixed));
  GH_TRY(gh_alloc(ctx, 3 * n, d, &f->support));
  if (!f->open[0] && !f->open[1]) return GH_OK;
  GH_TRY(gh_alloc(ctx, 2 * n, d, &f->area));
  GH_TRY(gh_alloc(ctx, 2 * n, d, &f->force));
  GH_TRY(gh_alloc(ctx, n, d, &f->moment));
  return gh_alloc(ctx, 2 * n, d, &f->balance);
}

static void members_fill(const gh_packing *p, const gh_condition *condition, const frame_sides *s,
                         gh_rve_frame *f) {
  for (int i = 0; i < p->n; i++) f->grain[i] = i;
  copies_add(f, p, s, f);
  f->corner = -1;
  for (int m = 0; m < f->n; m++) {
    const int i = f->grain[m], *side = s->side[i];
    f->radius[m] = p->radius[i];
    f->type[m] = p->type[i];
    for (int k = 0; k < 2; k++) {
      f->x[2 * m + k] =
          p->x[2 * i + k] + p->cell[2 * k] * f->image[m][0] + p->cell[2 * k + 1] * f->image[m][1];
      if (!side[k]) continue;
      f->on[m] = 1;
      if (f->open[k]) f->edges[m] |= (unsigned char)(1 << (2 * k + member_side(f, s, m, k)));
      if (condition->edges[k] == GH_EDGES_DISPLACEMENT || condition->servo) f->held[m] = 1;
    }
    if (f->held[m]) f->fixed[m] = GH_FIXED_X | GH_FIXED_Y | GH_FIXED_TURN;
    if (f->on[m] &&
        (f->corner < 0 || (side[0] && side[1] && !(s->side[f->corner][0] && s->side[f->corner][1]))))
      f->corner = i;
  }
}

/* ---- areas ---- */

/* A grain of the chain along an edge: its copy on the low side of all open directions it is on, and how far along
 * the edge that is. */
typedef struct chain_link {
  double along, x[2];
  int grain;
} chain_link;

static int link_order(const void *a, const void *b) {
  const chain_link *p = a, *q = b;
  if (p->along != q->along) return p->along < q->along ? -1 : 1;
  return p->grain - q->grain;
}

static int chain_collect(const gh_packing *p, const gh_rve_frame *f, const frame_sides *s, int k,
                         chain_link *chain) {
  const int l = 1 - k;
  int count = 0;
  for (int i = 0; i < p->n; i++) {
    if (!s->side[i][k]) continue;
    chain_link *c = &chain[count++];
    const double back[2] = {s->side[i][0] > 0 && f->open[0] ? 1 : 0, s->side[i][1] > 0 && f->open[1] ? 1 : 0};
    double from[2];
    for (int h = 0; h < 2; h++) {
      c->x[h] = p->x[2 * i + h] - p->cell[2 * h] * back[0] - p->cell[2 * h + 1] * back[1];
      from[h] = c->x[h] - p->low[h];
    }
    gh_apply2(s->inverse, from, from);
    c->along = from[l];
    c->grain = i;
  }
  qsort(chain, (size_t)count, sizeof *chain, link_order);
  return count;
}

/* The copy of a grain `along` lattice vectors up an edge, on its low or high side; -1: none. */
static int member_find(const gh_rve_frame *f, const frame_sides *s, int grain, int k, int high, int along) {
  for (int m = 0; m < f->n; m++) {
    const int l = 1 - k;
    if (f->grain[m] != grain || member_side(f, s, m, k) != high) continue;
    if ((f->open[l] && s->side[grain][l] ? member_side(f, s, m, l) : 0) == along) return m;
  }
  return -1;
}

static void area_add(gh_rve_frame *f, int m, const double a[2], double share) {
  for (int h = 0; h < 2 && m >= 0; h++) f->area[2 * m + h] += share * a[h];
}

/* The part of an edge between two neighbours of its chain, `over` lattice vectors apart: half of its area is one's,
 * half the other's. Where both have copies there, these share it. `a` points outward on the low side. */
static void segment_add(gh_rve_frame *f, const frame_sides *s, int k, int from, int to, int over,
                        const double a[2]) {
  for (int high = 0; high < 2; high++) {
    const double sign = high ? -0.5 : 0.5;
    int count = 0;
    for (int along = 0; along < 2; along++)
      count +=
          member_find(f, s, from, k, high, along) >= 0 && member_find(f, s, to, k, high, along + over) >= 0;
    for (int along = 0; along < 2; along++) {
      const int one = member_find(f, s, from, k, high, along),
                other = member_find(f, s, to, k, high, along + over);
      if (one < 0 || other < 0) continue;
      area_add(f, one, a, sign / count);
      area_add(f, other, a, sign / count);
    }
    if (count > 0) continue;
    area_add(f, member_find(f, s, from, k, high, 0), a, sign);
    area_add(f, member_find(f, s, to, k, high, 0), a, sign);
  }
}

/* Edges normal to direction k. Opposite copies have opposite areas, and the areas of an edge add up to that of the
 * cell's, whether or not a grain is at the corner: sum x (x) area = V F. */
static gh_status edges_find_area(gh_context *ctx, const gh_packing *p, const frame_sides *s, int k,
                                 gh_rve_frame *f) {
  chain_link *chain;
  const int l = 1 - k;
  GH_TRY(gh_alloc(ctx, (size_t)p->n + 1, sizeof *chain, &chain));
  const int count = chain_collect(p, f, s, k, chain);
  for (int c = 0; c < count; c++) {
    const chain_link *from = &chain[c], *to = &chain[(c + 1) % count];
    const int over = c + 1 == count;
    double d[2];
    for (int h = 0; h < 2; h++) d[h] = to->x[h] - from->x[h] + over * p->cell[2 * h + l];
    const double a[2] = {k == 0 ? -d[1] : d[1], k == 0 ? d[0] : -d[0]};
    segment_add(f, s, k, from->grain, to->grain, over, a);
  }
  free(chain);
  return GH_OK;
}

/* Open directions are made so long that grains and their images are far apart. */
static void lattice_open(const gh_packing *p, const frame_sides *s, gh_rve_frame *f) {
  double largest = 0;
  for (int i = 0; i < p->n; i++) largest = fmax(largest, p->radius[i]);
  memcpy(f->lattice, p->cell, sizeof f->lattice);
  for (int k = 0; k < 2; k++) {
    const double height = 1 / hypot(s->inverse[2 * k], s->inverse[2 * k + 1]);
    for (int h = 0; h < 2 && f->open[k]; h++) f->lattice[2 * h + k] *= 2 + 4 * largest / height;
  }
}

gh_status gh_frame_create(gh_context *ctx, const gh_packing *p, const gh_condition *condition,
                          gh_rve_frame **frame) {
  gh_rve_frame *f;
  frame_sides s = {0};
  bool any = false;
  gh_status status;
  *frame = NULL;
  GH_TRY(gh_alloc(ctx, 1, sizeof *f, &f));
  GH_TRY_OR(sides_find(ctx, p, &s), done);
  for (int k = 0; k < 2; k++) f->open[k] = condition->edges[k] == GH_EDGES_TRACTION;
  f->n = copies_add(f, p, &s, NULL);
  GH_TRY_OR(frame_alloc(ctx, f), done);
  members_fill(p, condition, &s, f);
  lattice_open(p, &s, f);
  for (int m = 0; m < f->n; m++) any = any || f->held[m];
  for (int k = 0; k < 2; k++)
    if (f->open[k]) GH_TRY_OR(edges_find_area(ctx, p, &s, k, f), done);
  for (int m = 0; m < f->n && f->area && !condition->servo; m++)
    if (f->held[m]) f->area[2 * m] = f->area[2 * m + 1] = 0;
  if (f->area) f->rank = gh_frame_invert(f->n, f->area, f->inverse, f->axes);
  if (!any) {
    free(f->fixed);
    f->fixed = NULL;
  }
done:
  free(s.side);
  if (status != GH_OK) gh_frame_destroy(&f);
  *frame = f;
  return status;
}

/* ---- contacts ---- */

double gh_frame_share_of(const gh_rve_frame *f, const gh_contact *q) {
  return gh_frame_share(f->edges[q->i], f->edges[q->j]);
}

static void friction_share(gh_friction *t, double share) {
  t->couple *= share;
  t->energy *= share;
  t->dissipated *= share;
  for (int k = 0; k < 9; k++) t->d[k] *= share;
}

static void contact_share(gh_contact *q, double share) {
  q->energy *= share;
  for (int k = 0; k < 2; k++) q->f[k] *= share;
  for (int k = 0; k < 3; k++) q->h[k] *= share;
}

/* Of a grain and its own image no force is left, not even a rounded one. */
static void contact_add(const gh_rve *r, const gh_contact *q, const gh_friction *t) {
  gh_rve_frame *f = r->frame;
  for (int k = 0; k < 2 && q->i != q->j; k++) {
    f->force[2 * q->i + k] += q->f[k];
    f->force[2 * q->j + k] -= q->f[k];
  }
  if (!t) return;
  f->moment[q->i] -= r->radius[q->i] * t->couple;
  f->moment[q->j] -= r->radius[q->j] * t->couple;
}

gh_status gh_frame_share_contacts(gh_rve *r) {
  gh_rve_frame *f = r->frame;
  gh_contact_list *list = &r->list;
  const size_t count = (size_t)list->count, n = (size_t)f->n;
  const bool friction = list->friction != NULL;
  GH_TRY(gh_grow(r->ctx, count + 1, sizeof *f->contacts, &f->contact_capacity, &f->contacts));
  if (friction) GH_TRY(gh_grow(r->ctx, count + 1, sizeof *f->friction, &f->friction_capacity, &f->friction));
  memset(f->force, 0, 2 * n * sizeof(double));
  memset(f->moment, 0, n * sizeof(double));
  for (size_t c = 0; c < count; c++) {
    gh_contact *q = &f->contacts[c];
    *q = list->contacts[c];
    const double share = gh_frame_share_of(f, q);
    if (share < 1) contact_share(q, share);
    if (friction) f->friction[c] = list->friction[c];
    if (friction && share < 1) friction_share(&f->friction[c], share);
    contact_add(r, q, friction ? &f->friction[c] : NULL);
  }
  memcpy(f->balance, f->force, 2 * n * sizeof(double));
  gh_frame_project(f->area, f->inverse, f->n, f->balance);
  list->contacts = f->contacts;
  list->force = f->force;
  if (friction) list->friction = f->friction, list->moment = f->moment;
  return GH_OK;
}

/* ---- rotations that follow F ---- */

double gh_rotation_between(const double from[4], const double to[4]) {
  return remainder(gh_turn2(to) - gh_turn2(from), 2 * GH_PI);
}

/* atan2(s, c) of two sums of components of F. */
void gh_rotation_slope(const double F[4], double slope[4], double curvature[16]) {
  static const double ds[4] = {0, -1, 1, 0}, dc[4] = {1, 0, 0, 1};
  const double s = F[2] - F[1], c = F[0] + F[3], d = s * s + c * c;
  for (int a = 0; a < 4; a++) slope[a] = (c * ds[a] - s * dc[a]) / d;
  for (int a = 0; a < 4; a++)
    for (int b = 0; b < 4; b++)
      curvature[4 * a + b] = (dc[b] * ds[a] - ds[b] * dc[a]) / d - slope[a] * 2 * (s * ds[b] + c * dc[b]) / d;
}

double gh_frame_couple(const gh_rve *r) {
  double sum = 0;
  for (int i = 0; i < r->n && r->turns; i++)
    if (gh_frame_turns_with_F(r->frame, i)) sum -= r->list.moment[i];
  return sum;
}
