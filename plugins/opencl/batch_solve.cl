// Second part of batch.cl: the block tridiagonal matrix, friction, and the motion.

// Of a symmetric 3 x 3; false unless it is positive definite.
bool invert3(const double* a, double* inv) {
  const double c00 = a[4] * a[8] - a[5] * a[5], c01 = a[2] * a[5] - a[1] * a[8];
  const double c02 = a[1] * a[5] - a[2] * a[4], c22 = a[0] * a[4] - a[1] * a[1];
  const double det = a[0] * c00 + a[1] * c01 + a[2] * c02;
  if (!(a[0] > 0 && c22 > 0 && det > 0)) return false;
  inv[0] = c00 / det;
  inv[1] = inv[3] = c01 / det;
  inv[2] = inv[6] = c02 / det;
  inv[4] = (a[0] * a[8] - a[2] * a[2]) / det;
  inv[5] = inv[7] = (a[1] * a[2] - a[0] * a[5]) / det;
  inv[8] = c22 / det;
  return true;
}

// Of a symmetric 6 x 6, through its 3 x 3 blocks, so that translations and spins do not mix.
bool invert6(local const double* s, local double* inv) {
  double a[9], b[9], ai[9], w[9], c[9], ci[9], wc[9];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      a[3 * i + j] = s[6 * i + j];
      b[3 * i + j] = s[6 * i + 3 + j];
      c[3 * i + j] = s[6 * (3 + i) + 3 + j];
    }
  if (!invert3(a, ai)) return false;
  for (int i = 0; i < 9; ++i) {
    w[i] = 0;
    for (int k = 0; k < 3; ++k) w[i] += ai[i / 3 * 3 + k] * b[3 * k + i % 3];
  }
  for (int i = 0; i < 9; ++i)
    for (int k = 0; k < 3; ++k) c[i] -= b[3 * k + i / 3] * w[3 * k + i % 3];
  if (!invert3(c, ci)) return false;
  for (int i = 0; i < 9; ++i) {
    wc[i] = 0;
    for (int k = 0; k < 3; ++k) wc[i] += w[i / 3 * 3 + k] * ci[3 * k + i % 3];
  }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      double sum = ai[3 * i + j];
      for (int k = 0; k < 3; ++k) sum += wc[3 * i + k] * w[3 * j + k];
      inv[6 * i + j] = sum;
      inv[6 * i + 3 + j] = inv[6 * (3 + j) + i] = -wc[3 * i + j];
      inv[6 * (3 + i) + 3 + j] = ci[3 * i + j];
    }
  return true;
}

// Block Thomas elimination, as block_tridiagonal.h has it, and its remedy where rounding has made
// the matrix indefinite: a shift of the diagonal.
kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void batch_factor(global State* states,
                                                                            global Work* works) {
  global State* s = states + get_group_id(0);
  global Work* w = works + get_group_id(0);
  const int item = get_local_id(0);
  local double S[36], inv[36], T[36], C[36];
  local int good;
  double shift = 0;
  for (int attempt = 0; attempt < 5; ++attempt) {
    if (item == 0) good = 1;
    barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
    for (int e = item; e < 36; e += GROUP) S[e] = w->diagonal[0][e];
    for (int n = 0; n < NODES; ++n) {
      barrier(CLK_LOCAL_MEM_FENCE);
      if (item == 0 && !invert6(S, inv)) good = 0;
      for (int e = item; e < 36 && n < BEAMS; e += GROUP) C[e] = w->upper[n][e];
      barrier(CLK_LOCAL_MEM_FENCE);
      for (int e = item; e < 36; e += GROUP) {
        w->inverse[n][e] = inv[e];
        double sum = 0;
        for (int k = 0; k < 6; ++k) sum += inv[e / 6 * 6 + k] * C[6 * k + e % 6];
        T[e] = sum;
        if (n < BEAMS) w->transfer[n][e] = sum;
      }
      barrier(CLK_LOCAL_MEM_FENCE);
      for (int e = item; e < 36 && n < BEAMS; e += GROUP) {
        double sum = w->diagonal[n + 1][e];
        for (int k = 0; k < 6; ++k) sum -= C[6 * k + e / 6] * T[6 * k + e % 6];
        S[e] = sum;
      }
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    const bool done = good != 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (done) return;
    shift = attempt == 0 ? 1e-13 : shift * 100;
    for (int d = item; d < 6 * NODES; d += GROUP) w->diagonal[d / 6][d % 6 * 7] *= 1 + shift;
  }
  if (item == 0) s->failed = 1;
}

// One item per column: A^-1 of it.
kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void batch_answer(global Work* works) {
  global Work* w = works + get_group_id(0);
  for (int column = get_local_id(0); column < COLUMNS; column += GROUP) {
    double z[6], x[6];
    for (int d = 0; d < 6; ++d) z[d] = w->answer[d][column];
    for (int n = 0; n + 1 < NODES; ++n) {
      for (int d = 0; d < 6; ++d) {
        x[d] = w->answer[6 * n + 6 + d][column];
        for (int k = 0; k < 6; ++k) x[d] -= w->transfer[n][6 * k + d] * z[k];
      }
      for (int d = 0; d < 6; ++d) w->answer[6 * n + 6 + d][column] = z[d] = x[d];
    }
    for (int n = NODES - 1; n >= 0; --n) {
      for (int d = 0; d < 6; ++d) {
        z[d] = 0;
        for (int k = 0; k < 6; ++k)
          z[d] += w->inverse[n][6 * d + k] * w->answer[6 * n + k][column];
        if (n < BEAMS)
          for (int k = 0; k < 6; ++k) z[d] -= w->transfer[n][6 * d + k] * x[k];
      }
      for (int d = 0; d < 6; ++d) w->answer[6 * n + d][column] = x[d] = z[d];
    }
  }
}

// Displacement of the thread along the path at point k, for an answer.
double along_path(constant const double* path, global const Work* w, int k, int column) {
  const int n = w->beam[k];
  double sum = 0;
  for (int d = 0; d < 3; ++d)
    sum += path[6 * k + 3 + d] * ((1 - w->share[k]) * w->answer[6 * n + d][column] +
                                  w->share[k] * w->answer[6 * n + 6 + d][column]);
  return sum;
}

// |lambda| <= friction, and it opposes the sliding delta = W lambda + d: a linear complementarity
// problem with bounds. Which points stick is guessed, the sticking ones are solved for exactly, and
// what does not fit changes sides: all at once as long as they become fewer, else one at a time,
// which cannot go in circles (block principal pivoting, Judice and Pires 1994). Sweeps would not
// get there: a thread is all but rigid along itself.
kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void batch_friction(
    constant const Problem* p, constant const double* path, global State* states,
    global Work* works) {
  global State* s = states + get_group_id(0);
  global Work* w = works + get_group_id(0);
  const int item = get_local_id(0);
  const double h = p->dt;
  for (int e = item; e < POINTS * POINTS; e += GROUP)
    w->W[e / POINTS][e % POINTS] = h * h * along_path(path, w, e / POINTS, e % POINTS);
  for (int k = item; k < POINTS; k += GROUP) w->d[k] = h * along_path(path, w, k, POINTS);
  barrier(CLK_GLOBAL_MEM_FENCE);

  // lambda: of points that slide, x: of all.
  local double L[POINTS][POINTS], lambda[POINTS], x[POINTS], off[POINTS];
  local int bound[POINTS], next[POINTS];
  for (int k = item; k < POINTS; k += GROUP) {
    bound[k] = s->bound[k];
    lambda[k] = bound[k] == 2 ? 0 : bound[k] * p->friction;
  }
  int fewest = POINTS + 1, patience = 3;
  for (int round = 0; round < 20 * (POINTS + 1); ++round) {
    barrier(CLK_LOCAL_MEM_FENCE);
    // Cholesky over the sticking points; the others have rows of the identity. More points than
    // nodes make it singular: the diagonal is raised by more than rounding, and far less than the
    // thread gives between two points. The residual does not know of it.
    for (int k = 0; k < POINTS; ++k) {
      for (int i = k + item; i < POINTS; i += GROUP) {
        double sum = bound[i] == 0 && bound[k] == 0 ? w->W[i][k] : i == k ? 1 : 0;
        if (i == k) sum *= 1 + 1e-12;
        for (int j = 0; j < k; ++j) sum -= L[i][j] * L[k][j];
        L[i][k] = sum;
      }
      barrier(CLK_LOCAL_MEM_FENCE);
      if (item == 0) L[k][k] = sqrt(L[k][k]);
      barrier(CLK_LOCAL_MEM_FENCE);
      for (int i = k + 1 + item; i < POINTS; i += GROUP) L[i][k] /= L[k][k];
      barrier(CLK_LOCAL_MEM_FENCE);
    }
    for (int i = item; i < POINTS; i += GROUP) {
      double right = bound[i] == 0 ? -w->d[i] : lambda[i];
      for (int k = 0; k < POINTS && bound[i] == 0; ++k)
        if (bound[k] != 0) right -= w->W[i][k] * lambda[k];
      x[i] = right;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item == 0) {
      for (int i = 0; i < POINTS; ++i) {
        for (int k = 0; k < i; ++k) x[i] -= L[i][k] * x[k];
        x[i] /= L[i][i];
      }
      for (int i = POINTS - 1; i >= 0; --i) {
        for (int k = i + 1; k < POINTS; ++k) x[i] -= L[k][i] * x[k];
        x[i] /= L[i][i];
      }
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    for (int i = item; i < POINTS; i += GROUP) {
      double delta = w->d[i];
      for (int k = 0; k < POINTS; ++k) delta += w->W[i][k] * x[k];
      off[i] = bound[i] == 2 ? 0
                             : fabs(x[i] - clamp(x[i] - delta / w->W[i][i], -p->friction,
                                                 p->friction));
      next[i] = bound[i];
      if (bound[i] == 0)
        next[i] = x[i] > p->friction ? 1 : x[i] < -p->friction ? -1 : 0;
      else if (bound[i] != 2 && bound[i] * delta > 0)
        next[i] = 0;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    int wrong = 0, last = 0;
    for (int i = 0; i < POINTS; ++i)
      if (next[i] != bound[i]) {
        ++wrong;
        last = i;
      }
    if (wrong == 0) break;
    patience = wrong < fewest ? 3 : patience - 1;
    fewest = min(fewest, wrong);
    barrier(CLK_LOCAL_MEM_FENCE);
    for (int i = item; i < POINTS; i += GROUP)
      if (patience > 0 || i == last) {
        bound[i] = next[i];
        if (bound[i] != 2) lambda[i] = bound[i] * p->friction;
      }
  }
  if (item == 0) s->residual = 0;
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int i = item; i < POINTS; i += GROUP) {
    s->bound[i] = bound[i];
    s->friction[i] = x[i];
  }
  if (item == 0)
    for (int i = 0; i < POINTS; ++i) {
      s->residual = fmax(s->residual, off[i]);
      if (!isfinite(x[i])) s->failed = 1;
    }
}

// The thread moves by the answer to everything and to the friction.
kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void batch_move(
    constant const Problem* p, global State* states, global Work* works) {
  global State* s = states + get_group_id(0);
  global Work* w = works + get_group_id(0);
  const int item = get_local_id(0);
  const double h = p->dt;
  for (int d = item; d < 6 * NODES; d += GROUP) {
    double v = w->answer[d][POINTS];
    for (int k = 0; k < POINTS; ++k) v += h * w->answer[d][k] * s->friction[k];
    s->velocity[d / 6][d % 6] = v;
  }
  barrier(CLK_GLOBAL_MEM_FENCE);
  for (int n = item; n < BEAMS; n += GROUP) {
    const double3 span = at(s->position[n + 1]) - at(s->position[n]);
    const double3 spin = at(s->velocity[n + 1] + 3) - at(s->velocity[n] + 3);
    s->twist[n] += h * dot(span, spin) / length(span);
  }
  barrier(CLK_GLOBAL_MEM_FENCE);
  for (int i = item; i < NODES; i += GROUP) {
    put(s->position[i], at(s->position[i]) + h * at(s->velocity[i]));
    const double4 before = quaternion(s->rotation[i]);
    const double3 spin = at(s->velocity[i] + 3), from = tangent(before);
    const double4 after = turned(before, h * spin);
    s->rotation[i][0] = after.x, s->rotation[i][1] = after.y;
    s->rotation[i][2] = after.z, s->rotation[i][3] = after.w;
    put(s->velocity[i] + 3, spin + dot(spin, from) * (tangent(after) - from));
  }
}

kernel void batch_reset(global const uchar* which, global const double* rest, global State* states,
                        int environments) {
  const int environment = get_global_id(0);
  if (environment >= environments || !which[environment]) return;
  global State* s = states + environment;
  for (int i = 0; i < NODES; ++i) {
    put(s->position[i], at(rest + 7 * i));
    for (int d = 0; d < 4; ++d) s->rotation[i][d] = rest[7 * i + 3 + d];
    for (int d = 0; d < 6; ++d) s->velocity[i][d] = 0;
  }
  put(s->hand, at(rest + 7 * BEAMS));
  for (int n = 0; n < BEAMS; ++n) s->twist[n] = 0;
  for (int k = 0; k < POINTS; ++k) {
    s->friction[k] = 0;
    s->bound[k] = 0;
  }
  s->failed = 0;
  s->residual = 0;
}

// Force of the hand (3), friction at the points, residual of the friction (NAN where a step could
// not be solved), positions of the nodes.
kernel void batch_observe(constant const Problem* p, global const State* states, int environments,
                          global double* out) {
  const int environment = get_global_id(0);
  if (environment >= environments) return;
  global const State* s = states + environment;
  out += (size_t)environment * (4 + POINTS + 3 * NODES);
  put(out, p->hand * (at(s->hand) - at(s->position[BEAMS])));
  for (int k = 0; k < POINTS; ++k) out[3 + k] = s->friction[k];
  out[3 + POINTS] = s->failed ? NAN : s->residual;
  for (int i = 0; i < NODES; ++i) put(out + 4 + POINTS + 3 * i, at(s->position[i]));
}
