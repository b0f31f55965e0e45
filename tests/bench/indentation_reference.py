#!/usr/bin/python3
"""Reference of the indentation case of sutura_bench_tissue, by a program that shares nothing with the library.

Linear elastic block of 40 x 40 x 20 mm, E = 10 kPa, base clamped, sides free, pressure 100 Pa on the middle 10 x 10 mm of its top:
mean sinking of that patch. Quadratic tets (10 nodes) on a quarter of the block, three meshes, extrapolated.
"""
import sys

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as sla

E, PRESSURE, SIDE, PATCH, DEPTH = 1e4, 100.0, 0.02, 0.005, 0.02  # a quarter: SIDE x SIDE x DEPTH, patch PATCH x PATCH


def sinking(nu, n):
    """n cells along each edge of the quarter; the patch has n / 4, so n is a multiple of 4."""
    m = 2 * n  # quadratic grid
    number = lambda i: (i[..., 0] * (m + 1) + i[..., 1]) * (m + 1) + i[..., 2]
    grid = np.stack(np.meshgrid(*[np.arange(m + 1)] * 3, indexing="ij"), -1).reshape(-1, 3)
    points = grid * np.array([SIDE, SIDE, DEPTH]) / m
    cells = 2 * np.stack(np.meshgrid(*[np.arange(n)] * 3, indexing="ij"), -1).reshape(-1, 3)
    corners = []
    for order in ((0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)):
        path = [np.zeros(3, int)]
        for axis in order:
            path.append(path[-1] + 2 * np.eye(3, dtype=int)[axis])
        corners.append(np.stack([cells + p for p in path], 1))
    corners = np.concatenate(corners)  # tets x 4 x 3, doubled grid coordinates
    edges = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)]
    nodes = np.concatenate([number(corners), np.stack([number((corners[:, a] + corners[:, b]) // 2) for a, b in edges], 1)], 1)
    x = points[nodes[:, :4]]
    D = np.stack([x[:, k] - x[:, 0] for k in (1, 2, 3)], 2)
    volume = np.abs(np.linalg.det(D)) / 6
    g = np.linalg.inv(D)
    g = np.concatenate([-g.sum(1, keepdims=True), g], 1)  # tets x 4 x 3
    mu, lam = E / 2 / (1 + nu), E * nu / (1 + nu) / (1 - 2 * nu)
    K = np.zeros((len(nodes), 30, 30))
    a, b = 0.5854101966249685, 0.1381966011250105  # four points, exact to degree 2
    for q in range(4):
        L = np.full(4, b)
        L[q] = a
        G = np.concatenate([(4 * L[:, None] - 1) * g, np.stack([4 * (L[i] * g[:, j] + L[j] * g[:, i]) for i, j in edges], 1)], 1)
        dot = np.einsum("eai,ebi->eab", G, G)
        k = lam * np.einsum("eai,ebj->eaibj", G, G) + mu * np.einsum("ebi,eaj->eaibj", G, G)
        for c in range(3):
            k[:, :, c, :, c] += mu * dot
        K += (volume / 4)[:, None, None] * k.reshape(len(nodes), 30, 30)
    dofs = (3 * nodes[:, :, None] + np.arange(3)).reshape(len(nodes), 30)
    size = 3 * len(points)
    A = sp.coo_matrix((K.ravel(), (np.repeat(dofs, 30, 1).ravel(), np.tile(dofs, (1, 30)).ravel())), (size, size)).tocsc()
    # Load on the patch: corner at the axis of symmetry (0, 0). Simpson's weights of a 2 x 2 grid integrate the products exactly
    # for the mean of a quadratic field; triangles of six nodes carry a uniform load at their mid-side nodes, a third of it each.
    f = np.zeros(size)
    top = [t for t in range(len(nodes)) if (corners[t, :, 2] == m).sum() == 3]
    area = 0
    for t in top:
        up = [k for k in range(4) if corners[t, k, 2] == m]
        if max(points[nodes[t, k]][:2].max() for k in up) > PATCH + 1e-12:
            continue
        s = (SIDE / n) ** 2 / 2
        area += s
        for e, (i, j) in enumerate(edges):
            if i in up and j in up:
                f[3 * nodes[t, 4 + e] + 2] -= PRESSURE * s / 3
    assert abs(area - PATCH**2) < 1e-12
    fixed = np.zeros(size, bool)
    for axis in (0, 1):
        fixed[3 * np.flatnonzero(grid[:, axis] == 0) + axis] = True  # planes of symmetry
    for axis in (0, 1, 2):
        fixed[3 * np.flatnonzero(grid[:, 2] == 0) + axis] = True
    free = np.flatnonzero(~fixed)
    u = np.zeros(size)
    u[free] = sla.spsolve(A[free][:, free], f[free], permc_spec="MMD_AT_PLUS_A")
    return f @ u / (PRESSURE * PATCH**2)  # f is negative where u is: the mean sinking


def extrapolated(w, n):
    """w = limit + C n^-p through three meshes; bisection for p."""
    ratio = lambda p: (w[2] - w[1]) / (w[1] - w[0]) - (n[2] ** -p - n[1] ** -p) / (n[1] ** -p - n[0] ** -p)
    low, high = 0.3, 6.0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if ratio(middle) * ratio(high) <= 0 else (low, middle)
    c = (w[2] - w[1]) / (n[2] ** -low - n[1] ** -low)
    return w[2] - c * n[2] ** -low, low


CELLS = (4, 8, 12)
for nu in map(float, sys.argv[1:] or ["0.3", "0.45", "0.49"]):
    w = [sinking(nu, n) for n in CELLS]
    limit, order = extrapolated(w, CELLS)
    print(f"nu {nu}: {w[0]:.6e} {w[1]:.6e} {w[2]:.6e} m, limit {limit:.6e} m with order {order:.2f}", flush=True)
