#!/usr/bin/python3
"""Makes strip.msh and tube.msh, of cells that are cut into six tetrahedra each. Run it again after changing something here.

strip   20 x 18 x 5 mm, cut across at x = 0 into two lips 0.2 mm apart; finer towards the cut
tube    of 3 and 4 mm radius and 20 mm length along x, cut across at x = 0 into two ends 0.2 mm apart
"""
import itertools
import pathlib

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
APART = [0.1, 0.9, 1.8, 2.8, 4.0, 5.5, 7.5, 10.0]  # mm, from the cut outwards
# From the lowest corner of a cell to its highest, one direction at a time; of an odd way the last two nodes change places.
WAYS = list(itertools.permutations(range(3)))


def is_odd(way):
    return sum(way[i] > way[j] for i in range(3) for j in range(i + 1, 3)) % 2 == 1


def grid(place, counts, closed=False):
    """Nodes and tetrahedra of counts[0] x counts[1] x counts[2] cells with corners at place(i, j, k); closed: the last of the
    second direction are the first again."""
    around = counts[1] + (0 if closed else 1)
    number = lambda i, j, k: (i * around + j % around) * (counts[2] + 1) + k  # noqa: E731
    nodes = [place(i, j, k) for i in range(counts[0] + 1) for j in range(around) for k in range(counts[2] + 1)]
    tets = []
    for cell in itertools.product(*map(range, counts)):
        for way in WAYS:
            corner, tet = list(cell), [number(*cell)]
            for axis in way:
                corner[axis] += 1
                tet.append(number(*corner))
            tets.append(tet[:2] + tet[:1:-1] if is_odd(way) else tet)
    return np.array(nodes), np.array(tets)


def both_sides(place, counts, closed=False):
    """The same on both sides of the cut, the left one as the mirror image of the right one."""
    nodes, tets = grid(place, counts, closed)
    mirrored = np.vstack([nodes, nodes * [-1, 1, 1]])
    return mirrored, np.vstack([tets, tets[:, [0, 1, 3, 2]] + len(nodes)])


def write(name, nodes, tets):
    a, b, c, d = (nodes[tets[:, i]] for i in range(4))
    assert (np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) > 0).all()
    with open(HERE / f"{name}.msh", "w") as file:
        file.write(f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{len(nodes)}\n")
        file.writelines(f"{i} {x:.6g} {y:.6g} {z:.6g}\n" for i, (x, y, z) in enumerate(nodes, 1))
        file.write(f"$EndNodes\n$Elements\n{len(tets)}\n")
        file.writelines(f"{i} 4 2 1 1 {p} {q} {r} {s}\n" for i, (p, q, r, s) in enumerate(tets + 1, 1))
        file.write("$EndElements\n")
    print(f"{name}.msh: {len(nodes)} nodes, {len(tets)} tetrahedra")


def strip():
    across, deep = np.linspace(-9, 9, 13), [-5, -3.5, -2, -1, 0]
    return both_sides(lambda i, j, k: (APART[i], across[j], deep[k]), (len(APART) - 1, 12, 4))


def tube():
    def place(i, j, k):
        a, r = -2 * np.pi * (j + 0.5) / 24, 3 + 0.5 * k
        return APART[i], r * np.cos(a), r * np.sin(a)
    nodes, tets = both_sides(place, (len(APART) - 1, 24, 2), closed=True)
    return nodes, tets


if __name__ == "__main__":
    write("strip", *strip())
    write("tube", *tube())
