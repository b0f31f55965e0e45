// A step of many threads at once, one work-group each: what docs/theory/opencl.md says under "Many
// threads at once", in five launches. The beams are those of plugins/thread/element.h, straight at
// rest; what is written there once is not written here again.
//
// Defined by the host: BEAMS, POINTS, GROUP. Matrices are by rows.

#define NODES (BEAMS + 1)
#define COLUMNS (POINTS + 1)  // of answers: one per point of the path, and that to all else

// What all environments share.
typedef struct {
  double dt, length;                  // of a beam
  double axial, bend_1, bend_2, torsion;  // as in ElementRest
  double same, other, couple_same, couple_other, spin_same, spin_other, roll_same, roll_other;
  double hand, hand_turning;          // stiffness of the grip, N/m and N m/rad
  double lateral, friction;           // of a point: N/m, N
  double gravity[3], hand_axis[4];    // the section in the hand keeps this rotation
} Problem;

// An environment as it is. Rotations are w, x, y, z; velocities 6 per node.
typedef struct {
  double position[NODES][3], rotation[NODES][4], velocity[NODES][6], twist[BEAMS], hand[3];
  double friction[POINTS];
  int bound[POINTS];   // the friction is at its limit: 1, -1; inside: 0; no thread there: 2
  int failed, unused;  // some step could not be solved
  double residual;     // of the friction, N
} State;

// What a step makes and forgets.
typedef struct {
  double own_a[BEAMS][36], own_b[BEAMS][36], lacks[BEAMS][12];  // of a beam: on its two nodes
  double diagonal[NODES][36], upper[BEAMS][36], inverse[NODES][36], transfer[BEAMS][36];
  double answer[6 * NODES][COLUMNS];
  double W[POINTS][POINTS], d[POINTS], share[POINTS];
  int beam[POINTS];
} Work;

double3 at(global const double* x) { return (double3)(x[0], x[1], x[2]); }
double3 constant_at(constant const double* x) { return (double3)(x[0], x[1], x[2]); }

void put(global double* x, double3 v) {
  x[0] = v.x;
  x[1] = v.y;
  x[2] = v.z;
}

double4 times(double4 p, double4 q) {  // w, x, y, z
  const double3 u = p.yzw, v = q.yzw;
  return (double4)(p.x * q.x - dot(u, v), p.x * v + q.x * u + cross(u, v));
}

double4 quaternion(global const double* x) { return (double4)(x[0], x[1], x[2], x[3]); }

double3 tangent(double4 q) {
  return (double3)(1 - 2 * (q.z * q.z + q.w * q.w), 2 * (q.y * q.z + q.x * q.w),
                   2 * (q.y * q.w - q.x * q.z));
}

// exp(spin) applied to q.
double4 rotated(double4 q, double3 spin) {
  const double a2 = dot(spin, spin);
  double c = 1 - a2 / 8 + a2 * a2 / 384, s = 0.5 - a2 / 48 + a2 * a2 / 3840;
  if (a2 >= 1e-4) {
    const double a = sqrt(a2);
    c = cos(a / 2);
    s = sin(a / 2) / a;
  }
  return normalize(times((double4)(c, s * spin), q));
}

// First rolls about its tangent, then tilts (chain_motion.h).
double4 turned(double4 q, double3 turn) {
  const double3 along = tangent(q), roll = dot(turn, along) * along;
  return rotated(rotated(q, roll), turn - roll);
}

double3 rotation_between(double4 from, double4 to) {
  double4 d = times(to, (double4)(from.x, -from.yzw));
  if (d.x < 0) d = -d;
  const double sine = length(d.yzw);
  return sine < 1e-9 ? 2 * d.yzw : d.yzw * (2 * atan2(sine, d.x) / sine);
}

// g = angle/sin(angle) and dg/dx of x = 1 - cos(angle).
void angle_factor(double x, double* g, double* dg) {
  if (x < 0.1) {
    const double c[] = {1.,           1. / 3,     2. / 15,    2. / 35,       8. / 315,
                        8. / 693,     16. / 3003, 16. / 6435, 128. / 109395, 128. / 230945,
                        256. / 969969};
    *g = c[10];
    *dg = 0;
    for (int i = 9; i >= 0; --i) {
      *dg = *dg * x + *g;
      *g = *g * x + c[i];
    }
    return;
  }
  x = fmin(x, 1.99);
  const double mu = 1 - x, s2 = x * (2 - x);
  *g = acos(mu) / sqrt(s2);
  *dg = (1 - *g * mu) / s2;
}

// block (3 x 3 at rows i, columns j of a 6 x 6) += scale u v^T
void add_outer(double* block, int i, int j, double scale, double3 u, double3 v) {
  const double a[3] = {u.x, u.y, u.z}, b[3] = {v.x, v.y, v.z};
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) block[(i + r) * 6 + j + c] += scale * a[r] * b[c];
}
void add_identity(double* block, int i, int j, double scale) {
  for (int r = 0; r < 3; ++r) block[(i + r) * 6 + j + r] += scale;
}
// += scale [v], the matrix of x -> v x x
void add_cross(double* block, int i, int j, double scale, double3 v) {
  block[i * 6 + j + 1] -= scale * v.z;
  block[i * 6 + j + 2] += scale * v.y;
  block[(i + 1) * 6 + j] += scale * v.z;
  block[(i + 1) * 6 + j + 2] -= scale * v.x;
  block[(i + 2) * 6 + j] -= scale * v.y;
  block[(i + 2) * 6 + j + 1] += scale * v.x;
}

// One beam: what it adds to the matrix M + h^2 K and to the momentum that is lacking if nothing
// moves, M v + h f. K is the positive semidefinite step_stiffness of element.h.
void add_beam(constant const Problem* p, global State* s, global Work* w, int n) {
  const double h = p->dt, L = p->length;
  const double3 span = at(s->position[n + 1]) - at(s->position[n]);
  const double l = length(span);
  const double3 e = span / l;
  const double4 qa = quaternion(s->rotation[n]), qb = quaternion(s->rotation[n + 1]);
  const double3 ca = tangent(qa), cb = tangent(qb), sa = cross(e, ca), sb = cross(e, cb);
  const double xa = dot(e - ca, e - ca) / 2, xb = dot(e - cb, e - cb) / 2;
  const double m = dot(ca, cb), product = dot(sa, sb);
  double ga, gb, dga, dgb;
  angle_factor(xa, &ga, &dga);
  angle_factor(xb, &gb, &dgb);
  const double3 theta_a = ga * sa, theta_b = gb * sb;
  const double bow =
      2 * dot(theta_a, theta_a) - dot(theta_a, theta_b) + 2 * dot(theta_b, theta_b);
  const double tension = p->axial * ((l - L) / L + bow / 30);
  const double3 ua = qa.yzw, ub = qb.yzw;
  const double raw = 2 * atan2(qa.x * ub.x - qb.x * ua.x - (ua.y * ub.z - ua.z * ub.y),
                               qa.x * qb.x + dot(ua, ub));
  const double turn = 2 * M_PI, twist = raw + turn * rint((s->twist[n] - raw) / turn);
  const double3 twist_axis = (ca + cb) / fmax(1 + m, 1e-3);
  s->twist[n] = twist;

  // Gradient of the energy.
  const double nl = tension * L / 30, up = p->bend_1 / 2 + 2 * nl, ur = p->bend_2 - nl;
  const double d_a = -2 * up * ga - ur * gb * (dga * product + ga * (1 - xb));
  const double d_b = -2 * up * gb - ur * ga * (dgb * product + gb * (1 - xa));
  const double3 pull = d_a * ca + d_b * cb;
  const double3 both = ur * ga * gb * cross(ca, cb) - p->torsion * twist * twist_axis;
  const double3 force = tension * e + (pull - dot(pull, e) * e) / l;
  double3 fa = h * force, ta = -h * (d_a * cross(ca, e) + both);
  double3 fb = -h * force, tb = -h * (d_b * cross(cb, e) - both);

  // Momentum that it has, and that of the fall.
  const double3 g = h * constant_at(p->gravity);
  const double3 va = at(s->velocity[n]) + g, wa = at(s->velocity[n] + 3);
  const double3 vb = at(s->velocity[n + 1]) + g, wb = at(s->velocity[n + 1] + 3);
  const double3 ra = cross(wa, ca), rb = cross(wb, cb);
  fa += p->same * va + p->other * vb + p->couple_same * ra + p->couple_other * rb;
  fb += p->same * vb + p->other * va - p->couple_same * rb - p->couple_other * ra;
  const double3 la = p->roll_same * wa + p->roll_other * wb;
  const double3 lb = p->roll_same * wb + p->roll_other * wa;
  ta += cross(ca, p->couple_same * va - p->couple_other * vb + p->spin_same * ra +
                      p->spin_other * rb) + la + dot(e, la) * e;
  tb += cross(cb, -p->couple_same * vb + p->couple_other * va + p->spin_same * rb +
                      p->spin_other * ra) + lb + dot(e, lb) * e;
  global double* lacks = w->lacks[n];
  put(lacks, fa);
  put(lacks + 3, ta);
  put(lacks + 6, fb);
  put(lacks + 9, tb);

  // K over (v_b - v_a, spin_a, spin_b): columns of how the directors move against the chord.
  const double pos = fmax(tension, 0.), h2 = h * h;
  const double c1 = p->bend_1 + 4 * pos * L / 30, c2 = p->bend_2 - pos * L / 30;
  const double3 tilt_a = cross(ca, e), tilt_b = cross(cb, e), apart = cross(ca, cb);
  const double lean_a = (-4 * ga + gb * (dga * product + ga * (1 - xb))) / 30;
  const double lean_b = (-4 * gb + ga * (dgb * product + gb * (1 - xa))) / 30;
  const double root = sqrt(p->axial * L), roll = sqrt(p->torsion);
  const double3 stretch_v =
      root * (e / L + (lean_a * (ca - dot(ca, e) * e) + lean_b * (cb - dot(cb, e) * e)) / l);
  const double3 stretch_a = root * (lean_a * tilt_a - ga * gb / 30 * apart);
  const double3 stretch_b = root * (lean_b * tilt_b + ga * gb / 30 * apart);
  double3 move_a[9], move_b[9];
  double stretch[9], turns[9];
  for (int i = 0; i < 9; ++i) {
    const int k = i % 3;
    const double3 axis = (double3)(k == 0, k == 1, k == 2);
    const double3 half_roll = dot(axis, e) / 2 * e;
    const double3 turn = cross(e, axis) / l;
    const double3 against_a = i < 3 ? turn : i < 6 ? half_roll - axis : half_roll;
    const double3 against_b = i < 3 ? turn : i < 6 ? half_roll : half_roll - axis;
    move_a[i] = cross(ca, against_a);
    move_b[i] = cross(cb, against_b);
    stretch[i] = dot(axis, i < 3 ? stretch_v : i < 6 ? stretch_a : stretch_b);
    turns[i] = i < 3 ? 0 : (i < 6 ? -roll : roll) * dot(axis, twist_axis);
  }
  double A[36], B[36], U[36];
  for (int i = 0; i < 36; ++i) A[i] = B[i] = U[i] = 0;
  for (int i = 0; i < 9; ++i)
    for (int j = 0; j < 9; ++j) {
      const double k = h2 * (dot(move_a[i], c1 * move_a[j] + c2 * move_b[j]) +
                             dot(move_b[i], c2 * move_a[j] + c1 * move_b[j]) +
                             stretch[i] * stretch[j] + turns[i] * turns[j]);
      const double sign = (i < 3) == (j < 3) ? 1 : -1;
      const bool not_b = i < 6 && j < 6, not_a = (i < 3 || i > 5) && (j < 3 || j > 5);
      if (not_b) A[6 * i + j] += sign * k;
      if (not_a) B[6 * (i < 3 ? i : i - 3) + (j < 3 ? j : j - 3)] += k;
      if (i < 6 && (j < 3 || j > 5))
        U[6 * i + (j < 3 ? j : j - 3)] += (i < 3 ? -1 : 1) * k;
    }
  add_identity(A, 0, 0, h2 * pos / l + p->same);
  add_outer(A, 0, 0, -h2 * pos / l, e, e);
  add_identity(B, 0, 0, h2 * pos / l + p->same);
  add_outer(B, 0, 0, -h2 * pos / l, e, e);
  add_identity(U, 0, 0, -h2 * pos / l + p->other);
  add_outer(U, 0, 0, h2 * pos / l, e, e);

  // Mass; the second of each pair is the transpose of the first.
  add_cross(A, 0, 3, -p->couple_same, ca);
  add_cross(A, 3, 0, p->couple_same, ca);
  add_cross(B, 0, 3, p->couple_same, cb);
  add_cross(B, 3, 0, -p->couple_same, cb);
  add_cross(U, 0, 3, -p->couple_other, cb);
  add_cross(U, 3, 0, -p->couple_other, ca);
  add_identity(A, 3, 3, p->spin_same + p->roll_same);
  add_outer(A, 3, 3, p->roll_same, e, e);
  add_outer(A, 3, 3, -p->spin_same, ca, ca);
  add_identity(B, 3, 3, p->spin_same + p->roll_same);
  add_outer(B, 3, 3, p->roll_same, e, e);
  add_outer(B, 3, 3, -p->spin_same, cb, cb);
  add_identity(U, 3, 3, p->spin_other * m + p->roll_other);
  add_outer(U, 3, 3, p->roll_other, e, e);
  add_outer(U, 3, 3, -p->spin_other, cb, ca);
  for (int i = 0; i < 36; ++i) {
    w->own_a[n][i] = A[i];
    w->own_b[n][i] = B[i];
    w->upper[n][i] = U[i];
  }
}

// The place of the thread that is closest to a point of the path; on its chords.
void locate(constant const double* point, global State* s, global Work* w, int k) {
  const double3 to = constant_at(point);
  double best = INFINITY, share = 0;
  int beam = 0;
  for (int n = 0; n < BEAMS; ++n) {
    const double3 a = at(s->position[n]), along = at(s->position[n + 1]) - a;
    const double t = clamp(dot(to - a, along) / dot(along, along), 0., 1.);
    const double3 off = a + t * along - to;
    if (dot(off, off) < best) {
      best = dot(off, off);
      beam = n;
      share = t;
    }
  }
  w->beam[k] = beam;
  w->share[k] = share;
  // Past one of its ends: the thread has left the point.
  const bool gone = (beam == 0 && share == 0) || (beam == BEAMS - 1 && share == 1);
  if (gone) s->bound[k] = 2;
}

kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void batch_assemble(
    constant const Problem* p, constant const double* path, global const double* actions,
    global State* states, global Work* works) {
  global State* s = states + get_group_id(0);
  global Work* w = works + get_group_id(0);
  const int item = get_local_id(0);
  const double h = p->dt, h2 = h * h;
  if (item < 3) s->hand[item] += h * actions[get_group_id(0) * 3 + item];
  for (int n = item; n < BEAMS; n += GROUP) add_beam(p, s, w, n);
  for (int k = item; k < POINTS; k += GROUP) locate(path + 6 * k, s, w, k);
  barrier(CLK_GLOBAL_MEM_FENCE);
  for (int i = item; i < NODES; i += GROUP) {
    double D[36], r[6];
    for (int e = 0; e < 36; ++e)
      D[e] = (i > 0 ? w->own_b[i - 1][e] : 0) + (i < BEAMS ? w->own_a[i][e] : 0);
    for (int e = 0; e < 6; ++e)
      r[e] = (i > 0 ? w->lacks[i - 1][6 + e] : 0) + (i < BEAMS ? w->lacks[i][e] : 0);
    double3 force = (double3)(0), moment = (double3)(0);
    if (i == BEAMS) {
      const double4 axis =
          (double4)(p->hand_axis[0], p->hand_axis[1], p->hand_axis[2], p->hand_axis[3]);
      add_identity(D, 0, 0, h2 * p->hand);
      add_identity(D, 3, 3, h2 * p->hand_turning);
      force = p->hand * (at(s->hand) - at(s->position[i]));
      moment = p->hand_turning * rotation_between(quaternion(s->rotation[i]), axis);
    }
    // Across the path the tissue is a spring: implicit, so it is part of the matrix.
    for (int k = 0; k < POINTS; ++k) {
      const int n = w->beam[k];
      if (s->bound[k] == 2 || (n != i && n + 1 != i)) continue;
      const double share = w->share[k], mine = n == i ? 1 - share : share;
      const double3 t = constant_at(path + 6 * k + 3), x = at(s->position[n]);
      const double3 gap =
          x + share * (at(s->position[n + 1]) - x) - constant_at(path + 6 * k);
      force -= p->lateral * mine * (gap - dot(gap, t) * t);
      add_identity(D, 0, 0, h2 * p->lateral * mine * mine);
      add_outer(D, 0, 0, -h2 * p->lateral * mine * mine, t, t);
      if (n != i) continue;
      double U[36];
      for (int e = 0; e < 36; ++e) U[e] = 0;
      add_identity(U, 0, 0, h2 * p->lateral * share * (1 - share));
      add_outer(U, 0, 0, -h2 * p->lateral * share * (1 - share), t, t);
      for (int e = 0; e < 18; ++e) w->upper[n][e] += U[e];
    }
    r[0] += h * force.x, r[1] += h * force.y, r[2] += h * force.z;
    r[3] += h * moment.x, r[4] += h * moment.y, r[5] += h * moment.z;
    for (int e = 0; e < 36; ++e) w->diagonal[i][e] = D[e];
    for (int e = 0; e < 6; ++e) {
      for (int k = 0; k < POINTS; ++k) {
        const int n = w->beam[k];
        const double mine = n == i ? 1 - w->share[k] : n + 1 == i ? w->share[k] : 0;
        w->answer[6 * i + e][k] = e < 3 && s->bound[k] != 2 ? mine * path[6 * k + 3 + e] : 0;
      }
      w->answer[6 * i + e][POINTS] = r[e];
    }
  }
}
