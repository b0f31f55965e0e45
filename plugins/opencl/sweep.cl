// Block Gauss-Seidel. W lies as W[k][i][j][b]: entry (i, j) of the block of rows of b and columns of
// k, so that neighbouring items, which have neighbouring blocks b, read neighbouring numbers of the
// column that has just changed. Blocks of fewer than D rows are filled up with zeros.

size_t entry(int k, int i, int j, int b, int stride) {
  return ((size_t)k * D * D + i * D + j) * stride + b;
}

// W as the CPU has it (by columns, rows x rows) -> W as above.
kernel void pack(int blocks, int rows, int stride, global const int* first_row,
                 global const int* dims, global const raw* from, global store* W) {
  const int b = get_global_id(0) % stride, k = get_global_id(0) / stride;
  if (k >= blocks) return;
  const bool there = b < blocks;
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j) {
      store w = 0;
      if (there && i < dims[b] && j < dims[k])
        w = (store)from[(size_t)(first_row[k] + j) * rows + first_row[b] + i];
      W[entry(k, i, j, b, stride)] = w;
    }
}

// Blocks on the diagonal, and their inverses as the laws want them. D x D, by columns.
kernel void prepare(int blocks, int stride, global const int* dims, global const int* laws,
                    global const int* first_parameter, global const real* parameters,
                    global const store* W, global real* diagonal, global real* inverses) {
  const int b = get_global_id(0);
  if (b >= blocks) return;
  real own[D * D], inverse[D * D];
  for (int j = 0; j < D; ++j)
    for (int i = 0; i < D; ++i) own[i + j * D] = W[entry(b, i, j, b, stride)];
  invert_with_compliance(laws[b], dims[b], own, parameters + first_parameter[b], inverse);
  for (int e = 0; e < D * D; ++e) {
    diagonal[e * stride + b] = own[e];
    inverses[e * stride + b] = inverse[e];
  }
}

// What one item holds of its block while sweeps run.
typedef struct {
  real W[D * D], inverse[D * D], lambda[D], delta[D];
  uchar mode;
  int law, first_parameter;
} Block;

void read_block(Block* x, int b, int stride, global const real* diagonal,
                global const real* inverses, global const int* laws,
                global const int* first_parameter, global const real* lambda,
                global const real* delta, global const uchar* modes) {
  for (int e = 0; e < D * D; ++e) {
    x->W[e] = diagonal[e * stride + b];
    x->inverse[e] = inverses[e * stride + b];
  }
  for (int i = 0; i < D; ++i) {
    x->lambda[i] = lambda[i * stride + b];
    x->delta[i] = delta[i * stride + b];
  }
  x->mode = modes[b];
  x->law = laws[b];
  x->first_parameter = first_parameter[b];
}

void write_block(const Block* x, int b, int stride, global real* lambda, global real* delta,
                 global uchar* modes) {
  for (int i = 0; i < D; ++i) {
    lambda[i * stride + b] = x->lambda[i];
    delta[i * stride + b] = x->delta[i];
  }
  modes[b] = x->mode;
}

// The block asks its law. Others learn of the change, and so does the block itself.
void visit(Block* x, global const real* parameters, local real* change) {
  real d[D], plus[D];
  for (int i = 0; i < D; ++i) {
    real own = 0;
    for (int j = 0; j < D; ++j) own += x->W[i + j * D] * x->lambda[j];
    d[i] = x->delta[i] - own;
    plus[i] = x->lambda[i];
  }
  project(x->law, x->W, x->inverse, d, parameters + x->first_parameter, &x->mode, plus);
  for (int i = 0; i < D; ++i) {
    change[i] = plus[i] - x->lambda[i];
    x->lambda[i] = plus[i];
  }
}

void read_column(store* w, global const store* W, int k, int b, int stride) {
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j) w[i * D + j] = W[entry(k, i, j, b, stride)];
}

void add_change(Block* x, const store* w, local const real* change) {
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j) x->delta[i] += (real)w[i * D + j] * change[j];
}

// One work-group, one item per block, its delta and lambda in registers. One barrier per block: the
// item of the next block applies the change of this one, asks its law at once and leaves its own
// change for the next round, while the others are still applying. The columns of W are read two
// rounds ahead.
kernel __attribute__((reqd_work_group_size(LANES, 1, 1))) void sweep_in_one_group(
    int blocks, int stride, int sweeps, global const store* restrict W,
    global const real* restrict diagonal, global const real* restrict inverses,
    global const int* restrict laws, global const int* restrict first_parameter,
    global const real* restrict parameters, global const uint* restrict orders,
    global real* lambda, global uchar* modes) {
  global real* delta = lambda + D * stride;
  const int b = get_local_id(0);
  local real change[2][D];
  local int order[LANES + 2];
  Block x;
  read_block(&x, b, stride, diagonal, inverses, laws, first_parameter, lambda, delta, modes);
  for (int s = 0; s < sweeps; ++s) {
    barrier(CLK_LOCAL_MEM_FENCE);
    if (b < blocks) order[b] = orders[s * blocks + b];
    barrier(CLK_LOCAL_MEM_FENCE);
    if (b < 2) order[blocks + b] = order[0];  // read ahead, not used
    store now[D * D], next[D * D];
    if (b < blocks) read_column(now, W, order[0], b, stride);
    if (b < blocks) read_column(next, W, order[blocks > 1 ? 1 : 0], b, stride);
    if (b == order[0]) visit(&x, parameters, change[0]);
    for (int k = 0; k < blocks; ++k) {
      barrier(CLK_LOCAL_MEM_FENCE);
      add_change(&x, now, change[k & 1]);
      for (int e = 0; e < D * D; ++e) now[e] = next[e];
      if (b < blocks) read_column(next, W, order[k + 2], b, stride);
      if (k + 1 < blocks && b == order[k + 1]) visit(&x, parameters, change[(k + 1) & 1]);
    }
  }
  if (b < blocks) write_block(&x, b, stride, lambda, delta, modes);
}

// A panel is PANEL blocks that follow each other in the order. Group 0 applies the changes of the
// panel before to the blocks of this one, and then sweeps these as above; the other groups apply
// them to all blocks besides that were in neither. So a sweep takes one launch per panel. SHARE items work together on
// each block: each applies its part of the changes.
//
// `first`: position of the panel in `orders`, `before` that of the one before; their sizes may be 0.
kernel __attribute__((reqd_work_group_size(PANEL* SHARE, 1, 1))) void sweep_panel(
    int blocks, int stride, int first, int size, int before, int size_before, int parity,
    global const store* restrict W, global const real* restrict diagonal,
    global const real* restrict inverses, global const int* restrict laws,
    global const int* restrict first_parameter, global const real* restrict parameters,
    global const uint* restrict orders, global real* changes, global real* lambda,
    global uchar* modes) {
  global real* delta = lambda + D * stride;
  const int item = get_local_id(0), here = item % PANEL, part = item / PANEL;
  const int group = get_group_id(0);
  local int panel[PANEL], panel_before[PANEL];
  local real change[PANEL][D], sums[SHARE][D][PANEL], passed[2][D];
  global const real* old = changes + (1 - parity) * PANEL * D;
  if (item < size) panel[item] = orders[first + item];
  if (item < size_before) panel_before[item] = orders[before + item];
  for (int e = item; e < size_before * D; e += PANEL * SHARE) change[e / D][e % D] = old[e];
  barrier(CLK_LOCAL_MEM_FENCE);

  int b = group == 0 ? (here < size ? panel[here] : -1) : (group - 1) * PANEL + here;
  if (b >= blocks) b = -1;
  for (int k = 0; k < size && group > 0; ++k)
    if (panel[k] == b) b = -1;  // group 0 has it
  real sum[D];
  for (int i = 0; i < D; ++i) sum[i] = 0;
  bool lacks = b >= 0;  // the blocks of the panel before know these changes already
  for (int k = 0; k < size_before; ++k)
    if (panel_before[k] == b) lacks = false;
  if (lacks)
    for (int k = part; k < size_before; k += SHARE) {
      const int from = panel_before[k];
      for (int i = 0; i < D; ++i)
        for (int j = 0; j < D; ++j)
          sum[i] += (real)W[entry(from, i, j, b, stride)] * change[k][j];
    }
  for (int i = 0; i < D; ++i) sums[part][i][here] = sum[i];
  barrier(CLK_LOCAL_MEM_FENCE);
  const bool holds = part == 0 && b >= 0;
  if (holds)
    for (int i = 0; i < D; ++i) {
      for (int q = 1; q < SHARE; ++q) sum[i] += sums[q][i][here];
      delta[i * stride + b] += sum[i];
    }

  // The other groups have nothing more to do.
  const int rounds = group > 0 ? 0 : size;
  Block x;
  store now[D * D], next[D * D];
  const int own = holds ? b : panel[0];
  if (rounds > 0) {
    read_block(&x, own, stride, diagonal, inverses, laws, first_parameter, lambda, delta, modes);
    read_column(now, W, panel[0], own, stride);
    read_column(next, W, panel[size > 1 ? 1 : 0], own, stride);
    if (item == 0) visit(&x, parameters, passed[0]);
  }
  for (int k = 0; k < rounds; ++k) {
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item < D) changes[(parity * PANEL + k) * D + item] = passed[k & 1][item];
    add_change(&x, now, passed[k & 1]);
    for (int e = 0; e < D * D; ++e) now[e] = next[e];
    read_column(next, W, panel[k + 2 < size ? k + 2 : 0], own, stride);
    if (item == k + 1 && item < size) visit(&x, parameters, passed[(k + 1) & 1]);
  }
  if (rounds > 0 && holds) write_block(&x, b, stride, lambda, delta, modes);
}
