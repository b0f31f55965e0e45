// Solving with a supernodal factor; panels.h says what a panel is. `number` is the type of the
// factor. All groups have ITEMS = 256 items.

typedef struct {
  int first, width, height, stride, value, row, below, front, inverse;
} Panel;

// The column rows of every panel inverted, by columns. One item makes one column of the inverse,
// first as a row, so that items write side by side.
kernel void invert(global const Panel* panels, global const number* value, global number* inverse) {
  const Panel p = panels[get_group_id(0)];
  global const number* L = value + p.value;
  global number* M = inverse + p.inverse;
  const int w = p.width;
  for (int j = get_local_id(0); j < w; j += ITEMS)
    for (int i = j; i < w; ++i) {
      number sum = i == j ? 1 : 0;
      for (int k = j; k < i; ++k) sum -= L[i + (size_t)k * p.stride] * M[j + k * w];
      M[j + i * w] = sum / L[i + (size_t)i * p.stride];
    }
  barrier(CLK_GLOBAL_MEM_FENCE);
  for (int e = get_local_id(0); e < w * w; e += ITEMS) {
    const int j = e % w, i = e / w;
    if (j < i) M[i + j * w] = M[j + i * w];
  }
  barrier(CLK_GLOBAL_MEM_FENCE);
  for (int e = get_local_id(0); e < w * w; e += ITEMS)
    if (e % w < e / w) M[e] = 0;
}

// What the children leave for row r of the front, and the right-hand side.
real at_front(const Panel p, int r, global const int* gather_start, global const int* gather,
              global const real* b, global const real* below) {
  real sum = r < p.width ? b[p.first + r] : 0;
  for (int e = gather_start[p.front + r]; e < gather_start[p.front + r + 1]; ++e)
    sum += below[gather[e]];
  return sum;
}

// 64 rows, four items each: sum over columns `from`[0 .. width) of L, of which row 0 is the first.
real row_sum(int row, int rows, int width, int stride, global const number* L,
             local const real* from, local real* sums) {
  const int part = get_local_id(0) / 64;
  real sum = 0;
  if (row < rows)
    for (int j = part; j < width; j += 4) sum += (real)L[row + (size_t)j * stride] * from[j];
  sums[get_local_id(0)] = sum;
  barrier(CLK_LOCAL_MEM_FENCE);
  const int here = get_local_id(0) % 64;
  sum = sums[here] + sums[here + 64] + sums[here + 128] + sums[here + 192];
  barrier(CLK_LOCAL_MEM_FENCE);
  return sum;
}

// y of 64 rows of a panel.
void forward_rows(const Panel p, int tile, global const int* gather_start,
                  global const int* gather, global const number* inverse, global const real* b,
                  global const real* below, global real* y, local real* from, local real* sums) {
  const int item = get_local_id(0), row = tile * 64 + item % 64;
  for (int r = item; r < p.width; r += ITEMS)
    from[r] = at_front(p, r, gather_start, gather, b, below);
  barrier(CLK_LOCAL_MEM_FENCE);
  const real sum = row_sum(row, p.width, min(p.width, tile * 64 + 64), p.width,
                           inverse + p.inverse, from, sums);
  if (item < 64 && row < p.width) y[p.first + row] = sum;
}

// What a panel leaves in 64 of its rows below.
void forward_below(const Panel p, int tile, global const int* gather_start,
                   global const int* gather, global const number* value, global const real* b,
                   global real* below, global const real* y, local real* from, local real* sums) {
  const int item = get_local_id(0), rows = p.height - p.width, row = tile * 64 + item % 64;
  for (int r = item; r < p.width; r += ITEMS) from[r] = y[p.first + r];
  barrier(CLK_LOCAL_MEM_FENCE);
  const real sum =
      row_sum(row, rows, p.width, p.stride, value + p.value + p.width, from, sums);
  if (item < 64 && row < rows)
    below[p.below + row] = at_front(p, p.width + row, gather_start, gather, b, below) - sum;
}

// 8 columns, 32 items each: adds what the 32 have.
real column_sum(real mine, local real* sums) {
  const int item = get_local_id(0);
  for (int half_of = 16; half_of > 0; half_of /= 2) {
    sums[item] = mine;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item % 32 < half_of) mine += sums[item + half_of];
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  return mine;
}

// y of 8 columns less what the rows below take.
void backward_below(const Panel p, int tile, global const int* rows, global const number* value,
                    global real* y, global const real* x, local real* sums) {
  const int column = tile * 8 + get_local_id(0) / 32;
  real sum = 0;
  if (column < p.width) {
    global const number* L = value + p.value + (size_t)column * p.stride;
    for (int r = p.width + get_local_id(0) % 32; r < p.height; r += 32)
      sum += (real)L[r] * x[rows[p.row + r]];
  }
  sum = column_sum(sum, sums);
  if (column < p.width && get_local_id(0) % 32 == 0) y[p.first + column] -= sum;
}

void backward_columns(const Panel p, int tile, global const number* inverse, global const real* y,
                      global real* x, local real* sums) {
  const int column = tile * 8 + get_local_id(0) / 32;
  real sum = 0;
  if (column < p.width) {
    global const number* M = inverse + p.inverse + (size_t)column * p.width;
    for (int i = column + get_local_id(0) % 32; i < p.width; i += 32)
      sum += (real)M[i] * y[p.first + i];
  }
  sum = column_sum(sum, sums);
  if (column < p.width && get_local_id(0) % 32 == 0) x[p.first + column] = sum;
}

// The kernels: one task per group. `done`: the iteration has ended, and nothing is to be done any
// more: the panel is one of no size then, so that all items still meet at the same barriers.
#define GROUP kernel __attribute__((reqd_work_group_size(ITEMS, 1, 1))) void

Panel panel_of(global const Panel* panels, int number, global const int* done) {
  Panel p = panels[number];
  if (*done) p.width = p.height = 0;
  return p;
}

GROUP solve_rows(int first_task, global const int2* tasks, global const Panel* panels,
                 global const int* gather_start, global const int* gather,
                 global const number* inverse, global const real* b, global const real* below,
                 global real* y, global const int* done) {
  local real from[MOST_WIDTH], sums[ITEMS];
  const int2 task = tasks[first_task + get_group_id(0)];
  forward_rows(panel_of(panels, task.x, done), task.y, gather_start, gather, inverse, b, below, y, from, sums);
}

GROUP solve_below(int first_task, global const int2* tasks, global const Panel* panels,
                  global const int* gather_start, global const int* gather,
                  global const number* value, global const real* b, global real* below,
                  global const real* y, global const int* done) {
  local real from[MOST_WIDTH], sums[ITEMS];
  const int2 task = tasks[first_task + get_group_id(0)];
  forward_below(panel_of(panels, task.x, done), task.y, gather_start, gather, value, b, below, y, from, sums);
}

GROUP solve_back_below(int first_task, global const int2* tasks, global const Panel* panels,
                       global const int* rows, global const number* value, global real* y,
                       global const real* x, global const int* done) {
  local real sums[ITEMS];
  const int2 task = tasks[first_task + get_group_id(0)];
  backward_below(panel_of(panels, task.x, done), task.y, rows, value, y, x, sums);
}

GROUP solve_back_columns(int first_task, global const int2* tasks, global const Panel* panels,
                         global const number* inverse, global const real* y, global real* x,
                         global const int* done) {
  local real sums[ITEMS];
  const int2 task = tasks[first_task + get_group_id(0)];
  backward_columns(panel_of(panels, task.x, done), task.y, inverse, y, x, sums);
}

// A whole subtree.
GROUP solve_subtrees(global const int* start, global const int* subtree,
                     global const Panel* panels, global const int* gather_start,
                     global const int* gather, global const number* value,
                     global const number* inverse, global const real* b, global real* below,
                     global real* y, global const int* done) {
  local real from[MOST_WIDTH], sums[ITEMS];
  const int begin = start[get_group_id(0)], end = *done ? begin : start[get_group_id(0) + 1];
  for (int n = begin; n < end; ++n) {
    const Panel p = panels[subtree[n]];
    for (int tile = 0; tile * 64 < p.width; ++tile)
      forward_rows(p, tile, gather_start, gather, inverse, b, below, y, from, sums);
    barrier(CLK_GLOBAL_MEM_FENCE);
    for (int tile = 0; tile * 64 < p.height - p.width; ++tile)
      forward_below(p, tile, gather_start, gather, value, b, below, y, from, sums);
    barrier(CLK_GLOBAL_MEM_FENCE);
  }
}

GROUP solve_back_subtrees(global const int* start, global const int* subtree,
                          global const Panel* panels, global const int* rows,
                          global const number* value, global const number* inverse,
                          global real* y, global real* x, global const int* done) {
  local real sums[ITEMS];
  const int begin = start[get_group_id(0)], end = *done ? begin : start[get_group_id(0) + 1];
  for (int n = end - 1; n >= begin; --n) {
    const Panel p = panels[subtree[n]];
    for (int tile = 0; tile * 8 < p.width; ++tile)
      backward_below(p, tile, rows, value, y, x, sums);
    barrier(CLK_GLOBAL_MEM_FENCE);
    for (int tile = 0; tile * 8 < p.width; ++tile) backward_columns(p, tile, inverse, y, x, sums);
    barrier(CLK_GLOBAL_MEM_FENCE);
  }
}
