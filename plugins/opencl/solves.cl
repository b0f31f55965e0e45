// Solving with a supernodal factor; panels.h says what a panel is. `number` is the type of the
// factor. All groups have ITEMS = 256 items.
//
// When a factor arrives, every panel is multiplied with the inverse of its triangle:
//   Z = | L11^-1     |    so that forward   y = L11^-1 f,  what it leaves = f below - M f,
//       | L21 L11^-1 |    and back          x = L11^-T y - M^T x below,          M = L21 L11^-1.
// Rows and columns of Z do not wait for each other: a panel is one step each way.

typedef struct {
  int first, width, height, stride, value, row, below, front, z;
} Panel;

#define TILE 64

// c += a b of tiles of 64 x 64, by columns; `a` has `rows` rows and `count` columns, `b` has `count`
// rows and `columns` columns, the rest counts as zero. An item makes 4 x 4 numbers, 16 apart.
void add_product(int rows, int count, int columns, global const number* a, int stride_a,
                 global const number* b, int stride_b, number sign, local number* block_a,
                 local number* block_b, number* c) {
  const int item = get_local_id(0), i0 = item % 16, j0 = item / 16;
  for (int begin = 0; begin < count; begin += 16) {
    for (int e = item; e < 16 * TILE; e += ITEMS) {
      const int i = e % TILE, k = e / TILE;
      block_a[e] = i < rows && begin + k < count ? a[i + (size_t)(begin + k) * stride_a] : (number)0;
      const int kb = e % 16, j = e / 16;
      block_b[kb * TILE + j] =
          begin + kb < count && j < columns ? b[begin + kb + (size_t)j * stride_b] : (number)0;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    for (int k = 0; k < 16; ++k)
      for (int j = 0; j < 4; ++j) {
        const number right = sign * block_b[k * TILE + j0 + 16 * j];
        for (int i = 0; i < 4; ++i) c[4 * j + i] += block_a[k * TILE + i0 + 16 * i] * right;
      }
    barrier(CLK_LOCAL_MEM_FENCE);
  }
}

void store_tile(int rows, int columns, const number* c, global number* to, int stride) {
  const int i0 = get_local_id(0) % 16, j0 = get_local_id(0) / 16;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i)
      if (i0 + 16 * i < rows && j0 + 16 * j < columns)
        to[i0 + 16 * i + (size_t)(j0 + 16 * j) * stride] = c[4 * j + i];
}

// The tiles on the diagonal of the triangle: one item makes one column of the inverse.
kernel void invert_tiles(global const int2* tasks, global const Panel* panels,
                         global const number* value, global number* z) {
  local number L[TILE * TILE];
  const int2 task = tasks[get_group_id(0)];
  const Panel p = panels[task.x];
  const int first = task.y * TILE, size = min(TILE, p.width - first), item = get_local_id(0);
  global const number* from = value + p.value + first + (size_t)first * p.stride;
  for (int e = item; e < size * size; e += ITEMS)
    L[e % size * TILE + e / size] = from[e % size + (size_t)(e / size) * p.stride];
  barrier(CLK_LOCAL_MEM_FENCE);
  if (item >= size) return;
  number column[TILE];
  global number* to = z + p.z + first + (size_t)(first + item) * p.height;
  for (int i = 0; i < size; ++i) {
    number sum = i == item ? 1 : 0;
    for (int k = item; k < i; ++k) sum -= L[i * TILE + k] * column[k];
    column[i] = i < item ? 0 : sum / L[i * TILE + i];
    to[i] = column[i];
  }
}

// The other tiles of the inverse, 64 columns of a panel per group, downwards.
kernel void invert_columns(global const int2* tasks, global const Panel* panels,
                           global const number* value, global number* z) {
  local number block_a[16 * TILE], block_b[16 * TILE];
  const int2 task = tasks[get_group_id(0)];
  const Panel p = panels[task.x];
  const int first = task.y * TILE, columns = min(TILE, p.width - first);
  global number* Z = z + p.z + (size_t)first * p.height;
  for (int row = first + TILE; row < p.width; row += TILE) {
    const int rows = min(TILE, p.width - row);
    number sum[16] = {0}, product[16] = {0};
    add_product(rows, row - first, columns, value + p.value + row + (size_t)first * p.stride,
                p.stride, Z + first, p.height, -1, block_a, block_b, sum);
    store_tile(rows, columns, sum, Z + row, p.height);
    barrier(CLK_GLOBAL_MEM_FENCE);
    add_product(rows, rows, columns, z + p.z + row + (size_t)row * p.height, p.height, Z + row,
                p.height, 1, block_a, block_b, product);
    store_tile(rows, columns, product, Z + row, p.height);
    barrier(CLK_GLOBAL_MEM_FENCE);
  }
}

// M: 64 rows below times 64 columns per group.
kernel void multiply_below(global const int2* tasks, global const Panel* panels,
                           global const number* value, global number* z) {
  local number block_a[16 * TILE], block_b[16 * TILE];
  const int2 task = tasks[get_group_id(0)];
  const Panel p = panels[task.x];
  const int tiles = (p.width + TILE - 1) / TILE, row = p.width + task.y / tiles * TILE,
            first = task.y % tiles * TILE;
  const int rows = min(TILE, p.height - row), columns = min(TILE, p.width - first);
  number sum[16] = {0};
  add_product(rows, p.width - first, columns, value + p.value + row + (size_t)first * p.stride,
              p.stride, z + p.z + first + (size_t)first * p.height, p.height, 1, block_a, block_b,
              sum);
  store_tile(rows, columns, sum, z + p.z + row + (size_t)first * p.height, p.height);
}

// What the children leave for row r of the front, and the right-hand side (panels.h).
real at_front(const Panel p, int r, global const int4* gather, global const int* more,
              global const real* b, global const real* below) {
  const int4 from = gather[p.front + r];
  real sum = r < p.width ? b[p.first + r] : 0;
  sum += below[from.x] + below[from.y] + below[from.z];
  if (from.w >= 0) return sum + below[from.w];
  for (int k = -2 - from.w; more[k] >= 0; ++k) sum += below[more[k]];
  return sum;
}

// The first `count` rows of the front.
void gather_front(const Panel p, int count, global const int4* gather, global const int* more,
                  global const real* b, global const real* below, local real* from) {
#pragma unroll 4
  for (int r = get_local_id(0); r < count; r += ITEMS)
    from[r] = at_front(p, r, gather, more, b, below);
  barrier(CLK_LOCAL_MEM_FENCE);
}

// ITEMS / parts rows of a panel, `parts` items each: y, or what the panel leaves. `from`: the first
// `known` rows of the front, at least those of the columns.
void forward_rows(const Panel p, int tile, int parts, int known, global const int4* gather,
                  global const int* more, global const number* z, global const real* b,
                  global real* below, global real* y, local const real* from, local real* sums) {
  const int rows = ITEMS / parts, item = get_local_id(0), row = tile * rows + item % rows;
  const int end = row < p.height ? min(p.width, row + 1) : 0;
  const bool ends = item < rows && row < p.height;
  global const number* Z = z + p.z + row;
  const real left = !ends || row < p.width ? 0
                    : row < known          ? from[row]
                                           : at_front(p, row, gather, more, b, below);
  real sum = 0;
#pragma unroll 16
  for (int j = item / rows; j < end; j += parts) sum += (real)Z[(size_t)j * p.height] * from[j];
  if (parts > 1) {
    sums[item] = sum;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (int part = 1; ends && part < parts; ++part) sum += sums[rows * part + item];
  }
  if (ends) {
    if (row < p.width)
      y[p.first + row] = sum;
    else
      below[p.below + row - p.width] = left - sum;
  }
  if (parts > 1) barrier(CLK_LOCAL_MEM_FENCE);
}

// What the columns of Z are multiplied with on the way back.
real at_back(const Panel p, int r, global const int* rows, global const real* y,
             global const real* x) {
  return r < p.width ? y[p.first + r] : -x[rows[p.row + r]];
}

void gather_back(const Panel p, int begin, global const int* rows, global const real* y,
                 global const real* x, local real* from) {
#pragma unroll 4
  for (int r = begin + get_local_id(0); r < min(p.height, FRONT); r += ITEMS)
    from[r] = at_back(p, r, rows, y, x);
  barrier(CLK_LOCAL_MEM_FENCE);
}

// x of 8 columns, 32 items each. `from`: what gather_back has left, from the first of them on.
void backward_columns(const Panel p, int tile, global const int* rows, global const number* z,
                      global const real* y, global real* x, local const real* from,
                      local real* sums) {
  const int item = get_local_id(0), column = tile * 8 + item / 32;
  real sum = 0;
  if (column < p.width) {
    global const number* Z = z + p.z + (size_t)column * p.height;
    const int known = min(p.height, FRONT);
    int r = tile * 8 + item % 32;
    if (r < column) r += 32;  // above the diagonal there is nothing
#pragma unroll 16
    for (; r < known; r += 32) sum += (real)Z[r] * from[r];
    for (; r < p.height; r += 32) sum += (real)Z[r] * at_back(p, r, rows, y, x);
  }
  for (int half_of = 16; half_of > 0; half_of /= 2) {
    sums[item] = sum;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item % 32 < half_of) sum += sums[item + half_of];
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  if (column < p.width && item % 32 == 0) x[p.first + column] = sum;
}

// The kernels: one task and one right-hand side per group; `count` tasks, right-hand sides `size`
// apart, what is left `left` apart. `done`: the iteration has ended, and nothing is to be done any
// more: the panel is one of no size then, so that all items still meet at the same barriers.
#define GROUP kernel __attribute__((reqd_work_group_size(ITEMS, 1, 1))) void
#define THIS ((int)get_group_id(0) % count)
#define SIDE ((size_t)(get_group_id(0) / count))

Panel panel_of(global const Panel* panels, int number, global const int* done) {
  Panel p = panels[number];
  if (*done) p.width = p.height = 0;
  return p;
}

GROUP solve_forward(int first_task, int count, int size, int left, global const int2* tasks,
                    global const Panel* panels, global const int4* gather, global const int* more,
                    global const number* z, global const real* b, global real* below,
                    global real* y, global const int* done) {
  local real from[MOST_WIDTH], sums[ITEMS];
  const int2 task = tasks[first_task + THIS];
  const Panel p = panel_of(panels, task.x, done);
  b += SIDE * size;
  y += SIDE * size;
  below += SIDE * left;
  gather_front(p, min(p.width, 16 * task.y + 16), gather, more, b, below, from);
  forward_rows(p, task.y, 16, 0, gather, more, z, b, below, y, from, sums);
}

GROUP solve_back(int first_task, int count, int size, global const int2* tasks,
                 global const Panel* panels, global const int* rows, global const number* z,
                 global const real* y, global real* x, global const int* done) {
  local real from[FRONT], sums[ITEMS];
  const int2 task = tasks[first_task + THIS];
  const Panel p = panel_of(panels, task.x, done);
  y += SIDE * size;
  x += SIDE * size;
  gather_back(p, task.y * 8, rows, y, x, from);
  backward_columns(p, task.y, rows, z, y, x, from, sums);
}

// A whole subtree.
GROUP solve_subtrees(int first_tree, int count, int size, int left, global const int* start,
                     global const int* subtree, global const Panel* panels,
                     global const int4* gather, global const int* more, global const number* z,
                     global const real* b, global real* below, global real* y,
                     global const int* done) {
  local real from[FRONT], sums[ITEMS];
  const int tree = first_tree + THIS;
  const int begin = start[tree], end = *done ? begin : start[tree + 1];
  b += SIDE * size;
  y += SIDE * size;
  below += SIDE * left;
  for (int n = begin; n < end; ++n) {
    const Panel p = panels[subtree[n]];
    const int known = min(p.height, FRONT), parts = p.width <= 48 ? 1 : p.width <= 128 ? 2 : 4;
    gather_front(p, known, gather, more, b, below, from);
    for (int tile = 0; tile * (ITEMS / parts) < p.height; ++tile)
      forward_rows(p, tile, parts, known, gather, more, z, b, below, y, from, sums);
    barrier(CLK_GLOBAL_MEM_FENCE | CLK_LOCAL_MEM_FENCE);
  }
}

GROUP solve_back_subtrees(int first_tree, int count, int size, global const int* start,
                          global const int* subtree, global const Panel* panels,
                          global const int* rows, global const number* z, global const real* y,
                          global real* x, global const int* done) {
  local real from[FRONT], sums[ITEMS];
  const int tree = first_tree + THIS;
  const int begin = start[tree], end = *done ? begin : start[tree + 1];
  y += SIDE * size;
  x += SIDE * size;
  for (int n = end - 1; n >= begin; --n) {
    const Panel p = panels[subtree[n]];
    gather_back(p, 0, rows, y, x, from);
    for (int tile = 0; tile * 8 < p.width; ++tile)
      backward_columns(p, tile, rows, z, y, x, from, sums);
    barrier(CLK_GLOBAL_MEM_FENCE | CLK_LOCAL_MEM_FENCE);
  }
}

// Many right-hand sides: b is one where `position` of the side is, zero elsewhere.
kernel void many_units(int size, int sides, int left, int nothing, global const int* position,
                       global real* b, global real* below) {
  const int e = get_global_id(0);
  if (e >= size * sides) return;
  b[e] = position[e / size] == e % size ? 1 : 0;
  if (e < sides) below[(size_t)e * left + nothing] = 0;
}

// Some rows of x, by columns. Position -1: zero.
kernel void many_entries(int rows, int sides, int size, global const int* position,
                         global const real* x, global real* entries) {
  const int r = get_global_id(0) % rows, c = get_global_id(0) / rows;
  if (c < sides) entries[(size_t)c * rows + r] = position[r] < 0 ? 0 : x[position[r] + (size_t)c * size];
}
