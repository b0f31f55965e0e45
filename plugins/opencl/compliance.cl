// The compliance of rows that touch nodes whose compliance C is known: W = H C H^T, H sparse with
// entries of three numbers. C is by columns, `stride` apart, of which what lies above the diagonal
// is there. One item makes one number of a product, so sums have one order.

// Z = C H^T: a column of `size` numbers for every row. `place`: of an entry in C; -1: nothing.
kernel void columns_of_rows(int size, int stride, int rows, global const int* first,
                            global const int* place, global const real* h, global const real* C,
                            global real* Z) {
  const int k = get_global_id(0) % size, r = get_global_id(0) / size;
  if (r >= rows) return;
  real sum = 0;
  for (int e = first[r]; e < first[r + 1]; ++e)
    for (int c = 0; place[e] >= 0 && c < 3; ++c) {
      const int column = 3 * place[e] + c, low = min(k, column), high = max(k, column);
      sum += C[low + (size_t)high * stride] * h[3 * e + c];
    }
  Z[k + (size_t)r * size] = sum;
}

// W = scale H Z, the lower triangle computed and mirrored, so that it is symmetric to the last bit.
kernel void rows_of_products(int size, int rows, real scale, global const int* first,
                             global const int* place, global const real* h, global const real* Z,
                             global real* W) {
  const int i = get_global_id(0) % rows, r = get_global_id(0) / rows;
  if (r >= rows || i < r) return;
  real sum = 0;
  for (int e = first[i]; e < first[i + 1]; ++e)
    for (int c = 0; place[e] >= 0 && c < 3; ++c)
      sum += h[3 * e + c] * Z[3 * place[e] + c + (size_t)r * size];
  W[i + (size_t)r * rows] = W[r + (size_t)i * rows] = scale * sum;
}
