/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Static condensation of a packing's stiffness to the homogenised tangent.
 *
 * With z = (l_x, l_y, q) of a contact, z changes by (dF l, 0) + B u, where u are the displacements and
 * rotations of its grains that are not the deformation's own. Equilibrium of what is free: K u + G dF = 0,
 * K = sum B^T D B, G = sum B^T D (. l, 0); and V dP = sum (D z)_f (x) l. */
#include "engine/lammps/condense.h"

#include <algorithm>
#include <cmath>
#include <umfpack.h>

using granhom::Packing;

/* Added to the diagonal, over its largest entry: what no contact holds (the rigid translation, a grain on one
 * contact) must not stop the factorisation. It carries no load, so that its small stiffness does not matter.
 */
static const double SHIFT = 1e-12;

/* ---- rattlers ---- */

/* Contacts of a grain that do not lie on one half-plane hold it: no gap between their angles of a half turn
 * or more. */
static bool held_in_place(std::vector<double> &angles) {
  const double half_turn = std::acos(-1.), full_turn = 2 * half_turn;
  if (angles.size() < 3) return false;
  std::sort(angles.begin(), angles.end());
  double gap = angles.front() + full_turn - angles.back();
  for (std::size_t k = 1; k < angles.size(); k++) gap = std::max(gap, angles[k] - angles[k - 1]);
  return gap < half_turn;
}

/* Takes out grains until all that are left are held by contacts with others that are left. */
static std::vector<char> without_rattlers(const Packing &p) {
  const std::size_t n = p.radius.size();
  std::vector<char> in(n, 1);
  for (bool again = true; again;) {
    again = false;
    std::vector<std::vector<double>> angles(n);
    for (const auto &c : p.contacts) {
      if (!in[c.i] || !in[c.j]) continue;
      angles[c.i].push_back(std::atan2(c.l[1], c.l[0]));
      angles[c.j].push_back(std::atan2(-c.l[1], -c.l[0]));
    }
    for (std::size_t g = 0; g < n; g++)
      if (in[g] && p.free[g] && (p.friction ? angles[g].empty() : !held_in_place(angles[g]))) {
        in[g] = 0;
        again = !p.friction;
      }
  }
  return in;
}

/* ---- the system ---- */

namespace {

struct System {
  std::vector<int> at; /* first unknown of a grain's displacement, and of its rotation; -1: none */
  int size = 0;
  std::vector<int> row, column; /* triplets of K */
  std::vector<double> value, diagonal;
  std::vector<double> load[4], sum[4]; /* columns kL of G, rows iJ of the way back to the stress */
};

/* What the unknowns of a contact do to z: pairs of unknown and factor for each component. */
struct Part {
  int unknown;
  double z[3];
};

int parts_of(const System &s, const Packing &p, const Packing::Contact &c, Part *part) {
  int n = 0;
  for (int side = 0; side < 2; side++) {
    const int g = side ? c.j : c.i, u = s.at[2 * g], q = s.at[2 * g + 1];
    const double sign = side ? 1 : -1;
    if (u >= 0) {
      part[n++] = {u, {sign, 0, 0}};
      part[n++] = {u + 1, {0, sign, 0}};
    }
    if (q >= 0) part[n++] = {q, {0, 0, p.radius[g]}};
  }
  return n;
}

void number(System &s, const Packing &p, const std::vector<char> &in) {
  s.at.assign(2 * p.radius.size(), -1);
  for (std::size_t g = 0; g < p.radius.size(); g++) {
    if (!in[g]) continue;
    if (p.free[g]) {
      s.at[2 * g] = s.size;
      s.size += 2;
    }
    if (p.turns) s.at[2 * g + 1] = s.size++;
  }
  s.diagonal.assign(s.size, 0);
  for (int k = 0; k < 4; k++) {
    s.load[k].assign(s.size, 0);
    s.sum[k].assign(s.size, 0);
  }
}

void add_contact(System &s, const Packing &p, const Packing::Contact &c) {
  Part part[6];
  const int n = parts_of(s, p, c, part);
  for (int b = 0; b < n; b++) {
    double dz[3], back[3]; /* D z and z^T D of this unknown */
    for (int m = 0; m < 3; m++) {
      dz[m] = back[m] = 0;
      for (int k = 0; k < 3; k++) {
        dz[m] += c.d[3 * m + k] * part[b].z[k];
        back[m] += part[b].z[k] * c.d[3 * k + m];
      }
    }
    for (int i = 0; i < 2; i++)
      for (int j = 0; j < 2; j++) {
        s.sum[2 * i + j][part[b].unknown] += dz[i] * c.l[j];
        s.load[2 * i + j][part[b].unknown] += back[i] * c.l[j];
      }
    for (int a = 0; a < n; a++) {
      const double k = part[a].z[0] * dz[0] + part[a].z[1] * dz[1] + part[a].z[2] * dz[2];
      s.row.push_back(part[a].unknown);
      s.column.push_back(part[b].unknown);
      s.value.push_back(k);
      if (part[a].unknown == part[b].unknown) s.diagonal[part[a].unknown] += k;
    }
  }
}

/* w[kL] = K^-1 load[kL]. */
bool solve(System &s, std::vector<double> w[4]) {
  double largest = 0;
  for (double d : s.diagonal) largest = std::max(largest, std::fabs(d));
  for (int u = 0; u < s.size; u++) {
    s.row.push_back(u);
    s.column.push_back(u);
    s.value.push_back(SHIFT * largest);
  }
  const int entries = (int)s.value.size();
  std::vector<int> start(s.size + 1), row(entries);
  std::vector<double> value(entries);
  if (umfpack_di_triplet_to_col(s.size, s.size, entries, s.row.data(), s.column.data(), s.value.data(),
                                start.data(), row.data(), value.data(), nullptr) != UMFPACK_OK)
    return false;
  void *symbolic = nullptr, *numeric = nullptr;
  bool good = umfpack_di_symbolic(s.size, s.size, start.data(), row.data(), value.data(), &symbolic, nullptr,
                                  nullptr) == UMFPACK_OK &&
              umfpack_di_numeric(start.data(), row.data(), value.data(), symbolic, &numeric, nullptr,
                                 nullptr) == UMFPACK_OK;
  for (int k = 0; k < 4 && good; k++) {
    w[k].assign(s.size, 0);
    good = umfpack_di_solve(UMFPACK_A, start.data(), row.data(), value.data(), w[k].data(), s.load[k].data(),
                            numeric, nullptr, nullptr) == UMFPACK_OK;
  }
  umfpack_di_free_symbolic(&symbolic);
  umfpack_di_free_numeric(&numeric);
  return good;
}

} // namespace

bool granhom::condense(const Packing &p, double *A) {
  const std::vector<char> in = without_rattlers(p);
  System s;
  number(s, p, in);
  std::fill(A, A + 16, 0.0);
  for (const auto &c : p.contacts) {
    if (!in[c.i] || !in[c.j]) continue;
    add_contact(s, p, c);
    for (int a = 0; a < 4; a++)
      for (int b = 0; b < 4; b++) A[4 * a + b] += c.d[3 * (a / 2) + b / 2] * c.l[a % 2] * c.l[b % 2];
  }
  std::vector<double> w[4];
  if (s.size && !solve(s, w)) return false;
  for (int a = 0; a < 4; a++)
    for (int b = 0; b < 4; b++) {
      for (int u = 0; u < s.size; u++) A[4 * a + b] -= s.sum[a][u] * w[b][u];
      A[4 * a + b] /= p.volume;
    }
  return true;
}
