// Corotational tetrahedra: the twin of plugins/tissue/corotational_t4.cpp, twist_stiffness.cpp,
// rotation.h and node_rotations.cpp, which say where the formulas come from. A first kernel makes
// what forces and tangent of each tet are made of; then every node and every block of the matrix
// gathers from its tets in ascending order: nothing is added by two at once, so the sums have one
// order. 3x3 matrices are by columns, symmetric ones xx yy zz xy xz yz.

#define DIGITS (EPSILON < 1e-12 ? 1e-8 : 1e-4)  // half of those of a number

// What a tet leaves: gradients of nodes 1, 2, 3 turned by its rotation, then its twist stiffness
// turned likewise; one number is unused.
#define TANGENT 16

// Eigenvalues on the diagonal of a, eigenvectors in the columns of v (Jacobi's method).
void eigen_of(int n, real* a, real* v) {
  for (int i = 0; i < n * n; ++i) v[i] = i % (n + 1) == 0 ? 1 : 0;
  for (int sweep = 0; sweep < 12; ++sweep) {
    real off = 0, size = 0;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) *(i == j ? &size : &off) += a[i * n + j] * a[i * n + j];
    if (!(off > EPSILON * EPSILON * size)) break;
    for (int p = 0; p < n; ++p)
      for (int q = p + 1; q < n; ++q) {
        const real apq = a[p * n + q];
        if (apq == 0) continue;
        const real theta = (a[q * n + q] - a[p * n + p]) / (2 * apq);
        const real t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(1 + theta * theta));
        const real c = 1 / sqrt(1 + t * t), s = t * c;
        for (int k = 0; k < n; ++k) {
          const real kp = a[k * n + p], kq = a[k * n + q];
          a[k * n + p] = c * kp - s * kq;
          a[k * n + q] = s * kp + c * kq;
        }
        for (int k = 0; k < n; ++k) {
          const real pk = a[p * n + k], qk = a[q * n + k];
          a[p * n + k] = c * pk - s * qk;
          a[q * n + k] = s * pk + c * qk;
        }
        for (int k = 0; k < n; ++k) {
          const real kp = v[k * n + p], kq = v[k * n + q];
          v[k * n + p] = c * kp - s * kq;
          v[k * n + q] = s * kp + c * kq;
        }
      }
  }
}

// The largest tr(R^T F) over unit quaternions is the largest eigenvalue of a 4x4 matrix (Horn 1987):
// right for every F, also singular or inverted ones, and slow. If F is not finite, the identity.
void rotation_by_quaternion(const real* F, real* R) {
  real size = 0;
  for (int i = 0; i < 9; ++i) size = fmax(size, fabs(F[i]));
  real f[9], q[4] = {1, 0, 0, 0};
  bool fine = isfinite(size) && size > 0;
  for (int i = 0; i < 9; ++i) {
    fine = fine && isfinite(F[i]);
    f[i] = F[i] / size;
  }
  if (fine) {
    real N[16], v[16];
    N[0] = f[0] + f[4] + f[8];
    N[5] = f[0] - f[4] - f[8];
    N[10] = f[4] - f[0] - f[8];
    N[15] = f[8] - f[0] - f[4];
    N[1] = N[4] = f[5] - f[7];
    N[2] = N[8] = f[6] - f[2];
    N[3] = N[12] = f[1] - f[3];
    N[6] = N[9] = f[3] + f[1];
    N[7] = N[13] = f[6] + f[2];
    N[11] = N[14] = f[7] + f[5];
    eigen_of(4, N, v);
    int best = 0;
    for (int i = 1; i < 4; ++i)
      if (N[5 * i] > N[5 * best]) best = i;
    for (int i = 0; i < 4; ++i) q[i] = v[4 * i + best];
  }
  const real w = q[0], x = q[1], y = q[2], z = q[3];
  R[0] = w * w + x * x - y * y - z * z;
  R[4] = w * w - x * x + y * y - z * z;
  R[8] = w * w - x * x - y * y + z * z;
  R[1] = 2 * (x * y + w * z);
  R[3] = 2 * (x * y - w * z);
  R[2] = 2 * (x * z - w * y);
  R[6] = 2 * (x * z + w * y);
  R[5] = 2 * (y * z + w * x);
  R[7] = 2 * (y * z - w * x);
}

// rotation.h: closed form where it is accurate.
void nearest_rotation(const real* F, real* R) {
  real C[9];
  for (int j = 0; j < 3; ++j) {
    const int u = 3 * ((j + 1) % 3), v = 3 * ((j + 2) % 3);
    C[3 * j] = F[u + 1] * F[v + 2] - F[u + 2] * F[v + 1];
    C[3 * j + 1] = F[u + 2] * F[v] - F[u] * F[v + 2];
    C[3 * j + 2] = F[u] * F[v + 1] - F[u + 1] * F[v];
  }
  real a = 0, c = 0;
  for (int i = 0; i < 9; ++i) {
    a += F[i] * F[i];
    c += C[i] * C[i];
  }
  const real d = F[0] * C[0] + F[1] * C[1] + F[2] * C[2];
  real l = (a + 3) / 2, slope = l;
  for (int i = 0; i < 60; ++i) {
    const real q = l * l - a;
    slope = 4 * l * q - 8 * d;
    const real step = (q * q - 8 * d * l - 4 * c) / slope;
    l -= step > 0 ? step : 0 * step;
    if (!(step > DIGITS * l)) break;
  }
  slope = l * (l * l - a) - 2 * d;
  // The error is that of a number over (slope / |F|^3)^2.
  const real least = EPSILON < 1e-12 ? 1e-4 : 1e-2;
  if (!(slope > 0 && slope * slope > least * a * a * a && l * l < (real)3.0001 * a)) {
    rotation_by_quaternion(F, R);
    return;
  }
  const real inverse = 1 / slope;
  for (int j = 0; j < 3; ++j) {
    real cubic[3] = {0, 0, 0};
    for (int k = 0; k < 3; ++k) {
      const real g = F[3 * k] * F[3 * j] + F[3 * k + 1] * F[3 * j + 1] + F[3 * k + 2] * F[3 * j + 2];
      for (int i = 0; i < 3; ++i) cubic[i] += F[3 * k + i] * g;
    }
    for (int i = 0; i < 3; ++i)
      R[3 * j + i] =
          ((l * l + a) * F[3 * j + i] + 2 * (l * C[3 * j + i] - cubic[i])) * inverse;
  }
}

// F of a tet whose nodes have moved since rest: F = I + sum of moves times gradients.
void gradient_of(const int4 node, global const real* G, global const real* moved, real* F) {
  const int n[3] = {node.y, node.z, node.w};
  for (int i = 0; i < 9; ++i) F[i] = i % 4 == 0 ? 1 : 0;
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < 3; ++i) {
      const real d = moved[3 * n[c] + i] - moved[3 * node.x + i];
      for (int j = 0; j < 3; ++j) F[3 * j + i] += d * G[3 * c + j];
    }
}

void strain_of(const real* F, const real* R, real* E) {
  real S[9];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      S[3 * i + j] =
          R[3 * i] * F[3 * j] + R[3 * i + 1] * F[3 * j + 1] + R[3 * i + 2] * F[3 * j + 2];
  for (int i = 0; i < 3; ++i) E[i] = S[4 * i] - 1;
  E[3] = (S[1] + S[3]) / 2;
  E[4] = (S[2] + S[6]) / 2;
  E[5] = (S[5] + S[7]) / 2;
}

real norm2_of(const real* s) {
  return s[0] * s[0] + s[1] * s[1] + s[2] * s[2] + 2 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]);
}

// twist_stiffness.cpp: G, its negative eigenvalues raised to zero.
void twist_of(const real* E, real mu, real lambda, real* G) {
  const real trace = E[0] + E[1] + E[2];
  const real a = 2 + trace - E[0], b = 2 + trace - E[1], c = 2 + trace - E[2];
  const real d = -E[3], e = -E[4], f = -E[5];
  const real C[6] = {b * c - f * f, a * c - e * e, a * b - d * d,
                     e * f - d * c, d * f - b * e, d * e - a * f};
  const real determinant = a * C[0] + d * C[3] + e * C[4];
  const real factor = 2 * (lambda * trace - 2 * mu) / determinant;
  for (int i = 0; i < 6; ++i) G[i] = factor * C[i] + (i < 3 ? 2 * mu : 0);
  const real modulus = mu + fabs(lambda), tiny = modulus * (EPSILON < 1e-12 ? 1e-9 : 1e-6);
  const real x = G[0] + tiny, y = G[1] + tiny, z = G[2] + tiny;
  const real minor = x * y - G[3] * G[3];
  const real whole = x * (y * z - G[5] * G[5]) - G[3] * (G[3] * z - G[5] * G[4]) +
                     G[4] * (G[3] * G[5] - y * G[4]);
  if (x >= 0 && minor >= 0 && whole >= 0 && determinant > 0) return;
  bool finite = true;
  for (int i = 0; i < 6; ++i) finite = finite && isfinite(G[i]);
  real M[9] = {G[0], G[3], G[4], G[3], G[1], G[5], G[4], G[5], G[2]}, v[9];
  for (int i = 0; i < 6; ++i) G[i] = 0;
  if (!finite) return;
  const bool wild = !(norm2_of(E) < (real)0.25);
  eigen_of(3, M, v);
  for (int k = 0; k < 3; ++k) {
    const real value = fmin(fmax(M[4 * k], (real)0), wild ? 4 * modulus : (real)INFINITY);
    const real p[3] = {v[k], v[3 + k], v[6 + k]};
    for (int i = 0; i < 3; ++i) G[i] += value * p[i] * p[i];
    G[3] += value * p[0] * p[1];
    G[4] += value * p[0] * p[2];
    G[5] += value * p[1] * p[2];
  }
}

// s <- R s R^T.
void turn_symmetric(const real* R, real* s) {
  const real g[9] = {s[0], s[3], s[4], s[3], s[1], s[5], s[4], s[5], s[2]};
  real h[9], t[9];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      h[3 * i + j] = R[i] * g[j] + R[3 + i] * g[3 + j] + R[6 + i] * g[6 + j];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      t[3 * i + j] = h[3 * i] * R[j] + h[3 * i + 1] * R[3 + j] + h[3 * i + 2] * R[6 + j];
  for (int i = 0; i < 3; ++i) s[i] = t[4 * i];
  s[3] = t[1];
  s[4] = t[2];
  s[5] = t[5];
}

// The strain at the start of the step, where it has viscosity.
kernel void element_start(int tets, global const int4* node, global const real* gradient,
                          global const real* moved, global real* start) {
  const int e = get_global_id(0);
  if (e >= tets) return;
  real F[9], R[9], E[6];
  gradient_of(node[e], gradient + 9 * e, moved, F);
  nearest_rotation(F, R);
  strain_of(F, R, E);
  for (int i = 0; i < 6; ++i) start[6 * e + i] = E[i];
}

// Forces of the four nodes of every tet; with `scale`, what its part of A = scale K is made of, and
// its F.
kernel void elements(int tets, real scale, real share, global const int4* node,
                     global const real* gradient, global const real* moduli,
                     global const real* start, global const real* moved, global real* force,
                     global real* tangent, global real* deformation) {
  const int e = get_global_id(0);
  if (e >= tets) return;
  global const real* G = gradient + 9 * e;
  const real mu = moduli[2 * e], lambda = moduli[2 * e + 1];
  real F[9], R[9], E[6];
  gradient_of(node[e], G, moved, F);
  nearest_rotation(F, R);
  strain_of(F, R, E);
  real stiffer = 1;
  if (share != 0) {
    for (int i = 0; i < 6; ++i) E[i] -= share * start[6 * e + i];
    stiffer = 1 / (1 - share);
  }
  const real pressure = stiffer * lambda * (E[0] + E[1] + E[2]), two_mu = 2 * stiffer * mu;
  const real T[9] = {two_mu * E[0] + pressure, two_mu * E[3], two_mu * E[4],
                     two_mu * E[3], two_mu * E[1] + pressure, two_mu * E[5],
                     two_mu * E[4], two_mu * E[5], two_mu * E[2] + pressure};
  real first[3] = {0, 0, 0};
  for (int c = 0; c < 3; ++c) {
    real TG[3];
    for (int i = 0; i < 3; ++i)
      TG[i] = T[3 * i] * G[3 * c] + T[3 * i + 1] * G[3 * c + 1] + T[3 * i + 2] * G[3 * c + 2];
    for (int i = 0; i < 3; ++i) {
      const real t = R[i] * TG[0] + R[3 + i] * TG[1] + R[6 + i] * TG[2];
      force[12 * e + 3 * (c + 1) + i] = -t;
      first[i] += t;
      if (scale != 0)
        tangent[TANGENT * e + 3 * c + i] =
            R[i] * G[3 * c] + R[3 + i] * G[3 * c + 1] + R[6 + i] * G[3 * c + 2];
    }
  }
  for (int i = 0; i < 3; ++i) force[12 * e + i] = first[i];
  if (scale == 0) return;
  real twist[6];
  twist_of(E, mu, lambda, twist);
  turn_symmetric(R, twist);
  for (int i = 0; i < 6; ++i) tangent[TANGENT * e + 9 + i] = scale / 2 * twist[i];
  for (int i = 0; i < 9; ++i) deformation[9 * e + i] = F[i];
}

// `corner`: 4 tet + which of its nodes it is.
kernel void node_forces(int nodes, global const int* first, global const int* corner,
                        global const real* of_tets, global real* force) {
  const int i = get_global_id(0);
  if (i >= nodes) return;
  real sum[3] = {0, 0, 0};
  for (int k = first[i]; k < first[i + 1]; ++k)
    for (int c = 0; c < 3; ++c) sum[c] += of_tets[3 * corner[k] + c];
  for (int c = 0; c < 3; ++c) force[3 * i + c] = sum[c];
}

kernel void node_rotations(int nodes, global const int* first, global const int* corner,
                           global const real* volume, global const real* deformation,
                           global real* rotations) {
  const int i = get_global_id(0);
  if (i >= nodes) return;
  real sum[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0}, R[9], size = 0;
  for (int k = first[i]; k < first[i + 1]; ++k) {
    const int e = corner[k] / 4;
    for (int c = 0; c < 9; ++c) sum[c] += volume[e] * deformation[9 * e + c];
  }
  for (int c = 0; c < 9; ++c) size += sum[c] * sum[c];
  for (int c = 0; c < 9; ++c) sum[c] /= sqrt(size);
  nearest_rotation(sum, R);
  for (int c = 0; c < 9; ++c) rotations[9 * i + c] = R[c];
}

// now times the transpose of then.
kernel void find_turns(int nodes, global const real* then, global const real* now,
                       global real* turns) {
  const int n = get_global_id(0);
  if (n >= nodes) return;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      real sum = 0;
      for (int k = 0; k < 3; ++k) sum += now[9 * n + 3 * k + i] * then[9 * n + 3 * k + j];
      turns[9 * n + 3 * j + i] = sum;
    }
}

constant int block_row[10] = {0, 0, 0, 0, 1, 1, 1, 2, 2, 3};
constant int block_column[10] = {0, 1, 2, 3, 1, 2, 3, 2, 3, 3};

void corner_gradient(global const real* g, int c, real* out) {
  for (int i = 0; i < 3; ++i) out[i] = c == 0 ? -(g[i] + g[3 + i] + g[6 + i]) : g[3 * (c - 1) + i];
}

// Block after block of A. `part`: 16 tet + which of its ten blocks it is. `diagonal_of`: the node of
// a block on the diagonal, -1 elsewhere.
kernel void gather_matrix(int slots, real scale, global const int* first, global const int* part,
                          global const int* diagonal_of, global const real* moduli,
                          global const real* tangent, global const real* diagonal,
                          global store* values) {
  const int s = get_global_id(0);
  if (s >= slots) return;
  real sum[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0};
  const int node = diagonal_of[s];
  for (int k = first[s]; k < first[s + 1]; ++k) {
    const int e = part[k] / 16, pair = part[k] % 16;
    global const real* g = tangent + TANGENT * e;
    real a[3], b[3];
    corner_gradient(g, block_row[pair], a);
    corner_gradient(g, block_column[pair], b);
    const real mu = scale * moduli[2 * e], lambda = scale * moduli[2 * e + 1];
    const real shear = mu * (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
    const real t[6] = {g[9], g[10], g[11], g[12], g[13], g[14]};
    const real w[9] = {t[0], t[3], t[4], t[3], t[1], t[5], t[4], t[5], t[2]};
    real m[9];  // [a]x times twist, by rows
    for (int j = 0; j < 3; ++j) {
      m[j] = a[1] * w[6 + j] - a[2] * w[3 + j];
      m[3 + j] = a[2] * w[j] - a[0] * w[6 + j];
      m[6 + j] = a[0] * w[3 + j] - a[1] * w[j];
    }
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) sum[3 * i + j] += lambda * a[i] * b[j] + mu * b[i] * a[j];
      sum[4 * i] += shear;
      sum[3 * i] += b[1] * m[3 * i + 2] - b[2] * m[3 * i + 1];
      sum[3 * i + 1] += b[2] * m[3 * i] - b[0] * m[3 * i + 2];
      sum[3 * i + 2] += b[0] * m[3 * i + 1] - b[1] * m[3 * i];
    }
  }
  if (node >= 0) {
    for (int i = 0; i < 3; ++i) sum[4 * i] += diagonal[3 * node + i];
    sum[3] = sum[1];  // symmetric to the last bit
    sum[6] = sum[2];
    sum[7] = sum[5];
  }
  for (int i = 0; i < 9; ++i) values[9 * (size_t)s + i] = sum[i];
}
