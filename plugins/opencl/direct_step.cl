// The direct step: rows of blocks that are free on their tangents form one dense system, which is
// solved by Gauss-Jordan elimination in tiles of 32, without exchanging rows: W is positive definite
// and friction changes little of that. Whoever asks checks the answer.
//
// The system is stored by tiles: tile (I, J) of 32 x 32 numbers by rows, `tiles` tiles down and
// tiles + 1 across; the last ones across hold the right-hand side in their first column. Beyond the
// last row it continues as the identity.
//
// What is asked comes in one piece of integers and one of reals (device.h, TangentSystem).

#define TILE 32
#define ITEMS 256
#define GROUP kernel __attribute__((reqd_work_group_size(ITEMS, 1, 1))) void

typedef struct {
  global const int *first, *first_of_block, *row;
  global const real *scale, *gap, *compliance, *base, *d_free, *move, *test;
} Asked;

Asked asked(int count, int rows, global const int* integers, global const real* reals) {
  Asked a;
  a.first = integers;
  a.first_of_block = a.first + count + 1;
  a.row = a.first_of_block + count;
  a.scale = reals;
  a.gap = a.scale + count;
  a.compliance = a.gap + count;
  a.base = a.compliance + count * MOST;
  a.d_free = a.base + rows;
  a.move = a.d_free + rows;
  a.test = a.move + a.first[count];
  return a;
}

// 32 rows, 8 items each: adds what the 8 have.
real sum_of_row(real mine, local real* sums) {
  sums[get_local_id(0)] = mine;
  barrier(CLK_LOCAL_MEM_FENCE);
  real sum = 0;
  for (int part = 0; part < 8; ++part) sum += sums[32 * part + get_local_id(0) % 32];
  return sum;
}

// delta <- W base + d_free.
GROUP direct_start(int count, int rows, global const int* integers, global const real* reals,
                   global const raw* W, global real* delta) {
  local real sums[ITEMS];
  const Asked a = asked(count, rows, integers, reals);
  const int r = get_group_id(0) * 32 + get_local_id(0) % 32, part = get_local_id(0) / 32;
  real mine = 0;
  for (int c = part; r < rows && c < rows; c += 8) mine += (real)W[r + (size_t)c * rows] * a.base[c];
  const real sum = sum_of_row(mine, sums);
  if (part == 0 && r < rows) delta[r] = sum + a.d_free[r];
}

// The right-hand side, scaled, is left in `answer` too.
GROUP direct_system(int count, int rows, int tiles, real regularisation, global const int* integers,
                    global const real* reals, global const raw* W, global const real* delta,
                    global real* answer, global real* system) {
  const Asked a = asked(count, rows, integers, reals);
  const int size = tiles * TILE, across = size + TILE, e = get_global_id(0);
  if (e >= size * across) return;
  const int i = e / across, j = e % across;
  real g = i == j ? 1 : 0;
  if (j >= size) {
    g = 0;
    if (i < count && j == size) {
      g = a.gap[i];
      for (int n = a.first[i]; n < a.first[i + 1]; ++n) g += a.test[n] * delta[a.row[n]];
      answer[count + i] = g = -a.scale[i] * g;
    }
  } else if (i < count && j < count) {
    g = 0;
    for (int m = a.first[j]; m < a.first[j + 1]; ++m)
      for (int n = a.first[i]; n < a.first[i + 1]; ++n)
        g += a.test[n] * a.move[m] * (real)W[a.row[n] + (size_t)a.row[m] * rows];
    if (a.first_of_block[i] == a.first_of_block[j])
      g += a.compliance[j * MOST + i - a.first_of_block[j]];
    g = a.scale[i] * g * a.scale[j] + (i == j ? regularisation : 0);
  }
  const int tile = i / TILE * (tiles + 1) + j / TILE;
  system[(size_t)tile * TILE * TILE + i % TILE * TILE + j % TILE] = g;
}

// Takes tile column k out of all other rows: one tile of the rest per group. Every group inverts the
// tile on the diagonal for itself, so that nothing waits.
GROUP direct_eliminate(int k, int tiles, global const real* system, global real* next) {
  local real pivot[TILE * (TILE + 1)], other[TILE * TILE], left[TILE * (TILE + 1)];
  const int item = get_local_id(0), rest = tiles - k;  // tiles right of column k
  const int I = get_group_id(0) / rest, J = k + 1 + get_group_id(0) % rest;
  global const real* D = system + (size_t)(k * (tiles + 1) + k) * TILE * TILE;
  global const real* R = system + (size_t)(k * (tiles + 1) + J) * TILE * TILE;
  global const real* L = system + (size_t)(I * (tiles + 1) + k) * TILE * TILE;
  const size_t here = (size_t)(I * (tiles + 1) + J) * TILE * TILE;
  for (int e = item; e < TILE * TILE; e += ITEMS) {
    pivot[e / TILE * (TILE + 1) + e % TILE] = D[e];
    left[e / TILE * (TILE + 1) + e % TILE] = L[e];
    other[e] = R[e];
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  // In place: the inverse of `pivot`. An item has four numbers of column c.
  const int c = item % TILE, r0 = item / TILE;
  real mine[4];
  for (int p = 0; p < TILE; ++p) {
    const real inverse = 1 / pivot[p * (TILE + 1) + p];
    const real top = pivot[p * (TILE + 1) + c] * inverse;
    for (int n = 0; n < 4; ++n) {
      const int r = r0 + 8 * n;
      const real side = pivot[r * (TILE + 1) + p], old = pivot[r * (TILE + 1) + c];
      mine[n] = r == p ? (c == p ? inverse : top) : c == p ? -side * inverse : old - side * top;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    for (int n = 0; n < 4; ++n) pivot[(r0 + 8 * n) * (TILE + 1) + c] = mine[n];
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  for (int n = 0; n < 4; ++n) {
    mine[n] = 0;
    for (int m = 0; m < TILE; ++m)
      mine[n] += pivot[(r0 + 8 * n) * (TILE + 1) + m] * other[m * TILE + c];
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int n = 0; n < 4; ++n) other[(r0 + 8 * n) * TILE + c] = mine[n];
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int n = 0; n < 4; ++n) {
    const int r = r0 + 8 * n;
    real sum = 0;
    for (int m = 0; m < TILE; ++m) sum += left[r * (TILE + 1) + m] * other[m * TILE + c];
    next[here + r * TILE + c] = I == k ? other[r * TILE + c] : system[here + r * TILE + c] - sum;
  }
}

// The right-hand side is the solution now: y, and delta with the forces that belong to it.
// answer: y, the right-hand side as it was (there already), delta.
GROUP direct_answer(int count, int rows, int tiles, global const int* integers,
                    global const real* reals, global const raw* W, global const real* system,
                    global const real* delta, global real* answer) {
  local real sums[ITEMS];
  const Asked a = asked(count, rows, integers, reals);
  const int r = get_group_id(0) * 32 + get_local_id(0) % 32, part = get_local_id(0) / 32;
  real mine = 0;
  for (int j = part; j < count; j += 8) {
    const int tile = j / TILE * (tiles + 1) + tiles;
    const real y = a.scale[j] * system[(size_t)tile * TILE * TILE + j % TILE * TILE];
    if (get_group_id(0) == 0 && get_local_id(0) % 32 == 0) answer[j] = y;
    for (int n = a.first[j]; r < rows && n < a.first[j + 1]; ++n)
      mine += a.move[n] * y * (real)W[r + (size_t)a.row[n] * rows];
  }
  const real sum = sum_of_row(mine, sums);
  if (part == 0 && r < rows) answer[2 * count + r] = delta[r] + sum;
}
