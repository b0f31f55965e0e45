// Conjugate gradients: r, z, p, q = A p and x stay on the device. Sums over all nodes are made by
// GROUPS groups of ITEMS items, each of which leaves one number; whoever needs the sum adds these up
// in the same order. Once the iteration is `done` the kernels that are still to come have no nodes:
// x stays as it is.

#define GROUP kernel __attribute__((reqd_work_group_size(ITEMS, 1, 1))) void

typedef struct {
  int done;        // nothing is to be done any more
  int iterations;
  int failed;      // A or P is not positive definite, or something is not finite
  int unused;
  real size, residual;  // |b|, |r|
} Status;

// One number per group: the sum over its items.
void leave_sum(real mine, global real* partial, local real* sums) {
  const int item = get_local_id(0);
  sums[item] = mine;
  for (int half_of = ITEMS / 2; half_of > 0; half_of /= 2) {
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item < half_of) sums[item] += sums[item + half_of];
  }
  if (item == 0) partial[get_group_id(0)] = sums[0];
  barrier(CLK_LOCAL_MEM_FENCE);
}

real whole_sum(global const real* partial, local real* sums) {
  const int item = get_local_id(0);
  sums[item] = item < GROUPS ? partial[item] : 0;
  for (int half_of = ITEMS / 2; half_of > 0; half_of /= 2) {
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item < half_of) sums[item] += sums[item + half_of];
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  const real sum = sums[0];
  barrier(CLK_LOCAL_MEM_FENCE);
  return sum;
}

// Row i of A times p. entries: twice the slot of the block, plus one if it is to be transposed.
void row_product(int i, global const int* row_start, global const int* entries,
                 global const int* columns, global const store* values, global const real* p,
                 real* q) {
  q[0] = q[1] = q[2] = 0;
  for (int e = row_start[i]; e < row_start[i + 1]; ++e) {
    global const store* a = values + 9 * (size_t)(entries[e] >> 1);
    const int by_row = entries[e] & 1 ? 1 : 3, by_column = 4 - by_row;
    const real v[3] = {p[3 * columns[e]], p[3 * columns[e] + 1], p[3 * columns[e] + 2]};
    for (int k = 0; k < 3; ++k)
      for (int j = 0; j < 3; ++j) q[k] += (real)a[k * by_row + j * by_column] * v[j];
  }
}

// Solutions that are kept, by columns of `size`, and their products with A. GROUPS groups each.

// Of those columns whose bit is set in `unknown`.
GROUP kept_products(int nodes, int unknown, global const int* row_start, global const int* entries,
                    global const int* columns, global const store* values,
                    global const uchar* is_fixed, global const real* kept, global real* products) {
  const int column = get_group_id(0) / GROUPS, group = get_group_id(0) % GROUPS;
  const size_t first = (size_t)column * 3 * nodes;
  const int end = unknown >> column & 1 ? nodes : 0;
  for (int i = group * ITEMS + get_local_id(0); i < end; i += GROUPS * ITEMS) {
    real row[3];
    row_product(i, row_start, entries, columns, values, kept + first, row);
    for (int k = 0; k < 3; ++k) products[first + 3 * i + k] = is_fixed[i] ? 0 : row[k];
  }
}

// One sum each: kept_i . b for every i, then kept_i . A kept_j for every j <= i.
GROUP kept_sums(int count, int size, global const real* kept, global const real* products,
                global const real* b, global real* partial) {
  local real sums[ITEMS];
  const int pair = get_group_id(0) / GROUPS, group = get_group_id(0) % GROUPS;
  int i = pair, j = pair - count;
  if (j >= 0)
    for (i = 0; j > i; ++i) j -= i + 1;
  global const real* u = kept + (size_t)i * size;
  global const real* v = j < 0 ? b : products + (size_t)j * size;
  real mine = 0;
  for (int k = group * ITEMS + get_local_id(0); k < size; k += GROUPS * ITEMS) mine += u[k] * v[k];
  leave_sum(mine, partial, sums);
}

// The combination with the least error in the energy norm; nothing of any if that cannot be told.
// As RecentSolutions::start does it. One group, which has eight items for each sum.
GROUP kept_weights(int count, global const real* partial, global real* weights) {
  local real sums[ITEMS];
  const int item = get_local_id(0), pairs = count + count * (count + 1) / 2;
  real mine = 0;
  if (item / 8 < pairs)
    for (int g = item % 8; g < GROUPS; g += 8) mine += partial[item / 8 * GROUPS + g];
  sums[item] = mine;
  barrier(CLK_LOCAL_MEM_FENCE);
  if (item > 0) return;
  real c[MOST], scale[MOST], L[MOST][MOST];
  bool good = true;
  for (int p = 0, i = 0, j = -1; p < pairs; ++p) {
    real sum = 0;
    for (int k = 0; k < 8; ++k) sum += sums[8 * p + k];
    if (p < count) {
      c[p] = sum;
      continue;
    }
    if (++j > i) {
      ++i;
      j = 0;
    }
    L[i][j] = sum;
  }
  const real shift = sizeof(real) == 8 ? (real)1e-10 : (real)1e-5;
  for (int i = 0; i < count; ++i) {
    scale[i] = sqrt(L[i][i]);
    good = good && scale[i] > 0 && isfinite(scale[i]);
    for (int j = 0; j <= i; ++j) {
      real rest = L[i][j] / (scale[i] * scale[j]) + (i == j ? shift : 0);
      for (int k = 0; k < j; ++k) rest -= L[i][k] * L[j][k];
      L[i][j] = i == j ? sqrt(rest) : rest / L[j][j];
    }
    c[i] /= scale[i];
    for (int k = 0; k < i; ++k) c[i] -= L[i][k] * c[k];
    c[i] /= L[i][i];
  }
  for (int i = count - 1; i >= 0; --i) {
    for (int k = i + 1; k < count; ++k) c[i] -= L[k][i] * c[k];
    c[i] /= L[i][i];
    good = good && isfinite(c[i]);
  }
  for (int i = 0; i < count; ++i) weights[i] = good ? c[i] / scale[i] : 0;
}

// x <- the combination, r <- b - A x; zero where fixed.
GROUP start(int nodes, int count, global const real* weights, global const real* kept,
            global const real* products, global const uchar* is_fixed, global const real* b,
            global real* x, global real* r, global real* size2, global real* residual2) {
  local real sums[ITEMS];
  real bb = 0, rr = 0;
  for (int i = get_global_id(0); i < nodes; i += get_global_size(0))
    for (int k = 3 * i; k < 3 * i + 3; ++k) {
      const real mine = is_fixed[i] ? 0 : b[k];
      real sum = 0, left = mine;
      for (int c = 0; c < count; ++c) {
        sum += weights[c] * kept[(size_t)c * 3 * nodes + k];
        left -= weights[c] * products[(size_t)c * 3 * nodes + k];
      }
      x[k] = sum;
      r[k] = left;
      bb += mine * mine;
      rr += left * left;
    }
  leave_sum(bb, size2, sums);
  leave_sum(rr, residual2, sums);
}

GROUP keep(int column, int size, global const real* x, global real* kept) {
  for (int k = get_global_id(0); k < size; k += get_global_size(0))
    kept[(size_t)column * size + k] = x[k];
}

// `iteration` 0: before the first one. One group.
GROUP look(int iteration, real tolerance, int most, global const real* size2,
           global const real* residual2, global Status* status) {
  local real sums[ITEMS];
  const real rr = whole_sum(residual2, sums), bb = whole_sum(size2, sums);
  if (get_local_id(0) == 0 && !status->done) {
    status->size = sqrt(bb);
    status->residual = sqrt(rr);
    status->iterations = iteration;
    if (!isfinite(rr) || !isfinite(bb)) status->failed = 1;
    if (status->failed || sqrt(rr) <= tolerance * sqrt(bb) || iteration >= most) status->done = 1;
  }
}

// The residual in the axes and the order of the factor.
GROUP turn_back(int size, global const int* row_of, global const real* turns,
                global const real* r, global real* b, global const int* done) {
  const int k = get_global_id(0);
  if (*done || k >= size) return;
  const int i = row_of[k] / 3, c = row_of[k] % 3;
  b[k] = turns[9 * i + 3 * c] * r[3 * i] + turns[9 * i + 3 * c + 1] * r[3 * i + 1] +
         turns[9 * i + 3 * c + 2] * r[3 * i + 2];
}

// z <- Q x of the factor; what is left of r . z.
GROUP turn(int nodes, global const int* position, global const real* turns, global const real* x,
           global const real* r, global real* z, global real* rz, global const int* done) {
  local real sums[ITEMS];
  const int end = *done ? 0 : nodes;
  real mine = 0;
  for (int i = get_global_id(0); i < end; i += get_global_size(0)) {
    real v[3];
    for (int c = 0; c < 3; ++c) v[c] = position[3 * i + c] < 0 ? 0 : x[position[3 * i + c]];
    for (int k = 0; k < 3; ++k) {
      const real turned =
          turns[9 * i + k] * v[0] + turns[9 * i + 3 + k] * v[1] + turns[9 * i + 6 + k] * v[2];
      z[3 * i + k] = turned;
      mine += turned * r[3 * i + k];
    }
  }
  leave_sum(mine, rz, sums);
}

// p <- z + (rz / rz of the iteration before) p.
GROUP direction(int first, int size, global const real* rz, global const real* rz_before,
                global const real* z, global real* p, global const int* done) {
  local real sums[ITEMS];
  const int end = *done ? 0 : size;
  const real now = whole_sum(rz, sums), before = first ? 1 : whole_sum(rz_before, sums);
  const real beta = first ? 0 : now / before;
  for (int i = get_global_id(0); i < end; i += get_global_size(0))
    p[i] = first ? z[i] : z[i] + beta * p[i];
}

GROUP product(int nodes, global const int* row_start, global const int* entries,
              global const int* columns, global const store* values, global const uchar* is_fixed,
              global const real* p, global real* q, global real* pq, global const int* done) {
  local real sums[ITEMS];
  const int end = *done ? 0 : nodes;
  real mine = 0;
  for (int i = get_global_id(0); i < end; i += get_global_size(0)) {
    real row[3];
    row_product(i, row_start, entries, columns, values, p, row);
    for (int k = 0; k < 3; ++k) {
      q[3 * i + k] = is_fixed[i] ? 0 : row[k];
      mine += is_fixed[i] ? 0 : row[k] * p[3 * i + k];
    }
  }
  leave_sum(mine, pq, sums);
}

// x and r one step on.
GROUP advance(int size, global const real* rz, global const real* pq, global const real* p,
              global const real* q, global real* x, global real* r, global real* residual2,
              global Status* status) {
  local real sums[ITEMS];
  const int end = status->done ? 0 : size;
  const real up = whole_sum(rz, sums), down = whole_sum(pq, sums), alpha = up / down;
  const bool good = down > 0 && alpha > 0 && isfinite(alpha);
  real mine = 0;
  for (int i = get_global_id(0); i < end; i += get_global_size(0)) {
    if (good) {
      x[i] += alpha * p[i];
      r[i] -= alpha * q[i];
    }
    mine += r[i] * r[i];
  }
  leave_sum(mine, residual2, sums);
  if (end > 0 && !good && get_global_id(0) == 0) status->failed = 1;
}
