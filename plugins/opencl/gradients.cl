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

// x <- 0, r <- b, zero where fixed.
GROUP start(int nodes, global const uchar* is_fixed, global const real* b, global real* x,
            global real* r, global real* size2, global real* residual2) {
  local real sums[ITEMS];
  real bb = 0;
  for (int i = get_global_id(0); i < nodes; i += get_global_size(0))
    for (int k = 0; k < 3; ++k) {
      const real mine = is_fixed[i] ? 0 : b[3 * i + k];
      x[3 * i + k] = 0;
      r[3 * i + k] = mine;
      bb += mine * mine;
    }
  leave_sum(bb, size2, sums);
  leave_sum(bb, residual2, sums);
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
