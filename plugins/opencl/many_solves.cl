// Solving with a supernodal factor for COLUMNS right-hand sides at once; appended to solves.cl. The
// numbers of one row lie side by side. A group makes 64 rows of a panel, four items each: an item
// has eight of the columns. What it multiplies with goes through local memory, CHUNK rows at a time.

#define COLUMNS 32
#define CHUNK 32

// As at_front, of one column.
real at_front_of(const Panel p, int r, int column, global const int4* gather,
                 global const int* more, global const real* b, global const real* below) {
  const int4 from = gather[p.front + r];
  real sum = r < p.width ? b[(p.first + r) * COLUMNS + column] : 0;
  sum += below[from.x * COLUMNS + column] + below[from.y * COLUMNS + column] +
         below[from.z * COLUMNS + column];
  if (from.w >= 0) return sum + below[from.w * COLUMNS + column];
  for (int k = -2 - from.w; more[k] >= 0; ++k) sum += below[more[k] * COLUMNS + column];
  return sum;
}

// sum[k] += L(row, 0 .. count) from(.., first + k).
void add_rows(int row, int rows, int count, int stride, global const number* L,
              local const real* from, real* sum) {
  if (row >= rows) return;
  const int first = get_local_id(0) / 64 * 8;
  for (int j = 0; j < count; ++j) {
    const real l = L[row + (size_t)j * stride];
    for (int k = 0; k < 8; ++k) sum[k] += l * from[j * COLUMNS + first + k];
  }
}

void many_rows(const Panel p, int tile, global const int4* gather, global const int* more,
               global const number* z, global const real* b, global const real* below,
               global real* y, local real* from) {
  const int item = get_local_id(0), row = tile * 64 + item % 64, first = item / 64 * 8;
  const int end = min(p.width, tile * 64 + 64);
  real sum[8] = {0, 0, 0, 0, 0, 0, 0, 0};
  for (int begin = 0; begin < end; begin += CHUNK) {
    const int count = min(CHUNK, end - begin);
    for (int e = item; e < count * COLUMNS; e += ITEMS)
      from[e] = at_front_of(p, begin + e / COLUMNS, e % COLUMNS, gather, more, b, below);
    barrier(CLK_LOCAL_MEM_FENCE);
    add_rows(row, p.width, count, p.height, z + p.z + (size_t)begin * p.height, from,
             sum);
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  if (row < p.width)
    for (int k = 0; k < 8; ++k) y[(p.first + row) * COLUMNS + first + k] = sum[k];
}

void many_below(const Panel p, int tile, global const int4* gather, global const int* more,
                global const number* z, global const real* b, global real* below,
                local real* from) {
  const int item = get_local_id(0), rows = p.height - p.width, row = tile * 64 + item % 64,
            first = item / 64 * 8;
  real sum[8] = {0, 0, 0, 0, 0, 0, 0, 0};
  for (int begin = 0; begin < p.width; begin += CHUNK) {
    const int count = min(CHUNK, p.width - begin);
    for (int e = item; e < count * COLUMNS; e += ITEMS)
      from[e] = at_front_of(p, begin + e / COLUMNS, e % COLUMNS, gather, more, b, below);
    barrier(CLK_LOCAL_MEM_FENCE);
    add_rows(row, rows, count, p.height, z + p.z + p.width + (size_t)begin * p.height, from, sum);
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  if (row >= rows) return;
  for (int k = 0; k < 8; ++k)
    below[(p.below + row) * COLUMNS + first + k] =
        at_front_of(p, p.width + row, first + k, gather, more, b, below) - sum[k];
}

// sum[k] += L(0 .. rows, column)^T from(.., first + k) for 64 columns of L, which go through `block`
// turned about, so that items read side by side. `index`: which row of `from` belongs to a row of L;
// without it, the row of the same number.
void add_columns(int columns, int rows, int stride, global const number* L, global const int* index,
                 global const real* x, local real* from, local number* block, real* sum) {
  const int item = get_local_id(0), column = item % 64, first = item / 64 * 8;
  for (int begin = 0; begin < rows; begin += CHUNK) {
    const int count = min(CHUNK, rows - begin);
    for (int e = item; e < count * COLUMNS; e += ITEMS) {
      const int r = begin + e / COLUMNS;
      from[e] = x[(index ? index[r] : r) * COLUMNS + e % COLUMNS];
    }
    for (int e = item; e < 64 * CHUNK; e += ITEMS) {
      const int r = e % CHUNK, c = e / CHUNK;
      block[r * 65 + c] =
          r < count && c < columns ? L[begin + r + (size_t)c * stride] : (number)0;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    for (int r = 0; r < count; ++r) {
      const real l = block[r * 65 + column];
      for (int k = 0; k < 8; ++k) sum[k] += l * from[r * COLUMNS + first + k];
    }
    barrier(CLK_LOCAL_MEM_FENCE);
  }
}

void many_back(const Panel p, int tile, global const int* rows, global const number* z,
               global const real* y, global real* x, local real* from, local number* block) {
  const int begin = tile * 64, columns = min(64, p.width - begin), column = get_local_id(0) % 64,
            first = get_local_id(0) / 64 * 8;
  global const number* Z = z + p.z + (size_t)begin * p.height;
  real sum[8] = {0, 0, 0, 0, 0, 0, 0, 0}, below[8] = {0, 0, 0, 0, 0, 0, 0, 0};
  add_columns(columns, p.width - begin, p.height, Z + begin, 0, y + (p.first + begin) * COLUMNS,
              from, block, sum);
  add_columns(columns, p.height - p.width, p.height, Z + p.width, rows + p.row + p.width, x, from,
              block, below);
  if (column < columns)
    for (int k = 0; k < 8; ++k)
      x[(p.first + begin + column) * COLUMNS + first + k] = sum[k] - below[k];
}

// The kernels: one task per group, as in solves.cl.

GROUP solve_many_rows(int first_task, global const int2* tasks, global const Panel* panels,
                      global const int4* gather, global const int* more,
                      global const number* z, global const real* b, global real* below,
                      global real* y) {
  local real from[CHUNK * COLUMNS];
  const int2 task = tasks[first_task + get_group_id(0)];
  const Panel p = panels[task.x];
  const int tiles = (p.width + 63) / 64;
  if (task.y < tiles)
    many_rows(p, task.y, gather, more, z, b, below, y, from);
  else
    many_below(p, task.y - tiles, gather, more, z, b, below, from);
}

GROUP solve_many_back(int first_task, global const int2* tasks, global const Panel* panels,
                      global const int* rows, global const number* z, global const real* y,
                      global real* x) {
  local real from[CHUNK * COLUMNS];
  local number block[CHUNK * 65];
  const int2 task = tasks[first_task + get_group_id(0)];
  many_back(panels[task.x], task.y, rows, z, y, x, from, block);
}

GROUP solve_many_subtrees(int first_tree, global const int* start, global const int* subtree,
                          global const Panel* panels, global const int4* gather,
                          global const int* more, global const number* z, global const real* b,
                          global real* below, global real* y) {
  local real from[CHUNK * COLUMNS];
  const int tree = first_tree + get_group_id(0);
  for (int n = start[tree]; n < start[tree + 1]; ++n) {
    const Panel p = panels[subtree[n]];
    for (int tile = 0; tile * 64 < p.width; ++tile)
      many_rows(p, tile, gather, more, z, b, below, y, from);
    for (int tile = 0; tile * 64 < p.height - p.width; ++tile)
      many_below(p, tile, gather, more, z, b, below, from);
    barrier(CLK_GLOBAL_MEM_FENCE);
  }
}

GROUP solve_many_back_subtrees(int first_tree, global const int* start, global const int* subtree,
                               global const Panel* panels, global const int* rows,
                               global const number* z, global const real* y, global real* x) {
  local real from[CHUNK * COLUMNS];
  local number block[CHUNK * 65];
  const int tree = first_tree + get_group_id(0);
  for (int n = start[tree + 1] - 1; n >= start[tree]; --n) {
    const Panel p = panels[subtree[n]];
    for (int tile = 0; tile * 64 < p.width; ++tile)
      many_back(p, tile, rows, z, y, x, from, block);
    barrier(CLK_GLOBAL_MEM_FENCE);
  }
}

// Column c of b: one where `position[c]` is, zero elsewhere.
kernel void many_units(int size, global const int* position, global real* b) {
  const int e = get_global_id(0);
  if (e < size * COLUMNS) b[e] = position[e % COLUMNS] == e / COLUMNS ? 1 : 0;
}

// Some rows of x, by columns. Position -1: zero.
kernel void many_entries(int rows, global const int* position, global const real* x,
                         global real* entries) {
  const int r = get_global_id(0) / COLUMNS, c = get_global_id(0) % COLUMNS;
  if (r < rows) entries[c * rows + r] = position[r] < 0 ? 0 : x[position[r] * COLUMNS + c];
}
