// Twins of the laws in sutura/laws and plugins/suturing, whose headers say what each one is. One
// block at a time: W is D x D, by columns, of which the first rows and columns count; `inverse` is
// that of W with the compliance of the law on its diagonal (NAN where there is none). d is delta
// without the block's own force.

real length_of(int n, const real* x) {
  real sum = 0;
  for (int i = 0; i < n; ++i) sum += x[i] * x[i];
  return sqrt(sum);
}

// A (n x n, by columns) -> its eigenvalues on the diagonal; V: eigenvectors. Jacobi's rotations.
void eigen(int n, real* A, real* V) {
  for (int i = 0; i < n * n; ++i) V[i] = i % (n + 1) == 0 ? 1 : 0;
  for (int round = 0; round < 30; ++round) {
    real off = 0, diagonal = 0;
    for (int j = 0; j < n; ++j) {
      diagonal = fmax(diagonal, fabs(A[j + j * n]));
      for (int i = 0; i < j; ++i) off = fmax(off, fabs(A[i + j * n]));
    }
    if (!(off > EPSILON * EPSILON * diagonal)) return;
    for (int q = 1; q < n; ++q)
      for (int p = 0; p < q; ++p) {
        const real apq = A[p + q * n];
        if (apq == 0) continue;
        const real theta = (A[q + q * n] - A[p + p * n]) / (2 * apq);
        const real t = copysign((real)1, theta) / (fabs(theta) + sqrt(theta * theta + 1));
        const real c = 1 / sqrt(t * t + 1), s = t * c;
        for (int k = 0; k < n; ++k) {
          const real akp = A[k + p * n], akq = A[k + q * n];
          A[k + p * n] = c * akp - s * akq;
          A[k + q * n] = s * akp + c * akq;
        }
        for (int k = 0; k < n; ++k) {
          const real apk = A[p + k * n], aqk = A[q + k * n];
          A[p + k * n] = c * apk - s * aqk;
          A[q + k * n] = s * apk + c * aqk;
          const real vkp = V[k + p * n], vkq = V[k + q * n];
          V[k + p * n] = c * vkp - s * vkq;
          V[k + q * n] = s * vkp + c * vkq;
        }
        A[p + q * n] = A[q + p * n] = 0;
      }
  }
}

// As solve_in_ball of sutura/laws/ball.h; W is n x n.
real solve_in_ball(int n, const real* W, const real* d, real limit, real* lambda) {
  for (int i = 0; i < n; ++i) lambda[i] = 0;
  if (limit <= 0) return 0;
  if (n == 1) {
    const real w = W[0];
    if (fabs(d[0]) <= w * limit) {
      lambda[0] = w > 0 ? -d[0] / w : 0;
      return 0;
    }
    lambda[0] = d[0] > 0 ? -limit : limit;
    return fabs(d[0]) / limit - w;
  }
  real A[D * D], V[D * D], e[D], g[D], y[D];
  for (int i = 0; i < n * n; ++i) A[i] = W[i];
  eigen(n, A, V);
  real largest = 0, s = 0, norm;
  for (int i = 0; i < n; ++i) {
    e[i] = A[i + i * n];
    g[i] = 0;
    for (int k = 0; k < n; ++k) g[i] -= V[k + i * n] * d[k];
    largest = fmax(largest, fabs(e[i]));
  }
  const real tiny = 50 * EPSILON * largest;
  for (int i = 0; i < n; ++i) {
    s = fmax(s, fabs(g[i]) / limit - e[i]);
    y[i] = e[i] > tiny ? g[i] / e[i] : 0;
  }
  const bool inside = s <= 0 && length_of(n, y) <= limit;
  if (!inside) {
    for (int iteration = 0; iteration < 60; ++iteration) {
      real slope = 0;
      for (int i = 0; i < n; ++i) {
        y[i] = e[i] + s > tiny ? g[i] / (e[i] + s) : 0;
        slope += e[i] + s > tiny ? y[i] * y[i] / (e[i] + s) : 0;
      }
      norm = length_of(n, y);
      if (!(slope > 0)) break;
      const real step = (norm / limit - 1) * norm * norm / slope;
      s += step;
      if (fabs(step) <= 4 * EPSILON * s) break;
    }
    for (int i = 0; i < n; ++i) y[i] = e[i] + s > tiny ? g[i] / (e[i] + s) : 0;
    norm = length_of(n, y);
    for (int i = 0; i < n; ++i) y[i] *= limit / norm;
  }
  for (int k = 0; k < n; ++k)
    for (int i = 0; i < n; ++i) lambda[k] += V[k + i * n] * y[i];
  return inside ? 0 : s;
}

// Parameters: c, cap.
void project_bilateral(int n, const real* W, const real* inverse, const real* d,
                       PARAMETERS const real* p, uchar* mode, real* lambda) {
  const real cap = p[1];
  *mode = 0;
  real held[D];
  for (int i = 0; i < n; ++i) {
    held[i] = 0;
    for (int j = 0; j < n; ++j) held[i] -= inverse[i + j * D] * d[j];
  }
  const real norm = length_of(n, held);
  if (isfinite(norm) && norm <= cap) {
    for (int i = 0; i < n; ++i) lambda[i] = held[i];
    return;
  }
  real A[D * D];
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) A[i + j * n] = W[i + j * D] + (i == j ? p[0] : 0);
  if (solve_in_ball(n, A, d, isfinite(cap) ? cap : (real)1e12f, lambda) > 0) *mode = 1;
}

void project_unilateral(const real* W, const real* d, PARAMETERS const real* p, uchar* mode,
                        real* lambda) {
  const real w = W[0] + p[0];
  lambda[0] = d[0] < 0 && w > 0 ? -d[0] / w : 0;
  *mode = d[0] < 0 ? 1 : 0;
}

#if D >= 2
// Parameters: k, c.
void project_turning_force(const real* W, const real* d, PARAMETERS const real* p, uchar* mode,
                           real* lambda) {
  const real k = p[0], c = p[1];
  if (*mode == 1) {
    const real m01 = W[D] + 1 / c, m10 = W[1] + 1 / c, m11 = W[1 + D] - k / (c * c);
    const real determinant = W[0] * m11 - m01 * m10;
    lambda[0] = (m01 * d[1] - m11 * d[0]) / determinant;
    lambda[1] = (m10 * d[0] - W[0] * d[1]) / determinant;
    if (isfinite(lambda[0]) && isfinite(lambda[1])) return;
  }
  *mode = 0;
  lambda[0] = k > 0 ? -k * d[0] / (k * W[0] + 1) : 0;
  lambda[1] = 0;
}
#endif

#if D >= 3
enum { OPEN, STICK, SLIP, CAPPED_STICK, CAPPED_SLIP };

real slip_excess(const real* e, const real* re, const real* we, real wn, real dn, real mu, real k,
                 real* t, real* n) {
  for (int i = 0; i < 2; ++i) t[i] = e[i] + k > 0 ? -re[i] / (e[i] + k) : 0;
  *n = -(dn + we[0] * t[0] + we[1] * t[1]) / wn;
  return sqrt(t[0] * t[0] + t[1] * t[1]) - mu * *n;
}

// As in sutura/laws/coulomb.h: closed, and sticking is not admissible. W: D x D.
void solve_slip(const real* W, const real* d, real mu, real* lambda) {
  const real wn = W[0], w0 = W[1], w1 = W[2];
  real S[4] = {W[1 + D] - w0 * w0 / wn, W[2 + D] - w0 * w1 / wn, W[2 + D] - w0 * w1 / wn,
               W[2 + 2 * D] - w1 * w1 / wn};
  real V[4];
  eigen(2, S, V);
  const real r0 = d[1] - w0 * (d[0] / wn), r1 = d[2] - w1 * (d[0] / wn);
  const real e[2] = {fmax(S[0], (real)0), fmax(S[3], (real)0)};
  const real re[2] = {V[0] * r0 + V[1] * r1, V[2] * r0 + V[3] * r1};
  const real we[2] = {V[0] * w0 + V[1] * w1, V[2] * w0 + V[3] * w1};
  real t[2], n = 0, low = 0, high = fmax(fmax(e[0], e[1]), (real)1e-12f * wn);
  real f_low = slip_excess(e, re, we, wn, d[0], mu, 0, t, &n);
  real f_high = slip_excess(e, re, we, wn, d[0], mu, high, t, &n);
  for (int i = 0; f_high > 0 && i < 60; ++i) {
    low = high;
    f_low = f_high;
    high *= 4;
    f_high = slip_excess(e, re, we, wn, d[0], mu, high, t, &n);
  }
  int side = 0;
  for (int i = 0; i < 200 && high - low > 2 * EPSILON * high; ++i) {
    const real k = i % 4 == 3 || !(f_low > f_high) ? (low + high) / 2
                                                   : (low * f_high - high * f_low) / (f_high - f_low);
    const real f = slip_excess(e, re, we, wn, d[0], mu, k, t, &n);
    if (f > 0) {
      low = k;
      f_low = f;
      if (side == 1) f_high /= 2;
      side = 1;
    } else {
      high = k;
      f_high = f;
      if (side == -1) f_low /= 2;
      side = -1;
    }
    if (f == 0) break;
  }
  slip_excess(e, re, we, wn, d[0], mu, high, t, &n);
  n = fmax(n, (real)0);
  const real norm = sqrt(t[0] * t[0] + t[1] * t[1]);
  if (norm > 0) {
    t[0] *= mu * n / norm;
    t[1] *= mu * n / norm;
  }
  lambda[0] = n;
  lambda[1] = V[0] * t[0] + V[2] * t[1];
  lambda[2] = V[1] * t[0] + V[3] * t[1];
}

// The gap along the normal if its force is n, at most `cap`: the tangent rows are a ball of mu n.
real normal_gap(const real* W, const real* d, real mu, real n, real* lambda, real* s) {
  const real T[4] = {W[1 + D], W[2 + D], W[1 + 2 * D], W[2 + 2 * D]};
  const real dt[2] = {d[1] + W[1] * n, d[2] + W[2] * n};
  lambda[0] = n;
  *s = solve_in_ball(2, T, dt, mu * n, lambda + 1);
  return d[0] + W[0] * n + W[D] * lambda[1] + W[2 * D] * lambda[2];
}

int solve_friction(const real* W, const real* inverse, const real* d, real mu, real cap,
                   real* lambda) {
  lambda[0] = lambda[1] = lambda[2] = 0;
  if (!(d[0] < 0) || !(W[0] > 0)) return OPEN;
  if (mu <= 0) {
    lambda[0] = fmin(-d[0] / W[0], cap);
    return lambda[0] < cap ? SLIP : CAPPED_SLIP;
  }
  int state = SLIP;
  real stick[3];
  for (int i = 0; i < 3; ++i)
    stick[i] = -(inverse[i] * d[0] + inverse[i + D] * d[1] + inverse[i + 2 * D] * d[2]);
  // False also where there is no inverse.
  if (stick[0] >= 0 && sqrt(stick[1] * stick[1] + stick[2] * stick[2]) <= mu * stick[0]) {
    for (int i = 0; i < 3; ++i) lambda[i] = stick[i];
    state = STICK;
  } else {
    solve_slip(W, d, mu, lambda);
  }
  if (lambda[0] <= cap) return state;
  real s;
  if (normal_gap(W, d, mu, cap, lambda, &s) <= 0) return s > 0 ? CAPPED_SLIP : CAPPED_STICK;
  real low = 0, high = cap;
  for (int i = 0; i < 100 && high - low > 2 * EPSILON * high; ++i) {
    const real n = (low + high) / 2;
    if (normal_gap(W, d, mu, n, lambda, &s) < 0)
      low = n;
    else
      high = n;
  }
  normal_gap(W, d, mu, high, lambda, &s);
  return s > 0 ? SLIP : STICK;
}

// Rows: along the axis, across, across.
void project_penetrated(const real* A, const real* d, real cutting, real drag, bool hold,
                        real* force) {
  const real det = A[1 + D] * A[2 + 2 * D] - A[1 + 2 * D] * A[2 + D];
  const real a = hold ? A[2 + 2 * D] / det : 0, b = hold ? -A[2 + D] / det : 0,
             c = hold ? A[1 + D] / det : 0;
  const real i0 = a * A[1] + b * A[2], i1 = b * A[1] + c * A[2];
  const real w = A[0] - A[1] * i0 - A[2] * i1;
  const real advance =
      d[0] - A[1] * (a * d[1] + b * d[2]) - A[2] * (b * d[1] + c * d[2]);
  const real blocked = fmax(advance / w, (real)0);
  force[0] = blocked <= cutting ? -blocked : -(cutting + drag * advance) / (1 + drag * w);
  const real r0 = d[1] + A[1] * force[0], r1 = d[2] + A[2] * force[0];
  force[1] = -(a * r0 + b * r1);
  force[2] = -(b * r0 + c * r1);
}

// The inverse of the leading 3 x 3 part of A (D x D), by Cholesky; NAN if it is not definite.
void invert3(const real* A, real* inverse) {
  const real l00 = sqrt(A[0]), l10 = A[1] / l00, l20 = A[2] / l00;
  const real l11 = sqrt(A[1 + D] - l10 * l10), l21 = (A[2 + D] - l20 * l10) / l11;
  const real l22 = sqrt(A[2 + 2 * D] - l20 * l20 - l21 * l21);
  const real m00 = 1 / l00, m11 = 1 / l11, m22 = 1 / l22;
  const real m10 = -l10 * m00 * m11, m21 = -l21 * m11 * m22;
  const real m20 = -(l20 * m00 + l21 * m10) * m22;
  inverse[0] = m00 * m00 + m10 * m10 + m20 * m20;
  inverse[1] = inverse[D] = m10 * m11 + m20 * m21;
  inverse[2] = inverse[2 * D] = m20 * m22;
  inverse[1 + D] = m11 * m11 + m21 * m21;
  inverse[2 + D] = inverse[1 + 2 * D] = m21 * m22;
  inverse[2 + 2 * D] = m22 * m22;
}

// Parameters: mu, c.
void project_coulomb(const real* W, const real* inverse, const real* d, PARAMETERS const real* p,
                     uchar* mode, real* lambda) {
  real A[D * D];
  for (int i = 0; i < D * D; ++i) A[i] = W[i];
  A[0] += p[1];
  *mode = solve_friction(A, inverse, d, p[0], INFINITY, lambda);
}

// Parameters: mu at rest, mu sliding, c, stick_slip. The mode keeps that it slides.
void project_static_friction(const real* W, const real* inverse, const real* d,
                             PARAMETERS const real* p, uchar* mode, real* lambda) {
  const uchar sliding = *mode & 8;
  real A[D * D];
  for (int i = 0; i < D * D; ++i) A[i] = W[i];
  A[0] += p[2];
  *mode = sliding | (uchar)solve_friction(A, inverse, d, p[sliding ? 1 : 0], INFINITY, lambda);
}

// Parameters: normal (3), axis (3), fp, fc, mu, c, k, hold.
void project_puncture(const real* W, const real* d, PARAMETERS const real* p, uchar* mode,
                      real* lambda) {
  const bool penetrated = *mode == 1;
  PARAMETERS const real* first = p + (penetrated ? 3 : 0);
  // R: the first direction and two across it (Householder), by columns.
  real v[3] = {first[0] + (first[0] >= 0 ? 1 : -1), first[1], first[2]}, R[9];
  const real scale = 2 / (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i)
      R[i + 3 * j] = j == 0 ? first[i] : (i == j ? 1 : 0) - scale * v[i] * v[j];
  real A[D * D], local_d[3], force[3];
  for (int j = 0; j < 3; ++j) {
    local_d[j] = R[3 * j] * d[0] + R[1 + 3 * j] * d[1] + R[2 + 3 * j] * d[2];
    real WR[3];
    for (int i = 0; i < 3; ++i)
      WR[i] = W[i] * R[3 * j] + W[i + D] * R[1 + 3 * j] + W[i + 2 * D] * R[2 + 3 * j];
    for (int i = 0; i < 3; ++i)
      A[i + j * D] = R[3 * i] * WR[0] + R[1 + 3 * i] * WR[1] + R[2 + 3 * i] * WR[2];
  }
  if (penetrated) {
    project_penetrated(A, local_d, p[7], p[10], p[11] != 0, force);
  } else {
    A[0] += p[9];
    real inverse[D * D];
    invert3(A, inverse);
    const int state = solve_friction(A, inverse, local_d, p[8], p[6], force);
    *mode = state == CAPPED_STICK || state == CAPPED_SLIP ? 2 : 0;
  }
  for (int i = 0; i < 3; ++i)
    lambda[i] = R[i] * force[0] + R[i + 3] * force[1] + R[i + 6] * force[2];
}
#endif

void project_cutting(const real* W, const real* d, PARAMETERS const real* p, uchar* mode,
                     real* lambda) {
  *mode = d[0] >= 0 ? 0 : -d[0] <= W[0] * p[0] ? 1 : 2;
  lambda[0] = *mode == 0 ? 0 : *mode == 1 ? -d[0] / W[0] : p[0];
}

// Parameters: Rs, Rk, c.
void project_path_friction(const real* W, const real* d, PARAMETERS const real* p, uchar* mode,
                           real* lambda) {
  const real limit = *mode == 0 ? p[0] : p[1], w = W[0], size = fabs(d[0]);
  if (size <= w * limit) {
    lambda[0] = w > 0 ? -d[0] / w : 0;
    return;
  }
  lambda[0] = copysign(limit + p[2] * (size - w * limit) / (1 + w * p[2]), -d[0]);
}

// Numbers of the laws as in law_twins.cpp.
void project(int law, const real* W, const real* inverse, const real* d,
             PARAMETERS const real* p, uchar* mode, real* lambda) {
  switch (law) {
    case 0: project_bilateral(1, W, inverse, d, p, mode, lambda); break;
#if D >= 2
    case 1: project_bilateral(2, W, inverse, d, p, mode, lambda); break;
    case 10: project_turning_force(W, d, p, mode, lambda); break;
#endif
#if D >= 3
    case 2: project_bilateral(3, W, inverse, d, p, mode, lambda); break;
    case 5: project_coulomb(W, inverse, d, p, mode, lambda); break;
    case 9: project_static_friction(W, inverse, d, p, mode, lambda); break;
    case 6: project_puncture(W, d, p, mode, lambda); break;
#endif
#if D >= 6
    case 3: project_bilateral(6, W, inverse, d, p, mode, lambda); break;
#endif
    case 4: project_unilateral(W, d, p, mode, lambda); break;
    case 7: project_cutting(W, d, p, mode, lambda); break;
    case 8: project_path_friction(W, d, p, mode, lambda); break;
  }
}

// What `project` wants as `inverse`: Cholesky, then its inverse, then the product.
void invert_with_compliance(int law, int n, const real* W, PARAMETERS const real* p,
                            real* inverse) {
  real L[D * D];
  for (int i = 0; i < D * D; ++i) L[i] = W[i];
  if (law == 4) L[0] += p[0];
  if (law == 5) L[0] += p[1];
  if (law == 9) L[0] += p[2];
  for (int i = 0; i < n && law < 4; ++i) L[i + i * D] += p[0];
  for (int j = 0; j < n; ++j) {
    for (int k = 0; k < j; ++k) L[j + j * D] -= L[j + k * D] * L[j + k * D];
    L[j + j * D] = sqrt(L[j + j * D]);
    for (int i = j + 1; i < n; ++i) {
      for (int k = 0; k < j; ++k) L[i + j * D] -= L[i + k * D] * L[j + k * D];
      L[i + j * D] /= L[j + j * D];
    }
  }
  real M[D * D];  // of L, lower
  for (int j = 0; j < n; ++j)
    for (int i = j; i < n; ++i) {
      real sum = i == j ? 1 : 0;
      for (int k = j; k < i; ++k) sum -= L[i + k * D] * M[k + j * D];
      M[i + j * D] = sum / L[i + i * D];
    }
  for (int i = 0; i < D * D; ++i) inverse[i] = 0;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      real sum = 0;
      for (int k = max(i, j); k < n; ++k) sum += M[k + i * D] * M[k + j * D];
      inverse[i + j * D] = sum;
    }
}
